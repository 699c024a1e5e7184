"""Pulling a tree at a point of its mesh: static response, drag constraint, and what a release adds.

Mode acceleration (docs/design/0018-pulling.md): a held tree is displaced by its static response to the
force, and goes on swaying in the wind about it. The modes' part of that response is added to the pose, the
rest by whoever draws the tree. On release the modes' part becomes part of the oscillators' state, so that the
tree swings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.constants import (
    PULL_FORCE_SHARE,
    PULL_LAG_S,
    PULL_MOST_REACH,
    PULL_STRETCH_SHARE,
    WHOLE_WEIGHT,
)
from galewood.table import Compliance, Table
from galewood.util import Floats


class PullError(ValueError):
    """The tree has no such point."""


@dataclass(frozen=True)
class PointResponse:
    """Static response to a force at one vertex, in the tree's frame, at scale 1.

    d oscillators, r modes. oscillators (d, 3): coordinates, m·√kg, per N; pose (r, 3): m of q per N;
    compliance (3, 3), m/N: of the whole tree, or of its modes alone; limit_n: largest permitted
    force; point (3, r): displacement of the vertex per unit of q.
    """

    node: int
    point: Floats
    oscillators: Floats
    pose: Floats
    compliance: Floats
    limit_n: float
    reach_m: float


def point_response(table: Table, vertex: int, compliance: Compliance | None = None) -> PointResponse:
    """The response of a table's tree at a vertex of its render mesh. Raises PullError.

    A compliance file of another mesh is ignored.
    """
    if not 0 <= vertex < len(table.vertex_node):
        raise PullError(f"the mesh has {len(table.vertex_node)} vertices: there is no vertex {vertex}")
    node = int(table.vertex_node[vertex])
    first, second = table.joint_nodes[table.vertex_joint[vertex]].tolist()
    share = float(table.joint_share[table.vertex_joint[vertex]])
    basis = table.node_basis
    point = (1 - share) * basis[first].astype(np.float64) + share * basis[second].astype(np.float64)
    oscillators = static_gain(table)[:, None] * modal_load(table, point)
    pose = static_pose(table, oscillators)
    reach_m = PULL_MOST_REACH * float(table.metadata["height_m"])
    yields, limit_n = point @ pose, np.inf
    if compliance is not None and fits(compliance, table):
        yields, limit_n = whole_compliance(compliance, vertex)
    symmetric = 0.5 * (yields + yields.T)
    return PointResponse(node, point, oscillators, pose, symmetric, limit_n, reach_m)


def fits(compliance: Compliance, table: Table) -> bool:
    """Whether a compliance file belongs to the mesh of a table."""
    return compliance.mesh_sha256 == table.metadata["mesh_sha256"] and len(compliance.vertex_row) == len(
        table.vertex_node
    )


def static_gain(table: Table) -> Floats:
    """(d,) s²: coordinate of each oscillator at rest per unit of a constant force, 1/ω²."""
    a, b, c, d, s0, s1 = table.modal_step.astype(np.float64).T
    # e = R00 e + R01 v + s0 f and the same for v; the table holds R − 1
    return (b * s1 - d * s0) / (a * d - b * c)


def modal_load(table: Table, point: Floats) -> Floats:
    """(d, 3) modal force, N/√kg, per N at a point with the basis (3, r)."""
    d = len(table.modal_shown)
    return point[:, :d].T * table.modal_shown.astype(np.float64)[:, None]


def static_pose(table: Table, oscillators: Floats) -> Floats:
    """(r, 3) m: the modes' coordinates that follow the oscillators (d, 3) linearly."""
    d = len(table.modal_shown)
    shown = table.modal_shown.astype(np.float64)[:, None] * oscillators
    further = table.modal_pose[:d].astype(np.float64).T @ oscillators
    return np.concatenate([shown, further])


