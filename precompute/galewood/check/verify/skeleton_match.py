"""Compares an extracted skeleton with a known one: branches found, fibre directions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import KDTree

from galewood.solid.skeleton import Skeleton
from galewood.solid.tets import TetMesh
from galewood.util import Floats, Ints

SPACING_M = 0.02
NEIGHBOUR_COUNT = 40
TIP_SHARE = 0.02
"""Over the height: an extracted tip within this distance of the end of a known branch matches it."""


class Found(NamedTuple):
    """Numbers of known and found branches, indices missed, and tips of unmatched extracted branches."""

    true: int
    found: int
    missed: tuple[int, ...]
    extra_tips_m: Floats


def branches_found(skeleton: Skeleton, points_m: Floats, branch: Ints) -> Found:
    """Match the tips of the extracted branches one to one with the ends of the known ones."""
    ends = np.array([points_m[np.flatnonzero(branch == k)[-1]] for k in range(int(branch.max()) + 1)])
    inner = np.unique(skeleton.parent)
    tips = skeleton.points_m[np.setdiff1d(np.arange(len(skeleton.parent)), inner)]
    gap = np.linalg.norm(ends[:, None] - tips[None], axis=2)
    near = TIP_SHARE * float(np.ptp(points_m[:, 1]))
    rows, columns = linear_sum_assignment(np.minimum(gap, near))
    good = gap[rows, columns] < near
    missed = np.setdiff1d(np.arange(len(ends)), rows[good])
    extra = np.setdiff1d(np.arange(len(tips)), columns[good])
    return Found(len(ends), int(good.sum()), tuple(int(k) for k in missed), tips[extra])


def fibre_errors(
    mesh: TetMesh, skeleton: Skeleton, points_m: Floats, radius_m: Floats, branch: Ints
) -> Floats:
    """(m,) angle, rad, between the fibre of each tet and the axis of the known branch that contains it.

    That is the branch whose axis is nearest in units of its radius, as near a fork several axes are close.
    """
    place, along, girth = (np.concatenate(v) for v in zip(*_lines(points_m, radius_m, branch), strict=True))
    centre = mesh.vertices_m[mesh.tets].mean(axis=1)
    gap, index = KDTree(place).query(centre, k=NEIGHBOUR_COUNT)
    near = np.asarray(index, np.int64)
    chosen = near[np.arange(len(near)), np.argmin(gap / girth[near], axis=1)]
    cosine = np.einsum("ij,ij->i", skeleton.tet_fibre, along[chosen])
    return np.arccos(np.clip(cosine, -1.0, 1.0))


def _lines(points_m: Floats, radius_m: Floats, branch: Ints) -> list[tuple[Floats, Floats, Floats]]:
    """Closely spaced points (k, 3), unit tangents (k, 3) and radii (k,) along each known branch."""
    lines: list[tuple[Floats, Floats, Floats]] = []
    for number in range(int(branch.max()) + 1):
        own = branch == number
        line, girth = points_m[own], radius_m[own]
        step = np.diff(line, axis=0)
        arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(step, axis=1))])
        at = np.linspace(0, arc[-1], max(int(arc[-1] / SPACING_M), 8))
        place = np.column_stack([np.interp(at, arc, line[:, k]) for k in range(3)])
        tangent = np.gradient(place, at, axis=0)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        lines.append((place, tangent, np.interp(at, arc, girth)))
    return lines
