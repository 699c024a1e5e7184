"""Motion tables: built from a tree, saved, loaded."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field

from galewood.formats import read_glb
from galewood.io.api.cache import default_cache_dir
from galewood.io.api.expected import expect
from galewood.io.api.keywords import with_keywords_of
from galewood.io.api.trees import Tree
from galewood.options import TableRequest
from galewood.pipeline.results import bare_path, read_compliance, write_compliance
from galewood.pipeline.stages import Progress, build_tree
from galewood.pipeline.tables import BuildOptions
from galewood.table import Foliage, Table, decode
from galewood.util import Floats, Ints, write_atomically


@dataclass(frozen=True)
class MotionTable:
    """A table of a tree's motion in wind, with the mesh that it moves."""

    data: bytes = field(repr=False)
    """The bytes of the table file (spec/formats/table.md)."""
    render_glb: bytes | None = field(default=None, repr=False)
    """The mesh to draw, as a binary glTF; None: not known."""
    report: dict[str, Any] = field(default_factory=dict[str, Any], repr=False)
    """What the build assumed and measured; empty for a loaded table."""
    bare: MotionTable | None = field(default=None, repr=False)
    """The table of the same tree and mesh without its leaves, if it was built too (``bare_table=True``)."""
    name: str = "tree"
    """What the tree's file is called; exports take it."""
    compliance: bytes | None = field(default=None, repr=False)
    """The compliance file (spec/formats/compliance.md), which exports to MuJoCo need; None: not known."""

    @cached_property
    def table(self) -> Table:
        """The decoded tensors. Raises TableError for bytes that are not a table."""
        return decode(self.data)

    @property
    def metadata(self) -> dict[str, Any]:
        """Species, height, frequencies, errors and provenance."""
        return self.table.metadata

    @property
    def foliage(self) -> Foliage:
        """Whether the table was made from the tree in leaf or bare."""
        return self.table.foliage

    @property
    def height_m(self) -> float:
        """Height of the tree, m."""
        return float(self.metadata["height_m"])

    @property
    def frequencies_hz(self) -> list[float]:
        """The first natural frequencies of the finite-element model, Hz."""
        return list(self.metadata["frequencies_hz"])

    @cached_property
    def rest_vertices_m(self) -> Floats:
        """(v, 3) render vertices at rest, m, in the order of the GLB. ValueError without a mesh."""
        parts = read_glb(self._glb())
        return np.concatenate([np.asarray(part.positions, np.float64) for part in parts])

    @cached_property
    def faces(self) -> Ints:
        """(f, 3) triangles of the render mesh. ValueError without a mesh."""
        parts, start, found = read_glb(self._glb()), 0, list[Ints]()
        for part in parts:
            found.append(part.faces + start)
            start += len(part.positions)
        return np.concatenate(found)

    def _glb(self) -> bytes:
        if self.render_glb is None:
            raise ValueError("this table has no mesh: load it with galewood.load(path, mesh=...)")
        return self.render_glb

    def save(self, path: str | Path) -> None:
        """Write the table, and beside it the mesh that it moves (same name, .glb) and its compliance file.

        The bare table, if there is one, is written beside tree.gwt as tree.bare.gwt, with its mesh.
        """
        path = Path(path)
        write_atomically(path, self.data)
        if self.bare is not None:
            self.bare.save(bare_path(path))
        if self.render_glb is not None:
            write_atomically(path.with_suffix(".glb"), self.render_glb)
        if self.compliance is not None:
            write_compliance(path, self.compliance)


class BuildCall(TableRequest):
    """Everything that can be chosen about a build in a program; ``build`` describes what it adds."""

    reference_frames: int = Field(default=0, ge=0)
    on_progress: Callable[[Progress], None] | None = None
    cache_dir: Path | None = None


@with_keywords_of(BuildCall)
def build(tree: Tree, options: BuildCall) -> MotionTable:
    """Simulate a tree and build its motion table: a minute or two of processor time.

    Args:
        tree: The tree (``galewood.read``).
        options: The fields of ``galewood.TableRequest`` as keywords, such as ``design_speed_m_s``, ``modes``
            and ``seed``; also ``on_progress``, which receives ``Progress(stage, fraction, message)`` and may
            stop the build by raising; ``cache_dir``, the folder for meshes and training runs, by default in
            the user's cache folder, from which a build that was stopped continues; and ``reference_frames``,
            the length of a run that is compared with the quadratic reference elements, 0 for none.

    Raises:
        MeshError: The wood cannot be meshed.
        TypeError: ``tree`` is something else.
        pydantic.ValidationError: An option is unknown or out of range.
    """
    expect("tree", tree, Tree)
    chosen = options.model_dump(exclude={"on_progress", "cache_dir"})
    result = build_tree(
        tree.mesh,
        tree.render_glb,
        BuildOptions.model_validate(chosen),
        options.on_progress or (lambda progress: None),
        options.cache_dir or default_cache_dir(),
    )
    shared: dict[str, Any] = {"name": tree.name, "compliance": result.compliance}
    bare = MotionTable(result.bare_table, result.render_glb, **shared) if result.bare_table else None
    return MotionTable(result.whole_table(), result.render_glb, result.report, bare, **shared)


def load(path: str | Path, *, mesh: str | Path | None = None) -> MotionTable:
    """Load a table file, its compliance file, and the mesh beside it (same name, .glb) or at ``mesh``.

    Raises:
        TableError: The file is not a table, or one of a version that is not read.
        OSError: A file cannot be opened.
    """
    path = Path(path)
    beside = Path(mesh) if mesh is not None else path.with_suffix(".glb")
    glb = beside.read_bytes() if mesh is not None or beside.exists() else None
    loaded = MotionTable(path.read_bytes(), glb, name=path.stem, compliance=read_compliance(path))
    _ = loaded.table  # raises here rather than later
    return loaded


def save(table: MotionTable, path: str | Path) -> None:
    """Write a table, and beside it the mesh that it moves (same name, .glb). TypeError for what is none."""
    expect("table", table, MotionTable)
    table.save(path)
