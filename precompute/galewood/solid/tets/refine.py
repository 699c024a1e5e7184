"""Refinement of a tetrahedral mesh by bisection of its longest edges.

Only edges that are the longest of every tet around them are split, so angles stay bounded (Rivara 1984,
"Algorithms for refining triangular grids suitable for adaptive and multigrid techniques").
"""

from __future__ import annotations

import numpy as np

from galewood.util import Floats, Ints

EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
MAX_ROUNDS = 60


def refined(vertices: Floats, tets: Ints, fewest: int) -> tuple[Floats, Ints]:
    """The same solid with at least `fewest` tets; meshes that have as many are returned unchanged."""
    for _ in range(MAX_ROUNDS):
        if len(tets) >= fewest:
            break
        vertices, tets = _split_longest(vertices, tets, fewest - len(tets))
    return vertices, tets


def _split_longest(vertices: Floats, tets: Ints, wanted: int) -> tuple[Floats, Ints]:
    """Split the longest edges until there are about `wanted` more tets, or no edge is left to split."""
    edge_of_tet, ends, around, length = _edges(vertices, tets)
    rank = np.empty(len(ends), dtype=np.int64)
    rank[np.argsort(length, kind="stable")] = np.arange(len(ends))
    longest = np.argmax(rank[edge_of_tet], axis=1)
    of_tet = edge_of_tet[np.arange(len(tets)), longest]
    ready = np.flatnonzero(np.bincount(of_tet, minlength=len(ends)) == around)
    ready = ready[np.argsort(-rank[ready])]
    chosen = ready[: int(np.searchsorted(np.cumsum(around[ready]), wanted)) + 1]
    middle = np.full(len(ends), -1, dtype=np.int64)
    middle[chosen] = len(vertices) + np.arange(len(chosen))
    cut = np.flatnonzero(middle[of_tet] >= 0)
    lower, upper = tets[cut].copy(), tets[cut].copy()
    row, pair = np.arange(len(cut)), EDGES[longest[cut]]
    lower[row, pair[:, 1]] = middle[of_tet[cut]]
    upper[row, pair[:, 0]] = middle[of_tet[cut]]
    kept = np.delete(tets, cut, axis=0)
    added = vertices[ends[chosen]].mean(axis=1)
    return np.concatenate([vertices, added]), np.concatenate([kept, lower, upper]).astype(np.int32)


def _edges(vertices: Floats, tets: Ints) -> tuple[Ints, Ints, Ints, Floats]:
    """Edges of each tet (m, 6); ends (e, 2), number of tets around and length of each edge."""
    ends, edge_of_tet, around = np.unique(
        np.sort(tets[:, EDGES].reshape(-1, 2), axis=1), axis=0, return_inverse=True, return_counts=True
    )
    length = np.linalg.norm(vertices[ends[:, 0]] - vertices[ends[:, 1]], axis=1)
    return edge_of_tet.reshape(-1, 6), ends, around, length
