"""The diameter of a stem, from the section of the surface of a tree's wood at a height."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from galewood.util import Floats, Ints

STEM_WIDTH_SHARE = 0.5
"""Sections at least this wide, relative to the widest, are of stems."""
JOINED_M = 1e-6
"""Segments whose ends are this near are neighbours."""


def diameter_cm(vertices_m: Floats, faces: Ints, height_m: float) -> float | None:
    """Diameter of the circle with the area of the stem's section at a height, cm; None: no wood there.

    Boughs that hang to that height are no part of the stem: only the loops of the section that are at least
    half as wide as the widest count, several of a forked tree.
    """
    starts, ends = _section(vertices_m, faces, height_m)
    if not len(starts):
        return None
    loop = _loops(starts, ends)
    count = int(loop.max()) + 1
    points = np.bincount(loop, minlength=count)
    middle = np.stack([np.bincount(loop, starts[:, axis], count) / points for axis in (0, 1)], axis=1)[loop]
    a, b = starts - middle, ends - middle
    area = abs(np.bincount(loop, a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], count)) / 2
    around = np.bincount(loop, np.linalg.norm(ends - starts, axis=1), count)
    # Of a circle its diameter, of a long slit twice its width.
    width = 4 * area / np.maximum(around, np.finfo(float).tiny)
    stems = area[width >= STEM_WIDTH_SHARE * width.max()].sum()
    return 100 * float(np.sqrt(4 * stems / np.pi)) if stems > 0 else None


def _section(vertices_m: Floats, faces: Ints, height_m: float) -> tuple[Floats, Floats]:
    """(k, 2) starts and ends of the segments in which faces cut a level plane, one way around the wood."""
    corner = vertices_m[faces]
    above = corner[:, :, 1] > height_m
    cut = corner[above.any(axis=1) & ~above.all(axis=1)]
    high = cut[:, :, 1] > height_m
    # Turn each face so that its single corner on one side comes first.
    lone = np.where(high.sum(axis=1) == 1, high.argmax(axis=1), (~high).argmax(axis=1))
    cut = np.take_along_axis(cut, ((lone[:, None] + np.arange(3)) % 3)[:, :, None], axis=1)
    ends: list[Floats] = []
    for other in (1, 2):
        share = (height_m - cut[:, 0, 1]) / (cut[:, other, 1] - cut[:, 0, 1])
        ends.append((cut[:, 0] + share[:, None] * (cut[:, other] - cut[:, 0]))[:, [0, 2]])
    swapped = (cut[:, 0, 1] > height_m)[:, None]
    return np.where(swapped, ends[0], ends[1]), np.where(swapped, ends[1], ends[0])


def _loops(starts: Floats, ends: Floats) -> Ints:
    """(k,) the loop of each segment: those with a common end are of one."""
    count = len(starts)
    pairs = KDTree(np.concatenate([starts, ends])).query_pairs(JOINED_M, output_type="ndarray") % count
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return connected_components(links, directed=False)[1]
