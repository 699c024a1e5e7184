"""Galewood: how trees move in wind, from a mesh to a table to a forest.

    import galewood

    tree = galewood.read("oak.glb", height_m=12)
    table = galewood.build(tree)
    forest = galewood.Forest([table], galewood.grid(100), galewood.Wind(mean_speed_m_s=10))
    forest.step(1 / 30)
    forest.vertices_m(tree=0)

Everything listed in ``__all__`` is the public API; the sub-packages may change between versions.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from galewood.check.evaluation import SourceError
    from galewood.check.field import FieldError
    from galewood.io.api import (
        Forest,
        Model,
        Motion,
        MotionTable,
        Placements,
        Tree,
        build,
        evaluate,
        export_tree,
        field_report,
        grid,
        load,
        read,
        save,
    )
    from galewood.io.export import ExportError
    from galewood.io.notebook import NotebookError, show
    from galewood.motion.wind import PRESETS, Wind, WindError
    from galewood.options import BuildRequest, ImportRequest, TableRequest
    from galewood.pipeline.stages import Progress
    from galewood.solid.fem import FemSettings
    from galewood.table import TableError
    from galewood.util import Cancelled, MeshError
    from galewood.wood import SPECIES, Wood, WoodError

__all__ = [
    "PRESETS",
    "SPECIES",
    "BuildRequest",
    "Cancelled",
    "ExportError",
    "FemSettings",
    "FieldError",
    "Forest",
    "ImportRequest",
    "MeshError",
    "Model",
    "Motion",
    "MotionTable",
    "NotebookError",
    "Placements",
    "Progress",
    "SourceError",
    "TableError",
    "TableRequest",
    "Tree",
    "Wind",
    "WindError",
    "Wood",
    "WoodError",
    "build",
    "evaluate",
    "export_tree",
    "field_report",
    "grid",
    "load",
    "read",
    "save",
    "show",
]

# Loaded on first use, so that importing a single sub-package stays fast.
_HOMES = {
    "Forest": "io.api",
    "Model": "io.api",
    "Motion": "io.api",
    "MotionTable": "io.api",
    "Placements": "io.api",
    "Tree": "io.api",
    "build": "io.api",
    "evaluate": "io.api",
    "export_tree": "io.api",
    "field_report": "io.api",
    "grid": "io.api",
    "load": "io.api",
    "read": "io.api",
    "save": "io.api",
    "Progress": "pipeline.stages",
    "SourceError": "check.evaluation",
    "ExportError": "io.export",
    "FemSettings": "solid.fem",
    "FieldError": "check.field",
    "NotebookError": "io.notebook",
    "show": "io.notebook",
    "BuildRequest": "options",
    "ImportRequest": "options",
    "TableRequest": "options",
    "TableError": "table",
    "Cancelled": "util",
    "MeshError": "util",
    "PRESETS": "motion.wind",
    "Wind": "motion.wind",
    "WindError": "motion.wind",
    "SPECIES": "wood",
    "Wood": "wood",
    "WoodError": "wood",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'galewood' has no attribute {name!r}")
    return getattr(import_module(f"galewood.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
