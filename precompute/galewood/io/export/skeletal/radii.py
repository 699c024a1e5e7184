"""Radii of the wood at the nodes of a table, measured on the drawn mesh."""

from __future__ import annotations

import numpy as np

from galewood.io.export.skeletal.skeleton import parents_of
from galewood.table import Table
from galewood.util import Floats, Ints

LEAST_RADIUS_M = 1e-3


def wood_vertices(table: Table) -> Ints:
    """Numbers of the vertices of the primitives that were meshed."""
    primitives = table.metadata["primitives"]
    kind = np.repeat([p["kind"] for p in primitives], [int(p["vertices"]) for p in primitives])
    return np.flatnonzero(kind == "wood")


def node_radii(table: Table, rest_m: Floats) -> Floats:
    """(n,) median distance of the wood's vertices from the axis; nodes without any take their parent's."""
    wood = wood_vertices(table)
    parent, place = parents_of(table), table.node_rest_m.astype(np.float64)
    node = table.vertex_node[wood].astype(np.int64)
    edge = np.where((parent < 0)[:, None], 0.0, place - place[parent])
    length = np.linalg.norm(edge, axis=1, keepdims=True)
    along = np.where(length > 0, edge / np.where(length > 0, length, 1.0), [0.0, 1.0, 0.0])
    arm = rest_m[wood] - table.joint_rest_m[table.vertex_joint[wood]]
    away = np.linalg.norm(arm - (arm * along[node]).sum(axis=1, keepdims=True) * along[node], axis=1)
    radius = np.zeros(len(parent))
    for k, above in enumerate(parent):
        own = away[node == k]
        radius[k] = np.median(own) if len(own) else radius[above] if above >= 0 else 0.0
    return np.maximum(radius, LEAST_RADIUS_M)
