"""What the bodies must reproduce: natural frequencies, damping, and how the wood yields to forces.

The compliance file is that of the tree in leaf. For a table without leaves its lowest modes are replaced by
the table's own: K⁻¹ = Σ φ φᵀ / ω², and what foliage changes are the lowest terms.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.io.export.rigid.bodies import GROUND_BODY, RigidTree
from galewood.io.export.rigid.solid import Solid
from galewood.io.export.skeletal.radii import wood_vertices
from galewood.solid.skinning import vertex_rows
from galewood.table import Table
from galewood.util import Floats, Ints

FREE_SHARE = 0.5
"""Of a group of vertices that must hang on free nodes of the solid, not on clamped ones."""


@dataclass(frozen=True)
class Oscillators:
    """The d linear oscillators of a table: natural modes, in the table's order."""

    omega: Floats
    """(d,) rad/s, undamped."""
    damping_ratio: Floats
    """(d,)"""
    shape: Floats
    """(v, 3, d) at the vertices, 1/√kg, mass-normalised."""

    def rayleigh(self) -> tuple[float, float]:
        """α, 1/s, and β, s: the mass and stiffness factors of the modes' damping, 2 ζ ω = α + β ω²."""
        rows = np.stack([0.5 / self.omega, 0.5 * self.omega], axis=1)
        alpha, beta = np.linalg.lstsq(rows, self.damping_ratio, rcond=None)[0]
        return float(alpha), float(beta)


def oscillators(table: Table, rest_m: Floats) -> Oscillators:
    """The oscillators of a table, from their exact step and their shapes."""
    step, dt_s = table.modal_step.astype(np.float64), float(table.metadata["dt_s"])
    rows = step[:, :4].reshape(-1, 2, 2) + np.eye(2)
    rate = np.log(np.linalg.eigvals(rows).astype(np.complex128)[:, 0]) / dt_s
    omega = np.abs(rate)
    d = len(omega)
    shape = vertex_rows(table, rest_m)[:, :, :d].astype(np.float64) * table.modal_shown.astype(np.float64)
    return Oscillators(omega, -rate.real / omega, shape)


@dataclass(frozen=True)
class Sections:
    """Groups of vertices of the wood around g nodes of the table, and how they yield to forces on them."""

    node: Ints
    """(g,)"""
    place_m: Floats
    """(g, 3) mean of the group's vertices."""
    yields: Floats
    """(g, 3, 3) m/N"""
    shape: Floats
    """(g, 3, d) the oscillators' shapes, 1/√kg."""


def sections(table: Table, solid: Solid, rest_m: Floats, own: Oscillators, tree: RigidTree) -> Sections:
    """All nodes that move and have wood around them. A force is spread over the group, without dents."""
    wood = wood_vertices(table)
    node_of = table.vertex_node[wood].astype(np.int64)
    free = np.asarray(solid.binding[wood].sum(axis=1)).ravel()
    node = np.array(
        [
            k
            for k in np.unique(node_of)
            if tree.of_node[k] != GROUND_BODY and free[node_of == k].mean() > FREE_SHARE
        ],
        np.int64,
    )
    groups = [wood[node_of == k] for k in node]
    shape = np.stack([own.shape[rows].mean(axis=0) for rows in groups])
    shares = np.stack([np.asarray(solid.binding[rows].mean(axis=0)).ravel() for rows in groups])
    place = np.stack([rest_m[rows].mean(axis=0) for rows in groups])
    yields = solid.response(shares)
    if table.foliage == "bare":
        yields += changed_by_foliage(solid, shares, shape / own.omega)
    return Sections(node, place, yields, shape)


def changed_by_foliage(solid: Solid, shares: Floats, without: Floats) -> Floats:
    """(g, 3, 3) m/N: how groups of nodes (g, n) yield more to forces on them than the tree in leaf does.

    ``without`` (g, 3, d): the shapes of the table's modes over their angular frequencies.
    """
    omega, modes = solid.modes(without.shape[2])
    in_leaf = np.tensordot(shares, modes, axes=1) / omega
    return without @ without.transpose(0, 2, 1) - in_leaf @ in_leaf.transpose(0, 2, 1)
