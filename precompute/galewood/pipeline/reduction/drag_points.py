"""Drag points of the modal model: the nodes of a crown, clustered by how they move.

Nodes whose velocities are alike feel the same drag, so a few averages replace thousands of nodes. What the
average of a cluster loses, the motion of its nodes relative to it, is kept as a damping of each oscillator.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.pipeline.reduction.clusters import clusters
from galewood.pipeline.reduction.oscillators import Oscillators
from galewood.util import Floats, Singles

POINT_COUNT = 12


@dataclass(frozen=True)
class DragPoints:
    """Tensors of the drag: point (m, 2), shape (3, m, d), rest (d,), place (m, G); see ``ModalTensors``."""

    point: Singles
    shape: Singles
    rest: Singles
    place: Singles
    streamlined_exponent: float


def drag_points(own: Oscillators, speed: Floats) -> DragPoints:
    """Drag points of a model whose oscillators have the given typical speeds (d,), m·√kg/s."""
    d = len(own.omega)
    nodes = np.flatnonzero(own.exposure.area_m2 > 0)
    if not len(nodes):
        shapes = ((0, 2), (3, 0, d), (d,), (0, own.places.count))
        nothing = (np.zeros(shape, np.float32) for shape in shapes)
        return DragPoints(*nothing, streamlined_exponent=own.exposure.streamlined_exponent)
    profile = own.exposure.profile[nodes]
    motion = own.shapes.reshape(d, -1, 3)[:, nodes].transpose(1, 2, 0) / profile[:, None, None]
    # A node's force acts on the oscillators by its displacement, not by that over the profile.
    area = own.exposure.area_m2[nodes] * profile
    cluster = clusters((motion * speed).reshape(len(nodes), -1), area, min(POINT_COUNT, len(nodes)))
    count, sheltered = int(cluster.max()) + 1, area * own.exposure.share[nodes]
    point, shape, rest = np.zeros((count, 2)), np.zeros((3, count, d)), np.zeros(d)
    place = np.zeros((count, own.places.count))
    for j in range(count):
        inside = cluster == j
        weight = area[inside] / area[inside].sum()
        mean = np.einsum("n,nik->ik", weight, motion[inside])
        point[j] = area[inside].sum(), weight @ own.exposure.share[nodes][inside]
        shape[:, j] = mean
        rest += np.einsum("n,nik->k", area[inside], np.square(motion[inside] - mean))
        felt = sheltered[inside] / max(float(sheltered[inside].sum()), 1e-30)
        place[j] = felt @ own.places.weight[nodes][inside]
    tensors = (tensor.astype(np.float32) for tensor in (point, shape, rest, place))
    return DragPoints(*tensors, streamlined_exponent=own.exposure.streamlined_exponent)
