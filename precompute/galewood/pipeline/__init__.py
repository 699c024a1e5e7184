"""From a mesh file to a table file: the pipeline, its options, progress and report."""

from galewood.pipeline.assemble import TableSettings, assemble_table, internal_states
from galewood.pipeline.build import build_table, build_tree
from galewood.pipeline.options import BuildOptions, BuildResult, Progress, build_options
from galewood.pipeline.report import render_mesh

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
