"""Connected pieces of all parts of a file: faces that share edges, divided where their colour changes.

Pieces are numbered in the order of the file and depend on no option, so that a number in a report means the
same faces in the next import of the same file.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_matrix

from galewood.formats import RawPart
from galewood.tree.pieces.colour import FaceColours, face_colours
from galewood.tree.pieces.shape import Shapes, measure
from galewood.tree.repair import Surface, directed_edges, edge_components, weld_keeping_faces
from galewood.util import Floats, Ints

SPLIT_FACES = 24  # pieces with fewer faces are never divided by colour
SPLIT_SHARE = 0.03  # least share of the area on either side of a division
SPLIT_DISTANCE = 0.16  # least distance of the two mean colours
SPLIT_SPREAD = 0.26  # spread of the colours within both sides, relative to their distance
SPLIT_BORDER = 0.3  # faces at the border, relative to those of a random division
SMOOTHED_FACES = 2_000  # colours are smoothed in pieces of so many faces
SMOOTHING_ROUNDS = 24  # each reaches one face farther
LIGHTNESS_WEIGHT = 0.35  # weight of lightness beside hue: a crown may be lit from one side


@dataclass(frozen=True)
class Pieces:
    """All pieces of a file: their part, shape and colour, one row per piece."""

    part: Ints
    number: Ints  # within the part
    of_face: list[Ints]  # for each part, the piece of each face
    shapes: Shapes
    rgb: Floats  # (k, 3) mean sRGB
    cut_out: Floats  # mean share that the alpha channel cuts out
    coloured: np.ndarray  # whether the colour is known

    def turned(self, rotation: Floats) -> Pieces:
        """The pieces in turned axes; `rotation` (3, 3) maps axes to axes."""
        return replace(self, shapes=self.shapes.turned(rotation))

    def __len__(self) -> int:
        return len(self.part)


def find_pieces(parts: list[RawPart]) -> Pieces:
    """The pieces of all parts, in their axes."""
    of_face: list[Ints] = []
    part_of: list[Ints] = []
    colours: list[FaceColours] = []
    borders: list[Floats] = []
    numbers: list[Ints] = []
    total = 0
    for number, part in enumerate(parts):
        welded = weld_keeping_faces(Surface(part.positions, part.faces))
        colour = face_colours(part)
        count, label = _in_file_order(edge_components(welded.faces)[1])
        if colour.known:
            count, label = _in_file_order(_divided(welded, label, count, colour))
        borders.append(_border(welded))
        colours.append(colour)
        of_face.append((label + total).astype(np.int32))
        part_of.append(np.full(count, number, dtype=np.int32))
        numbers.append(np.arange(count, dtype=np.int32))
        total += count
    corners = np.concatenate([p.positions[p.faces] for p in parts])
    piece = np.concatenate(of_face)
    shapes = measure(corners, piece, total, np.concatenate(borders))
    rgb, cut_out = _mean_colours(corners, piece, total, colours)
    part_index = np.concatenate(part_of)
    known = np.array([c.known for c in colours])[part_index]
    return Pieces(part_index, np.concatenate(numbers), of_face, shapes, rgb, cut_out, known)


def with_new_pieces(pieces: Pieces, parts: list[RawPart], part: int, faces: Ints) -> Pieces:
    """The pieces with some faces of a part as one more piece, numbered after all others of its part."""
    count = len(pieces)
    of_face = list(pieces.of_face)
    of_face[part] = of_face[part].copy()
    old = int(of_face[part][faces[0]])
    of_face[part][faces] = count
    corners = np.concatenate([p.positions[p.faces] for p in parts])
    borders = [_border(weld_keeping_faces(Surface(p.positions, p.faces))) for p in parts]
    numbers = pieces.number[pieces.part == part]
    return Pieces(
        part=np.append(pieces.part, part).astype(np.int32),
        number=np.append(pieces.number, numbers.max() + 1).astype(np.int32),
        of_face=of_face,
        shapes=measure(corners, np.concatenate(of_face), count + 1, np.concatenate(borders)),
        rgb=np.vstack([pieces.rgb, pieces.rgb[old]]),
        cut_out=np.append(pieces.cut_out, pieces.cut_out[old]),
        coloured=np.append(pieces.coloured, pieces.coloured[old]),
    )


def _in_file_order(label: Ints) -> tuple[int, Ints]:
    """Labels renumbered by their first face."""
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    return len(first), rank[inverse.reshape(-1)].astype(np.int32)


def _border(surface: Surface) -> Floats:
    """Length (m,) of the sides of each face that belong to no other face."""
    edges = directed_edges(surface.faces)
    ordered = np.sort(edges, axis=1).astype(np.int64)
    key = ordered[:, 0] * (len(surface.vertices) + 1) + ordered[:, 1]
    _, inverse, count = np.unique(key, return_inverse=True, return_counts=True)
    length = np.linalg.norm(surface.vertices[edges[:, 0]] - surface.vertices[edges[:, 1]], axis=1)
    alone = np.where(count[inverse.reshape(-1)] == 1, length, 0.0)
    return alone.reshape(3, -1).sum(axis=0)


def _mean_colours(
    corners: Floats, piece: Ints, count: int, colours: list[FaceColours]
) -> tuple[Floats, Floats]:
    size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    size = size + 1e-12 * max(float(size.max()), 1e-300)
    total = np.bincount(piece, size, count)
    rows = np.concatenate([np.column_stack([c.rgb, c.cut_out]) for c in colours])
    means = np.stack([np.bincount(piece, size * rows[:, k], count) / total for k in range(4)], axis=1)
    return means[:, :3], means[:, 3]


def _divided(surface: Surface, label: Ints, count: int, colour: FaceColours) -> Ints:
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
        for k in np.flatnonzero((sizes >= SPLIT_FACES) & (spread > SPLIT_DISTANCE * 0.15)):
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
        label = result
    return label


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
    for _ in range(SMOOTHING_ROUNDS):
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
    return second if distance >= SPLIT_DISTANCE and spread <= SPLIT_SPREAD * distance else None


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
