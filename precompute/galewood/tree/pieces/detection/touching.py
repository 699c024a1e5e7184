"""Which pieces touch: pieces with samples in neighbouring cells of a grid are connected."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from galewood.util import Floats, Ints

MAX_SAMPLES = 60_000
FORWARD_CELLS = np.array(
    [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if (i, j, k) > (0, 0, 0)]
)


def groups(corners: Floats, piece: Ints, count: int, gap: float) -> Ints:
    """Group (count,) of each piece: pieces nearer than about `gap` are in one. −1: without faces.

    `corners` (m, 3, 3) are the faces, `piece` (m,) their pieces. Large faces are sampled by area.
    """
    points, owner = _samples(corners, piece)
    cell = np.floor(points / max(gap, 1e-300)).astype(np.int64)
    cell -= cell.min(axis=0) - 1
    size = cell.max(axis=0) + 2
    key, first, inverse = np.unique(_key(cell, size), return_index=True, return_inverse=True)
    shifted = cell[first]
    held = np.unique(owner.astype(np.int64) * len(key) + inverse)
    pairs = [np.column_stack([held // len(key), count + held % len(key)])]
    for step in FORWARD_CELLS:
        wanted = _key(shifted + step, size)
        at = np.clip(np.searchsorted(key, wanted), 0, len(key) - 1)
        hit = key[at] == wanted
        pairs.append(count + np.column_stack([np.flatnonzero(hit), at[hit]]))
    edges = np.concatenate(pairs)
    total = count + len(key)
    graph = coo_matrix((np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), shape=(total, total))
    label = connected_components(graph, directed=False)[1][:count]
    present = np.zeros(count, dtype=bool)
    present[piece] = True
    result = np.full(count, -1, dtype=np.int32)
    result[present] = np.unique(label[present], return_inverse=True)[1].reshape(-1)
    return result


def _key(cells: np.ndarray, size: np.ndarray) -> np.ndarray:
    return (cells[:, 0] * size[1] + cells[:, 1]) * size[2] + cells[:, 2]


def _samples(corners: Floats, piece: Ints) -> tuple[Floats, Ints]:
    """Centres of all faces, their corners unless there are many, and MAX_SAMPLES points by area, seeded."""
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    points, owner = [corners.mean(axis=1)], [piece]
    if len(corners) < MAX_SAMPLES:
        points.append(corners.reshape(-1, 3))
        owner.append(np.repeat(piece, 3))
    if area.sum() > 0:
        random = np.random.default_rng(0)
        face = random.choice(len(corners), MAX_SAMPLES, p=area / area.sum())
        weight = random.random((MAX_SAMPLES, 2))
        weight[weight.sum(axis=1) > 1] = 1 - weight[weight.sum(axis=1) > 1]
        a, b, c = np.moveaxis(corners[face], 1, 0)
        points.append(a + weight[:, :1] * (b - a) + weight[:, 1:] * (c - a))
        owner.append(piece[face])
    return np.concatenate(points), np.concatenate(owner)
