"""From a mesh file to a table file: the pipeline, its options, progress and report.

Options and results are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.pipeline.options import (
    EXPECTED_MOTION,
    BuildOptions,
    BuildResult,
    Progress,
    TableSettings,
    bare_path,
)
from galewood.shipped import SHIPPED_FOLDER, ShippedTree, read_shipped
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.pipeline.assemble import TableContext, assemble_table, internal_states
    from galewood.pipeline.build import build_table, build_tree, model_of
    from galewood.pipeline.expected import expected_motion, motion_lines
    from galewood.pipeline.from_beams import beam_table
    from galewood.pipeline.kernel_compilation import compile_kernels
    from galewood.pipeline.shipping import BuiltinMesh, builtin_meshes, outdated, ship
    from galewood.pipeline.summary import import_lines, tree_lines
    from galewood.pipeline.surface import render_mesh

__getattr__ = lazily(
    __name__,
    {
        "TableContext": "galewood.pipeline.assemble",
        "assemble_table": "galewood.pipeline.assemble",
        "internal_states": "galewood.pipeline.assemble",
        "beam_table": "galewood.pipeline.from_beams",
        "build_table": "galewood.pipeline.build",
        "build_tree": "galewood.pipeline.build",
        "model_of": "galewood.pipeline.build",
        "expected_motion": "galewood.pipeline.expected",
        "import_lines": "galewood.pipeline.summary",
        "motion_lines": "galewood.pipeline.expected",
        "compile_kernels": "galewood.pipeline.kernel_compilation",
        "render_mesh": "galewood.pipeline.surface",
        "BuiltinMesh": "galewood.pipeline.shipping",
        "builtin_meshes": "galewood.pipeline.shipping",
        "outdated": "galewood.pipeline.shipping",
        "ship": "galewood.pipeline.shipping",
        "tree_lines": "galewood.pipeline.summary",
    },
)
__all__ = [
    "EXPECTED_MOTION",
    "SHIPPED_FOLDER",
    "BuildOptions",
    "BuildResult",
    "BuiltinMesh",
    "Progress",
    "ShippedTree",
    "TableContext",
    "TableSettings",
    "assemble_table",
    "bare_path",
    "beam_table",
    "build_table",
    "build_tree",
    "builtin_meshes",
    "compile_kernels",
    "expected_motion",
    "import_lines",
    "internal_states",
    "model_of",
    "motion_lines",
    "outdated",
    "read_shipped",
    "render_mesh",
    "ship",
    "tree_lines",
]
