"""The table and the mesh to show, from whatever stands for a tree."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

import errno
from dataclasses import replace
from pathlib import Path

from galewood.io.api import MotionTable, Tree, load
from galewood.packaged import species_folder
from galewood.pipeline.results import shipped_tables
from galewood.pipeline.tables import BuildOptions, beam_table
from galewood.table import encode


def shown_table(tree: str | Path | MotionTable | Tree, mesh: str | Path | None = None) -> MotionTable:
    """A table with its mesh and without the paper's records, which the front end does not play.

    Raises:
        TableError: The file is not a table, or one of a version that is not read (a ValueError).
        ValueError: The table has no mesh, or the wood of the tree no branches.
        OSError: A file cannot be opened; FileNotFoundError lists the built-in trees.
    """
    if isinstance(tree, Tree):
        return _estimated(tree)
    table = tree if isinstance(tree, MotionTable) else _loaded(tree, mesh)
    if table.render_glb is None:
        raise ValueError("this table has no mesh: load it with galewood.load(path, mesh=...)")
    if table.table.paper is None:
        return table
    return MotionTable(encode(replace(table.table, paper=None)), table.render_glb)


def _loaded(tree: str | Path, mesh: str | Path | None) -> MotionTable:
    path, builtin = Path(tree), shipped_tables(species_folder())
    if isinstance(tree, str) and tree in builtin and not path.is_file():
        path = builtin[tree]
    if not path.exists():
        known = ", ".join(builtin)
        raise FileNotFoundError(errno.ENOENT, f"neither a file nor a built-in tree ({known})", str(tree))
    return load(path, mesh=mesh)


def _estimated(tree: Tree) -> MotionTable:
    """The preliminary table that a build has after its first second."""
    return MotionTable(encode(beam_table(tree.mesh, BuildOptions(), tree.render_glb)), tree.render_glb)
