"""Drag points of the modal model: the nodes of a crown, clustered by how they move.

Nodes whose velocities are alike feel the same drag, so a few averages replace thousands of nodes. What the
average of a cluster loses, the motion of its nodes relative to it, is kept as a damping of each oscillator.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.pipeline.reduction.oscillators import Oscillators
from galewood.util import Array, Floats, Singles

POINTS_FEW, POINTS_MANY = 4, 8
"""Drag points of a model with at most ``FEW_OSCILLATORS`` oscillators, and of a larger one."""
FEW_OSCILLATORS = 16
ROUND_COUNT = 40


@dataclass(frozen=True)
class DragPoints:
    """Tensors of the drag: point (m, 2), shape (3, m, d), rest (d,); see ``ModalTensors``."""

    point: Singles
    shape: Singles
    rest: Singles
    streamlined_exponent: float


def drag_points(own: Oscillators, speed: Floats) -> DragPoints:
    """Drag points of a model whose oscillators have the given typical speeds (d,), m·√kg/s."""
    d = len(own.omega)
    nodes = np.flatnonzero(own.exposure.area_m2 > 0)
    if not len(nodes):
        nothing = (np.zeros(shape, np.float32) for shape in ((0, 2), (3, 0, d), (d,)))
        return DragPoints(*nothing, streamlined_exponent=own.exposure.streamlined_exponent)
    profile = own.exposure.profile[nodes]
    motion = own.shapes.reshape(d, -1, 3)[:, nodes].transpose(1, 2, 0) / profile[:, None, None]
    # A node's force acts on the oscillators by its displacement, not by that over the profile.
    area = own.exposure.area_m2[nodes] * profile
    count = min(POINTS_FEW if d <= FEW_OSCILLATORS else POINTS_MANY, len(nodes))
    cluster = clusters((motion * speed).reshape(len(nodes), -1), area, count)
    count = int(cluster.max()) + 1
    point, shape, rest = np.zeros((count, 2)), np.zeros((3, count, d)), np.zeros(d)
    for j in range(count):
        inside = cluster == j
        weight = area[inside] / area[inside].sum()
        mean = np.einsum("n,nik->ik", weight, motion[inside])
        point[j] = area[inside].sum(), weight @ own.exposure.share[nodes][inside]
        shape[:, j] = mean
        rest += np.einsum("n,nik->k", area[inside], np.square(motion[inside] - mean))
    tensors = (tensor.astype(np.float32) for tensor in (point, shape, rest))
    return DragPoints(*tensors, streamlined_exponent=own.exposure.streamlined_exponent)


def clusters(places: Floats, weight: Floats, count: int) -> Array:
    """Cluster (n,) of each place (n, k): k-means (Lloyd), begun at places far from each other."""
    first = np.argmax(weight * np.square(places).sum(axis=1))
    centres = [places[first]]
    distance = np.square(places - centres[0]).sum(axis=1)
    for _ in range(count - 1):
        centres.append(places[np.argmax(weight * distance)])
        distance = np.minimum(distance, np.square(places - centres[-1]).sum(axis=1))
    centre, cluster = np.array(centres), np.zeros(len(places), np.int64)
    for _ in range(ROUND_COUNT):
        nearest = np.argmin([np.square(places - one).sum(axis=1) for one in centre], axis=0)
        if (nearest == cluster).all():
            break
        cluster = nearest
        for j in np.unique(cluster):
            centre[j] = np.average(places[cluster == j], axis=0, weights=weight[cluster == j])
    return np.unique(cluster, return_inverse=True)[1]
