"""Which leaves and twigs a level of detail shows: the rule of the player (web/player/src/trees/detail.ts)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from galewood.constants import BRANCH_FOOT_WEIGHT, MOST_LEAF_GROWTH, RANK_SALT, SHRINK_RANK_WIDTH
from galewood.util import Floats, Ints

FEWEST_BRANCHES = 4
"""Wood of fewer pieces stays complete."""


@dataclass(frozen=True)
class Pieces:
    """The connected pieces of a mesh, which disappear one after another."""

    of_vertex: Ints
    """(v,) piece of each vertex; pieces are numbered by their first vertex."""
    rank: Floats
    """(p,) in [0, 1): a piece shows while its rank is below the share that is shown."""
    anchor_m: Floats
    """(p, 3) the point to which a piece shrinks before it disappears."""
    leaves: bool

    def shown(self, share: float) -> Floats:
        """(p,) size of each piece at a share of detail, 0: not shown; remaining leaves grow."""
        width = SHRINK_RANK_WIDTH * share
        size = np.clip((share + width - self.rank) / width, 0.0, 1.0)
        return size * min(MOST_LEAF_GROWTH, share**-0.5) if self.leaves else size


def leaf_pieces(rest_m: Floats, faces: Ints) -> Pieces:
    """Leaves, in a random order that has a seed; each shrinks to its first vertex.

    Args:
        rest_m: (v, 3) vertices.
        faces: (f, 3) triangles.
    """
    of_vertex = _connected(faces, len(rest_m))
    _, first = np.unique(of_vertex, return_index=True)
    return Pieces(of_vertex, hash_unit(len(first)), rest_m[first], leaves=True)


def wood_pieces(rest_m: Floats, faces: Ints) -> Pieces:
    """Branches or twigs, longest first; each shrinks to its vertex nearest to the base of the trunk.

    Vertices at the same place are one, so that seams of texture coordinates do not divide a branch.
    """
    _, first, same = np.unique(rest_m + 0.0, axis=0, return_index=True, return_inverse=True)
    of_vertex = _connected(first[same.ravel()][faces], len(rest_m))[first[same.ravel()]]
    _, of_vertex = _numbered(of_vertex)
    count = int(of_vertex.max()) + 1
    size = np.bincount(of_vertex)
    centre = np.stack([np.bincount(of_vertex, rest_m[:, k]) / size for k in range(3)], axis=1)
    reach = np.zeros(count)
    np.maximum.at(reach, of_vertex, np.linalg.norm(rest_m - centre[of_vertex], axis=1))
    rank = np.zeros(count)
    if count >= FEWEST_BRANCHES:
        rank[np.argsort(-reach, kind="stable")] = np.arange(count) / count
    out = np.hypot(rest_m[:, 0], rest_m[:, 2]) + BRANCH_FOOT_WEIGHT * rest_m[:, 1]
    order = np.lexsort((out, of_vertex))
    foot = order[np.r_[True, np.diff(of_vertex[order]) > 0]]
    return Pieces(of_vertex, rank, rest_m[foot], leaves=False)


def hash_unit(count: int) -> Floats:
    """(count,) the hashes of the numbers from 0 that rank leaves: `hashUnit` in web/player/src/core/math."""
    found = np.full(count, 0x9E3779B9, np.uint32)
    for value in (np.arange(count, dtype=np.uint32), np.full(count, RANK_SALT, np.uint32)):
        found = _hash32(found ^ _hash32(value + np.uint32(0x632BE5AB)))
    return found / 2.0**32


def _hash32(value: npt.NDArray[np.uint32]) -> npt.NDArray[np.uint32]:
    mixed = (value ^ (value >> np.uint32(16))) * np.uint32(0x7FEB352D)
    mixed = (mixed ^ (mixed >> np.uint32(15))) * np.uint32(0x846CA68B)
    return mixed ^ (mixed >> np.uint32(16))


def _connected(faces: Ints, vertices: int) -> Ints:
    """(v,) connected component of each vertex, numbered by first vertex."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    one, other = np.repeat(faces[:, 0], 2), faces[:, 1:].ravel()
    graph = coo_matrix((np.ones(len(one), np.int8), (one, other)), shape=(vertices, vertices))
    _, label = connected_components(graph, directed=False)
    return _numbered(label)[1]


def _numbered(label: Ints) -> tuple[Ints, Ints]:
    """First vertex of each piece and piece of each vertex, for any labels (v,): numbered by first vertex."""
    _, first, of_vertex = np.unique(label, return_index=True, return_inverse=True)
    place = np.empty(len(first), np.int64)
    place[np.argsort(first)] = np.arange(len(first))
    return np.sort(first), place[of_vertex.ravel()]