def whole_compliance(compliance: Compliance, vertex: int) -> tuple[Floats, float]:
    """(3, 3) m/N: displacement of a vertex under forces on it, and its largest permitted force, N."""
    load, weight = vertex_loads(compliance, vertex)
    columns = np.stack([solve(compliance, load[axis]) for axis in range(3)])
    yields = np.stack([displacement_at(columns[axis], compliance, vertex) for axis in range(3)], axis=1)
    held = weight[:, 0] < compliance.free
    limits = compliance.limit_n[weight[held, 0].astype(np.int64)].astype(np.float64)
    breaking_n = (
        float(weight[held, 1] @ limits) / max(float(weight[held, 1].sum()), 1e-9) if held.any() else 0.0
    )
    return yields, PULL_FORCE_SHARE * breaking_n


def vertex_loads(compliance: Compliance, vertex: int) -> tuple[Floats, Floats]:
    """(3, n, 3) N: unit forces along x, y and z on a vertex; and its nodes and weights (4, 2)."""
    row = int(compliance.vertex_row[vertex])
    node = compliance.node[row].astype(np.int64)
    weight = compliance.weight[row].astype(np.float64) / WHOLE_WEIGHT
    load = np.zeros((3, compliance.free + 1, 3))
    for axis in range(3):
        np.add.at(load[axis, :, axis], node, weight)
    return load[:, :-1], np.stack([node.astype(np.float64), weight], axis=1)


def solve(compliance: Compliance, load_n: Floats) -> Floats:
    """(n, 3) m: displacement of the nodes under forces (n, 3), N."""
    from galewood.solid.fem import solve_factor  # loads numba

    u = np.ascontiguousarray(load_n, np.float64).copy()
    solve_factor(compliance.pointer, compliance.rows, compliance.blocks, u)
    return u


def displacement_at(u_m: Floats, compliance: Compliance, vertex: int) -> Floats:
    """(3,) m: displacement of a vertex when the nodes move by u_m (n, 3)."""
    row = int(compliance.vertex_row[vertex])
    padded = np.concatenate([u_m, np.zeros((1, 3))])
    weight = compliance.weight[row].astype(np.float64) / WHOLE_WEIGHT
    return weight @ padded[compliance.node[row].astype(np.int64)]


class DragConstraint:
    """A limited force that pulls a point of a tree. Forces and places in its frame, at scale 1."""

    def __init__(self, response: PointResponse) -> None:
        self.response = response
        self.force_n = np.zeros(3)
        self.rate_n_s = np.zeros(3)
        """How fast the force changes, smoothed."""
        yields = response.compliance
        soft = PULL_STRETCH_SHARE * float(np.trace(yields)) / 3
        # damped least squares: stiff directions, along a branch, would need enormous forces
        self._force_of = np.linalg.inv(yields @ yields + (soft * soft + 1e-30) * np.eye(3)) @ yields

    def step(self, dt_s: float, target_m: Floats, swayed_m: Floats) -> None:
        """Follow a target, the displacement of the point from rest; the wind has moved it by swayed_m."""
        if dt_s <= 0:
            return
        wanted = limited(np.asarray(target_m, np.float64) - swayed_m, self.response.reach_m)
        goal = limited(self._force_of @ wanted, self.response.limit_n)
        before, share = self.force_n, dt_s / (PULL_LAG_S + dt_s)
        self.force_n = before + share * (goal - before)
        self.rate_n_s = self.rate_n_s + share * ((self.force_n - before) / dt_s - self.rate_n_s)

    @property
    def pose(self) -> Floats:
        """(r,) m: what the modes add to the pose."""
        return self.response.pose @ self.force_n

    def released(self) -> tuple[Floats, Floats]:
        """What a release adds to the oscillators' coordinates (d,), m·√kg, and to their speeds (d,)."""
        return self.response.oscillators @ self.force_n, self.response.oscillators @ self.rate_n_s


def limited(vector: Floats, most: float) -> Floats:
    """The vector (3,), shortened to a length of ``most``."""
    length = float(np.sqrt(vector @ vector))
    return vector if length <= most else vector * (most / length)
