"""A tree as rigid bodies: the nodes of its table, joined by elastic hinges halfway between them.

A hinge in the middle of an edge bends as a uniform beam does: the end of the edge moves and turns by the
same amounts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.io.export.skeletal.joints import node_motion
from galewood.io.export.skeletal.radii import node_radii
from galewood.io.export.skeletal.skeleton import choose_bones, parents_of, samples
from galewood.table import Table
from galewood.util import Floats, Ints

HINGES = ("bend_a", "bend_b", "twist")
GROUND_BODY = -1
"""Body number of the ground, and of what is clamped in it."""
LEAST_LENGTH_M = 1e-3
SHAPE_M = 0.01
"""Displacement of the poses that bodies are chosen by: small, so that the motion is linear."""


@dataclass(frozen=True)
class RigidTree:
    """b bodies, parents before children; m, axes of the table (y up). The rest pose is that under gravity."""

    node: Ints
    """(b,) node of the table that each body is named after, its first."""
    parent: Ints
    """(b,) GROUND_BODY: hinged to the ground."""
    of_node: Ints
    """(n,) body of each node of the table."""
    hinge_m: Floats
    """(b, 3) place of the hinge to the parent."""
    axes: Floats
    """(b, 3, 3) rows: two axes of bending and the axis of torsion, along the wood."""
    length_m: Floats
    """(b,) of the edge that the hinge bends for."""
    radius_m: Floats
    """(b,) of the wood at the hinge, as drawn."""

    @property
    def count(self) -> int:
        """b."""
        return len(self.node)

    def below(self) -> Floats:
        """(b, b) 1 where the second body carries the first, or is the first."""
        found = np.eye(self.count)
        for body, above in enumerate(self.parent):
            if above != GROUND_BODY:
                found[body] += found[above]
        return found


def rigid_tree(table: Table, rest_m: Floats, most: int) -> RigidTree:
    """At most ``most`` bodies; where the table has more nodes, those that carry the others best.

    ``rest_m`` (v, 3): the drawn vertices.
    """
    parent, place = parents_of(table), table.node_rest_m.astype(np.float64)
    poses = np.eye(table.modes)[: len(table.modal_shown)] * SHAPE_M
    # roots are bones, but no bodies: the ground holds them
    bones = choose_bones(table, samples(node_motion(table, poses)), most + int((parent < 0).sum()))
    hinged = bones.parent >= 0
    body = np.where(hinged, np.cumsum(hinged) - 1, GROUND_BODY)
    node = bones.node[hinged]
    arm = place[node] - place[parent[node]]
    length = np.maximum(np.linalg.norm(arm, axis=1), LEAST_LENGTH_M)
    return RigidTree(
        node=node,
        parent=body[bones.parent[hinged]],
        of_node=body[bones.of_node],
        hinge_m=0.5 * (place[node] + place[parent[node]]),
        axes=np.stack([_axes(row) for row in arm]),
        length_m=length,
        radius_m=node_radii(table, rest_m)[node],
    )


def upright(vectors: Floats) -> Floats:
    """Vectors (…, 3) of the table (y up) with z up, as robot simulators have it."""
    return np.stack([vectors[..., 0], -vectors[..., 2], vectors[..., 1]], axis=-1)


def upright_tensor(tensor: Floats) -> Floats:
    """A tensor (3, 3) of the table with z up."""
    turned = upright(np.eye(3)).T
    found: Floats = turned @ tensor @ turned.T
    return found


def body_names(tree: RigidTree, name: str) -> list[str]:
    """(b + 1) names of the bodies, by their nodes of the table, and last of the body that is the ground's."""
    digits = max(3, len(str(int(tree.node.max()))))
    return [*(f"{name}_{int(node):0{digits}d}" for node in tree.node), name]


def _axes(arm: Floats) -> Floats:
    """(3, 3) an orthonormal basis whose last row is along the arm."""
    length = float(np.linalg.norm(arm))
    along: Floats = arm / length if length > 0 else np.array([0.0, 1.0, 0.0])
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    across /= np.linalg.norm(across)
    basis: Floats = np.stack([across, np.cross(along, across), along]).astype(np.float64)
    return basis
