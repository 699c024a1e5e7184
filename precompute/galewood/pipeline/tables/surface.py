"""The mesh that the viewer moves, bound to the axis of its branches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse

from galewood.solid.skinning import (
    QUICK_SMOOTHING,
    Axis,
    Bindings,
    Distortion,
    Effort,
    smoothed_bindings,
    vertex_bindings,
)
from galewood.tree import TreeMesh
from galewood.util import Floats


@dataclass(frozen=True)
class RenderMesh:
    """The mesh that the viewer moves: vertices in file order, embedded in tetrahedra, bound to the axis."""

    vertices_m: Floats  # (v, 3)
    embedding: scipy.sparse.csr_matrix  # (v, n) weights of the vertices on the tet vertices
    primitives: list[dict[str, Any]]  # name, kind, vertices
    axis: Axis
    bindings: Bindings
    distortion: Distortion | None = None
    """Measures what is drawn; None: nothing is measured, and the weights are not smoothed."""

    def smoothed(self, tree: TreeMesh, basis: Floats, q: Floats, effort: Effort) -> RenderMesh:
        """The mesh with skinning weights smoothed for far poses q (k, r) of the modes ``basis`` (N, 3, r)."""
        return replace(self, bindings=smoothed_bindings(tree, self.axis, basis, q, effort))


def smoothed_mesh(
    tree: TreeMesh, embedding: scipy.sparse.csr_matrix, axis: Axis, basis: Floats, q: Floats
) -> RenderMesh:
    """The same with quickly smoothed weights for far poses q (k, r) of the modes ``basis`` (N, 3, r)."""
    bindings = smoothed_bindings(tree, axis, basis, q, QUICK_SMOOTHING)
    return _mesh(tree, embedding, axis, bindings)


def render_mesh(tree: TreeMesh, embedding: scipy.sparse.csr_matrix, axis: Axis) -> RenderMesh:
    """Render vertices of all primitives in the order of the GLB, embedded and bound to the ``axis``."""
    return _mesh(tree, embedding, axis, vertex_bindings(tree, axis))


def _mesh(tree: TreeMesh, embedding: scipy.sparse.csr_matrix, axis: Axis, bindings: Bindings) -> RenderMesh:
    primitives = [{"name": p.name, "kind": p.kind, "vertices": len(p.positions_m)} for p in tree.primitives]
    places = np.concatenate([p.positions_m for p in tree.primitives])
    return RenderMesh(places, embedding, primitives, axis, bindings, Distortion(tree))
