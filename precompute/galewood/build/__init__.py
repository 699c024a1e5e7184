"""From a mesh file to a table file: the pipeline, its options, progress and report."""

from galewood.build.assemble import TableSettings, assemble_table, internal_states
from galewood.build.options import BuildOptions, BuildResult, Progress, build_options
from galewood.build.pipeline import build_table, build_tree
from galewood.build.report import render_mesh

__all__ = [
    "BuildOptions",
    "BuildResult",
    "Progress",
    "TableSettings",
    "assemble_table",
    "build_options",
    "build_table",
    "build_tree",
    "internal_states",
    "render_mesh",
]
