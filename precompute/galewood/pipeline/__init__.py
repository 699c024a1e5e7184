"""From a mesh file to a table file: the pipeline, its options, progress and report."""

from galewood.pipeline.assemble import Surroundings, TableSettings, assemble_table, internal_states
from galewood.pipeline.build import build_table, build_tree, model_of
from galewood.pipeline.options import BuildOptions, BuildResult, Progress, build_options
from galewood.pipeline.report import render_mesh
from galewood.shipped import ShippedTree, build_key, read_shipped, write_shipped

__all__ = [
    "BuildOptions",
    "BuildResult",
    "Progress",
    "ShippedTree",
    "Surroundings",
    "TableSettings",
    "assemble_table",
    "build_key",
    "build_options",
    "build_table",
    "build_tree",
    "internal_states",
    "model_of",
    "read_shipped",
    "render_mesh",
    "write_shipped",
]
