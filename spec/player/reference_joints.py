"""Where the vertices of a Galewood table are drawn, from spec/formats/table.md alone."""

from __future__ import annotations

from typing import Any

import numpy as np

LONGEST = 1.02


def drawn(t: dict[str, Any], rest: Any, q: Any) -> Any:
    """(v, 3) vertices at `rest` in the tree's frame, bent by the pose q; `t`: the tensors of the table."""
    moved, curl, parent = t["nodes.basis"] @ q, t["nodes.turn"] @ q, t["nodes.parent"]
    link = t["nodes.rest_m"] - t["nodes.rest_m"][parent]
    now = link + moved - moved[parent]
    lengths = np.linalg.norm([link, now], axis=2)
    curl = curl / np.clip(lengths[1] / np.maximum(lengths[0], 1e-12), 1, 2)[:, None]
    excess = now * np.maximum(0.0, 1 - LONGEST * lengths[0] / np.maximum(lengths[1], 1e-12))[:, None]
    for node in range(len(parent)):
        if parent[node] != node:
            excess[node] += excess[parent[node]]
    (first, second), share = t["joints.nodes"].T, t["joints.share"][:, None]
    moved = moved - excess
    moved, curl = ((1 - share) * x[first] + share * x[second] for x in (moved, curl))
    joint = t["render.vertex_joint"]
    place, squared = t["joints.rest_m"][joint], (curl**2).sum(1, keepdims=True)
    axis = (curl / (1 + squared**2) ** 0.25)[joint]
    cosine, arm = np.sqrt(1 - (axis**2).sum(1, keepdims=True)), rest - place
    along = (axis * arm).sum(1, keepdims=True) / (1 + cosine)
    return place + moved[joint] + cosine * arm + np.cross(axis, arm) + axis * along
