"""Capsules along stem and boughs, for collisions."""

from __future__ import annotations

import numpy as np

from galewood.io.export.rigid.bodies import RigidTree
from galewood.io.export.skeletal.radii import node_radii
from galewood.io.export.skeletal.skeleton import parents_of
from galewood.table import Table
from galewood.util import Floats

LEAST_LENGTH_M = 1e-3


def capsules(tree: RigidTree, table: Table, rest_m: Floats) -> Floats:
    """(c, 8) body, ends (2 × 3), m, and radius, m, of capsules along the edges between the table's nodes.

    An edge with a hinge is two capsules, on either side of it.
    """
    place, parent = table.node_rest_m.astype(np.float64), parents_of(table)
    radius, found = node_radii(table, rest_m), list[Floats]()
    for node, above in enumerate(parent):  # limbs taper; at forks the surface of the thicker one is measured
        radius[node] = min(radius[node], radius[above]) if above >= 0 else radius[node]
    for node, above in enumerate(parent):
        if above < 0:
            continue
        own, carrier = int(tree.of_node[node]), int(tree.of_node[above])
        middle = 0.5 * (place[node] + place[above])
        halves = [(own, place[above], place[node], radius[node])]
        if own != carrier:
            halves = [(carrier, place[above], middle, radius[node]), (own, middle, place[node], radius[node])]
        found += [
            np.array([body, *first, *last, thick])
            for body, first, last, thick in halves
            if np.linalg.norm(last - first) > LEAST_LENGTH_M
        ]
    return np.stack(found)
