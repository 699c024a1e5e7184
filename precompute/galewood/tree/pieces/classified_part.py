"""Parts of one kind: what the classification of the pieces makes of the parts of a file."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import KDTree

from galewood.formats import RawPart
from galewood.tree.repair import Surface, edge_components, weld, weld_keeping_faces
from galewood.tree.surface import Bodies
from galewood.tree.types import Kind
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class ClassifiedPart:
    """A part that is entirely of one kind, and the reason."""

    part: RawPart
    kind: Kind
    reason: str
    vertex_groups: Ints  # index in `Classification.groups` of each vertex; −1: no face uses it


def sub_part(part: RawPart, faces: Ints) -> RawPart:
    """The part restricted to the given faces; vertices keep their order."""
    used, inverse = np.unique(part.faces[faces], return_inverse=True)

    def pick(rows: Floats | None) -> Floats | None:
        return None if rows is None else rows[used]

    return replace(
        part,
        positions=part.positions[used],
        faces=inverse.reshape(-1, 3).astype(np.int32),
        normals=pick(part.normals),
        uv=pick(part.uv),
        colours=pick(part.colours),
    )


def restricted(piece: ClassifiedPart, faces: Ints) -> ClassifiedPart:
    """The part with the given faces alone."""
    used = np.unique(piece.part.faces[faces])
    return replace(piece, part=sub_part(piece.part, faces), vertex_groups=piece.vertex_groups[used])


def welded_wood(pieces: list[ClassifiedPart]) -> Surface:
    """All wood as one welded surface."""
    vertices, faces, offset = [], [], 0
    for piece in pieces:
        if piece.kind == "wood":
            vertices.append(piece.part.positions)
            faces.append(piece.part.faces + offset)
            offset += len(piece.part.positions)
    return weld(Surface(np.concatenate(vertices), np.concatenate(faces).astype(np.int32)))


def without_strays(pieces: list[ClassifiedPart], kept: Floats, bodies: Bodies) -> list[ClassifiedPart]:
    """The parts without what is nearest to a body on the ground; what is nearest to a floating one is leaves.

    `kept` (n, 3) are the vertices of the wood. Connected faces go together, to the body nearest to most.
    """
    if not len(bodies.floating) + len(bodies.grounded):
        return pieces
    trees = [KDTree(points) if len(points) else None for points in (kept, bodies.floating, bodies.grounded)]
    result: list[ClassifiedPart] = []
    for piece in pieces:
        corners = piece.part.positions[piece.part.faces]
        middle = corners.mean(axis=1)
        apart = [np.full(len(middle), np.inf) if tree is None else tree.query(middle)[0] for tree in trees]
        count, of_face = edge_components(
            weld_keeping_faces(Surface(piece.part.positions, piece.part.faces)).faces
        )
        votes = np.zeros((count, len(trees)))
        np.add.at(votes, (of_face, np.argmin(apart, axis=0)), 1.0)
        nearest = np.argmax(votes, axis=1)[of_face]  # the first of equal ones: the tree
        for number, kind in ((0, piece.kind), (1, "twigs" if piece.kind == "twigs" else "leaves")):
            own = np.flatnonzero(nearest == number)
            if len(own):
                result.append(replace(restricted(piece, own), kind=kind))
    return result
