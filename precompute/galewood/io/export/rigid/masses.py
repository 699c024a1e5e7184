"""The masses of the finite elements, lumped to rigid bodies; without the leaves where the table has none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from galewood.io.export.rigid.bodies import GROUND_BODY, RigidTree
from galewood.io.export.rigid.chain import Masses, jacobian, turns
from galewood.io.export.rigid.solid import Solid
from galewood.io.export.skeletal.radii import wood_vertices
from galewood.table import Table
from galewood.util import Floats, Ints

LEAST_MASS_SHARE = 1e-6
"""Of a body, over that of the tree: a hinge needs some inertia."""


@dataclass(frozen=True)
class Lumped:
    """The solid's nodes as parts of the bodies; n nodes, b bodies."""

    place_m: Floats
    """(n, 3) at rest, from the vertices that hang on them."""
    part_kg: Floats
    """(n, b) a node's mass in each body; of nodes between bodies a share in each."""


def lumped(tree: RigidTree, table: Table, solid: Solid, rest_m: Floats, node_kg: Floats) -> Lumped:
    """The masses of the solid's nodes (n,), kg, as parts of the bodies; the ground has no part."""
    wood = wood_vertices(table)
    body = tree.of_node[table.vertex_node[wood].astype(np.int64)]
    member = np.zeros((len(wood), tree.count))
    held = body != GROUND_BODY
    member[np.flatnonzero(held), body[held]] = 1.0
    at_node = solid.spread(wood, np.concatenate([rest_m[wood], member], axis=1))
    return Lumped(at_node[:, :3], at_node[:, 3:] * node_kg[:, None])


def body_masses(tree: RigidTree, table: Table, nodes: Lumped) -> Masses:
    """Masses of the bodies."""
    place, part = nodes.place_m, nodes.part_kg.T
    mass = part.sum(axis=1)
    least = LEAST_MASS_SHARE * float(mass.sum())
    rest_of = table.node_rest_m[tree.node].astype(np.float64)
    centre = np.where((mass > least)[:, None], part @ place / np.maximum(mass, least)[:, None], rest_of)
    inertia = np.zeros((tree.count, 3, 3))
    for one in range(tree.count):
        arm = place - centre[one]
        second = (part[one][:, None] * arm).T @ arm
        # a row of points on a line would have no inertia about it
        round_kg_m2 = 0.5 * max(mass[one], least) * tree.radius_m[one] ** 2
        inertia[one] = (np.trace(second) + round_kg_m2) * np.eye(3) - second
    return Masses(np.maximum(mass, least), centre, inertia)


def mode_inertia(tree: RigidTree, nodes: Lumped, shape: Floats) -> Floats:
    """(3b, k) generalised forces of the inertia M φ of shapes (n, 3, k) of the solid's nodes."""
    every = np.arange(tree.count)
    force = np.einsum("nb,nik->bik", nodes.part_kg, shape, optimize=True)
    moment = np.zeros_like(force)
    for body in every:
        arm = nodes.place_m - tree.hinge_m[body]
        turning = np.cross(arm[:, :, None], shape, axis=1)
        moment[body] = np.tensordot(nodes.part_kg[:, body], turning, axes=1)
    moves, turned = jacobian(tree, every, tree.hinge_m), turns(tree, every)
    return np.einsum("bih,bik->hk", moves, force) + np.einsum("bih,bik->hk", turned, moment)


def node_masses(table: Table, solid: Solid, shape: Floats, leaf_m2: Floats) -> Floats:
    """(n,) kg: masses of the solid's nodes, less those of the leaves where the table has none.

    The file holds the masses in leaf. The table's own modes are mass-normalised, which determines how heavy
    the leaves are that it lacks; they hang where the drawn leaves are, in proportion to their area.
    ``shape`` (n, 3, d): the table's modes at the nodes, 1/√kg; ``leaf_m2`` (v,): area of the drawn leaves.
    """
    in_leaf = solid.mass_kg
    if table.foliage != "bare":
        return in_leaf
    area = solid.binding.T @ leaf_m2
    energy = np.square(shape).sum(axis=1)
    excess, per_area = in_leaf @ energy - 1.0, area @ energy
    density = max(float(per_area @ excess / (per_area @ per_area)), 0.0)
    return np.maximum(in_leaf - density * area, 0.0)


def leaf_areas(table: Table, rest_m: Floats, faces: Sequence[Ints]) -> Floats:
    """(v,) m²: one-sided area of the drawn leaves at each vertex."""
    found, start = np.zeros(len(rest_m)), 0
    for primitive, corners in zip(table.metadata["primitives"], faces, strict=True):
        if primitive["kind"] == "leaves":
            found += vertex_areas(rest_m, corners + start)
        start += int(primitive["vertices"])
    return found


def vertex_areas(rest_m: Floats, corners: Ints) -> Floats:
    """(v,) a third of the areas of the triangles (f, 3) around each vertex."""
    a, b, c = rest_m[corners].transpose(1, 0, 2)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return np.bincount(corners.ravel(), np.repeat(area / 3, 3), len(rest_m)).astype(np.float64)
