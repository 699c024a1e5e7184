"""Groups render vertices that move alike into nodes with one row of the basis; the viewer moves nodes.

Vector quantisation of the basis rows, weighted by the RMS of each mode, so that distances between rows are in
metres. The cluster with the largest error is split until the error or the number of nodes reaches its limit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.sparse

from galewood.util import Array, Floats

MAX_NODES = 768
REFINEMENTS = 3


@dataclass(frozen=True)
class Nodes:
    """The quantised basis of a render mesh."""

    basis: npt.NDArray[np.float32]  # (n, 3, r) m per unit of q
    rest_m: npt.NDArray[np.float32]  # (n, 3) centroid of the node's vertices
    vertex_node: npt.NDArray[np.uint16]  # (v,)
    rms_error_m: float  # RMS distance of vertices from their nodes, at the RMS of the sampled motion
    max_error_m: float  # the same for the worst vertex


def render_basis(binding: scipy.sparse.csr_matrix, basis: Floats) -> Floats:
    """(v, 3, r) basis at the render vertices, from the basis at the tet vertices (n, 3, r)."""
    n, _, r = basis.shape
    return np.asarray(binding @ basis.reshape(n, 3 * r)).reshape(-1, 3, r)


def largest_motion_m(vertex_basis: Floats, q_rms: Floats) -> float:
    """RMS displacement of the vertex that moves most, m, for modes with RMS q_rms (r,)."""
    return float(np.sqrt(np.square(vertex_basis * q_rms).sum(axis=(1, 2)).max()))


def make_nodes(
    vertex_basis: Floats, vertices_m: Floats, q_rms: Floats, tolerance_m: float, max_nodes: int = MAX_NODES
) -> Nodes:
    """Group vertices so that none is farther than tolerance_m from its node at RMS motion q_rms (r,)."""
    v, _, r = vertex_basis.shape
    rows = (vertex_basis * q_rms).reshape(v, 3 * r)
    distinct, inverse = np.unique(np.round(rows, 9), axis=0, return_inverse=True)
    label = _split(distinct, tolerance_m, max_nodes)
    label = _refine(distinct, label)[np.ravel(inverse)]
    centre = _means(vertex_basis.reshape(v, 3 * r), label)
    error = np.linalg.norm(rows - centre[label] * np.tile(q_rms, 3), axis=1)
    return Nodes(
        centre.reshape(-1, 3, r).astype(np.float32),
        _means(vertices_m, label).astype(np.float32),
        label.astype(np.uint16),
        float(np.sqrt(np.mean(error**2))),
        float(error.max()),
    )


def _means(values: Floats, label: Array) -> Floats:
    """(labels, m) mean of the values (v, m) of each label (v,)."""
    count = int(label.max()) + 1
    gather = scipy.sparse.csr_matrix(
        (np.ones(len(label)), (label, np.arange(len(label)))), shape=(count, len(label))
    )
    return np.asarray(gather @ values) / np.bincount(label, minlength=count)[:, None]


def _split(rows: Floats, tolerance: float, max_nodes: int) -> Array:
    """Split the worst cluster across its longest axis until every row is within tolerance of its mean."""
    label = np.zeros(len(rows), np.int64)
    members = [np.arange(len(rows))]
    worst = [_spread(rows)]
    while len(members) < max_nodes:
        c = int(np.argmax(worst))
        if worst[c] <= tolerance:
            break
        first, second = _halves(rows, members[c])
        label[second] = len(members)
        members[c] = first
        worst[c] = _spread(rows[first])
        members.append(second)
        worst.append(_spread(rows[second]))
    return label


def _spread(rows: Floats) -> float:
    return float(np.sqrt(np.square(rows - rows.mean(axis=0)).sum(axis=1).max()))


def _halves(rows: Floats, members: Array) -> tuple[Array, Array]:
    """Members on either side of the mean along the longest axis of the cluster."""
    offset = rows[members] - rows[members].mean(axis=0)
    axis = offset[int(np.argmax(np.square(offset).sum(axis=1)))]
    for _ in range(3):  # power iterations, starting from the row farthest from the mean
        axis = offset.T @ (offset @ axis)
        axis /= np.linalg.norm(axis)
    side = offset @ axis > 0
    return members[~side], members[side]


def _refine(rows: Floats, label: Array) -> Array:
    """Lloyd's iterations: assign every row to its nearest mean; drop empty nodes."""
    for _ in range(REFINEMENTS):
        centre = _means(rows, label)
        near = np.square(centre).sum(axis=1)[None, :] - 2.0 * rows @ centre.T
        label = np.unique(near.argmin(axis=1), return_inverse=True)[1]
    return label
