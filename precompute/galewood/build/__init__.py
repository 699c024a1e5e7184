"""Builds a table file from a mesh file: the pipeline, its options, progress and report."""

from galewood.build.assemble import TableSettings, assemble_table, internal_states
from galewood.build.options import BuildOptions, BuildResult, Progress
from galewood.build.pipeline import build_table
from galewood.build.report import render_mesh

__all__ = [
    "BuildOptions",
    "BuildResult",
    "Progress",
    "TableSettings",
    "assemble_table",
    "build_table",
    "internal_states",
    "render_mesh",
]
