"""From a mesh file to a table file: the pipeline, its options, progress and report."""

from galewood.pipeline.assemble import Surroundings, TableSettings, assemble_table, internal_states
from galewood.pipeline.build import build_table, build_tree, model_of
from galewood.pipeline.options import BuildOptions, BuildResult, Progress, build_options
from galewood.pipeline.rehearsal import compile_kernels
from galewood.pipeline.report import render_mesh
from galewood.pipeline.shipping import BuiltinMesh, builtin_meshes, outdated, ship
from galewood.shipped import SHIPPED_FOLDER, ShippedTree, build_key, read_shipped, write_shipped

__all__ = [
    "SHIPPED_FOLDER",
    "BuildOptions",
    "BuildResult",
    "BuiltinMesh",
    "Progress",
    "ShippedTree",
    "Surroundings",
    "TableSettings",
    "assemble_table",
    "build_key",
    "build_options",
    "build_table",
    "build_tree",
    "builtin_meshes",
    "compile_kernels",
    "internal_states",
    "model_of",
    "outdated",
    "read_shipped",
    "render_mesh",
    "ship",
    "write_shipped",
]
