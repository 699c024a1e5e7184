"""From a mesh file to a table file: the pipeline, its options, progress and report.

Options and results are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.pipeline.shipped import SHIPPED_FOLDER, ShippedTree, read_shipped
from galewood.pipeline.stages.options import (
    EXPECTED_MOTION,
    BuildOptions,
    BuildResult,
    Progress,
    TableSettings,
    bare_path,
)
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.pipeline.stages.assemble import TableContext, assemble_table, internal_states
    from galewood.pipeline.stages.build import build_table, build_tree, model_of
    from galewood.pipeline.stages.expected import expected_motion, motion_lines
    from galewood.pipeline.stages.from_beams import beam_table
    from galewood.pipeline.stages.kernel_compilation import compile_kernels
    from galewood.pipeline.stages.shipping import BuiltinMesh, builtin_meshes, outdated, ship
    from galewood.pipeline.stages.summary import import_lines, tree_lines
    from galewood.pipeline.stages.surface import render_mesh

__getattr__ = lazily(
    __name__,
    {
        "TableContext": "galewood.pipeline.stages.assemble",
        "assemble_table": "galewood.pipeline.stages.assemble",
        "internal_states": "galewood.pipeline.stages.assemble",
        "beam_table": "galewood.pipeline.stages.from_beams",
        "build_table": "galewood.pipeline.stages.build",
        "build_tree": "galewood.pipeline.stages.build",
        "model_of": "galewood.pipeline.stages.build",
        "expected_motion": "galewood.pipeline.stages.expected",
        "import_lines": "galewood.pipeline.stages.summary",
        "motion_lines": "galewood.pipeline.stages.expected",
        "compile_kernels": "galewood.pipeline.stages.kernel_compilation",
        "render_mesh": "galewood.pipeline.stages.surface",
        "BuiltinMesh": "galewood.pipeline.stages.shipping",
        "builtin_meshes": "galewood.pipeline.stages.shipping",
        "outdated": "galewood.pipeline.stages.shipping",
        "ship": "galewood.pipeline.stages.shipping",
        "tree_lines": "galewood.pipeline.stages.summary",
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
