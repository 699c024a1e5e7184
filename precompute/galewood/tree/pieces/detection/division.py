"""Division of connected pieces where their colour changes: trunk and crown that are welded together."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from galewood.tree.pieces.detection.colour import FaceColours
from galewood.tree.repair import Surface, directed_edges
from galewood.util import Floats, Ints

SPLIT_FACES = 24  # pieces with fewer faces are never divided by colour
SPLIT_SHARE = 0.03  # least share of the area on either side of a division
SPLIT_DISTANCE = 0.16  # least distance of the two mean colours
SPLIT_SPREAD = 0.26  # spread of the colours within both sides, relative to their distance
SMOOTH_SPLIT_DISTANCE, SMOOTH_SPLIT_SPREAD = 0.085, 0.33  # the same where colours are smoothed
SPLIT_BORDER = 0.3  # faces at the border, relative to those of a random division
REGION_SHARE = 0.02  # least area of a region of one colour that is a piece of its own, of all with its label
SMOOTHED_FACES = 2_000  # colours are smoothed in pieces of so many faces
FACES_PER_ROUND, SMOOTHING_ROUNDS = 2_000, (3, 24)  # the reach grows with the root of their number
LIGHTNESS_WEIGHT = 0.35  # weight of lightness beside hue: a crown may be lit from one side


def divided(surface: Surface, label: Ints, count: int, colour: FaceColours) -> Ints:
    """Labels in which pieces of two clearly different, separate colours are divided, twice at most."""
    pairs = _adjacent(surface.faces)
    mark = np.zeros(len(label), dtype=bool)
    corners = surface.vertices[surface.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    area = area + 1e-12 * max(float(area.max()), 1e-300)
    seen = _smoothed(_opponent(colour.rgb), pairs, np.bincount(label, minlength=count)[label])
    for _ in range(2):
        sizes = np.bincount(label, minlength=count)
        spread = _spreads(seen, label, count, area)
        order = np.argsort(label, kind="stable")
        bounds = np.concatenate([[0], np.cumsum(sizes)])
        pairs = pairs[label[pairs[:, 0]] == label[pairs[:, 1]]]
        pairs = pairs[np.argsort(label[pairs[:, 0]], kind="stable")]
        pair_bounds = np.searchsorted(label[pairs[:, 0]], np.arange(count + 1))
        result = label.copy()
        for k in np.flatnonzero((sizes >= SPLIT_FACES) & (spread > SMOOTH_SPLIT_DISTANCE * 0.15)):
            faces = order[bounds[k] : bounds[k + 1]]
            second = _two_colours(seen[faces], area[faces])
            if second is None:
                continue
            mark[faces] = second
            if not _separate(mark[pairs[pair_bounds[k] : pair_bounds[k + 1]]], float(second.mean())):
                continue
            result[faces[second]] = count
            count += 1
        if count == len(sizes):
            break
        label = _apart(result, pairs, area)
        count = int(label.max()) + 1
    return label


def _apart(label: Ints, pairs: Ints, area: Floats) -> Ints:
    """Labels in which large regions of one label that do not touch are divided: a crown and the ground.

    `pairs` (n, 2) are neighbouring faces. Small regions stay with the largest one of their label.
    """
    alike = pairs[label[pairs[:, 0]] == label[pairs[:, 1]]]
    graph = coo_matrix((np.ones(len(alike)), (alike[:, 0], alike[:, 1])), shape=(len(label), len(label)))
    regions, region = connected_components(graph, directed=False)
    label_of = np.empty(regions, dtype=np.int64)
    label_of[region] = label
    size = np.bincount(region, area, regions)
    whole = np.bincount(label_of, size)
    order = np.lexsort((-size, label_of))
    largest = np.zeros(len(whole), dtype=np.int64)
    largest[label_of[order][::-1]] = order[::-1]
    alone = size >= REGION_SHARE * whole[label_of]
    target = np.where(alone, np.arange(regions), largest[label_of])
    return np.unique(target[region], return_inverse=True)[1].reshape(-1).astype(np.int32)


def _opponent(rgb: Floats) -> Floats:
    """Colours as red − green, yellow − blue and little lightness: hue tells bark from leaves."""
    r, g, b = rgb.T
    return np.column_stack([r - g, (r + g) / 2 - b, LIGHTNESS_WEIGHT * (r + g + b) / 3])


def _smoothed(seen: Floats, pairs: Ints, size: Ints) -> Floats:
    """Colours (m, 3) averaged over neighbours in pieces of many faces; `size` (m,) is that of their pieces.

    A scan has the noise and the shadows of its photographs on faces much smaller than what they show.
    """
    fine = size[pairs[:, 0]] >= SMOOTHED_FACES
    if not fine.any():
        return seen
    first, second = pairs[fine].T
    ones = np.ones(2 * len(first))
    rows, columns = np.concatenate([first, second]), np.concatenate([second, first])
    beside = coo_matrix((ones, (rows, columns)), shape=(len(seen), len(seen))).tocsr()
    degree = 1 + np.bincount(rows, minlength=len(seen))[:, None]
    for _ in range(int(np.clip(size.max() // FACES_PER_ROUND, *SMOOTHING_ROUNDS))):
        seen = (seen + beside @ seen) / degree
    return seen


def _spreads(seen: Floats, label: Ints, count: int, area: Floats) -> Floats:
    """Standard deviation of the colours within each piece."""
    total = np.bincount(label, area, count)
    variance = np.zeros(count)
    for column in seen.T:
        mean = np.bincount(label, area * column, count) / total
        variance += np.bincount(label, area * (column - mean[label]) ** 2, count) / total
    return np.sqrt(variance)


def _two_colours(seen: Floats, area: Floats) -> np.ndarray | None:
    """Which faces have the second of two clearly different colours; None if there are not two (2-means)."""
    mean = np.average(seen, axis=0, weights=area)
    _, axes = np.linalg.eigh(((seen - mean) * area[:, None]).T @ (seen - mean))
    along = (seen - mean) @ axes[:, -1]
    cut = (float(along.min()) + float(along.max())) / 2
    for _ in range(20):
        second = along > cut
        if not second.any() or second.all():
            return None
        first_mean = np.average(along[~second], weights=area[~second])
        second_mean = np.average(along[second], weights=area[second])
        cut = (first_mean + second_mean) / 2
    second = along > cut
    if not second.any() or second.all():
        return None
    first_mean = np.average(along[~second], weights=area[~second])
    second_mean = np.average(along[second], weights=area[second])
    share = float(area[second].sum() / area.sum())
    if not SPLIT_SHARE <= share <= 1 - SPLIT_SHARE:
        return None
    distance = float(second_mean - first_mean)
    inside = along - np.where(second, second_mean, first_mean)
    spread = float(np.sqrt(np.average(inside**2, weights=area)))
    smooth = len(seen) >= SMOOTHED_FACES
    least, most = (SMOOTH_SPLIT_DISTANCE, SMOOTH_SPLIT_SPREAD) if smooth else (SPLIT_DISTANCE, SPLIT_SPREAD)
    return second if distance >= least and spread <= most * distance else None


def _separate(sides: np.ndarray, share: float) -> bool:
    """Whether few neighbouring faces differ, compared with a random division: spots do not divide a piece.

    `sides` (n, 2) says for pairs of neighbours whether each is on the second side, `share` how many are.
    """
    if not len(sides):
        return True
    return float((sides[:, 0] != sides[:, 1]).mean()) <= SPLIT_BORDER * 2 * share * (1 - share)


def _adjacent(faces: Ints) -> Ints:
    """Pairs (n, 2) of faces that share an edge."""
    edges = np.sort(directed_edges(faces), axis=1)
    face = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    same = (edges[order][1:] == edges[order][:-1]).all(axis=1)
    return np.column_stack([face[order][:-1][same], face[order][1:][same]])
