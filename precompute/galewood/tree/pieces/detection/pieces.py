"""Connected pieces of all parts of a file: faces that share edges, divided where their colour changes.

Pieces are numbered in the order of the file and depend on no option, so that a number in a report means the
same faces in the next import of the same file.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from galewood.formats import RawPart
from galewood.tree.pieces.detection.colour import FaceColours, face_colours
from galewood.tree.pieces.detection.division import divided
from galewood.tree.pieces.detection.shape import Shapes, measure
from galewood.tree.repair import Surface, directed_edges, edge_components, weld_keeping_faces
from galewood.util import Floats, Ints


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
    body: Ints  # number of the connected surface, before it was divided by colour

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
    bodies: list[Ints] = []
    total = 0
    for number, part in enumerate(parts):
        welded = weld_keeping_faces(Surface(part.positions, part.faces))
        colour = face_colours(part)
        count, label = _in_file_order(edge_components(welded.faces)[1])
        surface = label
        if colour.known:
            count, label = _in_file_order(divided(welded, label, count, colour))
        body = np.zeros(count, dtype=np.int32)
        body[label] = surface + total
        bodies.append(body)
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
    return Pieces(
        part_index, np.concatenate(numbers), of_face, shapes, rgb, cut_out, known, np.concatenate(bodies)
    )


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
        body=np.append(pieces.body, pieces.body[old]).astype(np.int32),
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
