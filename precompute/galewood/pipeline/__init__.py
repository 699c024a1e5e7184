"""From a mesh file to a table file: the pipeline, its options, progress and report."""

from galewood.pipeline.assemble import Surroundings, TableSettings, assemble_table, internal_states
from galewood.pipeline.build import build_table, build_tree
from galewood.pipeline.options import BuildOptions, BuildResult, Progress, build_options
from galewood.pipeline.rehearsal import compile_kernels
from galewood.pipeline.report import render_mesh
from galewood.pipeline.shipped import ShippedTree, build_key, read_shipped, write_shipped
from galewood.pipeline.shipping import SHIPPED_FOLDER, BuiltinMesh, builtin_meshes, outdated, ship

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
    "outdated",
    "read_shipped",
    "render_mesh",
    "ship",
    "write_shipped",
]
