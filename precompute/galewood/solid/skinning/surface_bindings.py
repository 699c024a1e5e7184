"""Bindings of every rendered vertex to the axis of the branches, with which it moves and turns.

Wood is bound beside itself, so that it bends with its branch. Each connected piece of twigs or foliage is
bound to one place and so stays rigid; a leaf on a twig shares the binding of that twig, and therefore never
leaves it. A piece around whole branches, such as a closed crown or a frond along its rachis, is bound along
them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from galewood.solid.skinning.attachment import PIECE_SAMPLES, SUPPORT_SAMPLES, Supports, edge_samples
from galewood.solid.skinning.axis import Axis
from galewood.solid.skinning.bindings import Bindings
from galewood.solid.skinning.chord_bindings import chord_bindings
from galewood.solid.skinning.embedding import as_stored, foliage_pieces, piece_size
from galewood.solid.skinning.wood_bindings import wood_bindings
from galewood.tree import KINDS, RenderPrimitive, TreeMesh, arms_of
from galewood.util import Floats, Ints

LARGE_PIECE = 0.1
"""Relative to the height; a larger piece is bound along the branches inside it, if there are any."""
TOUCH_DISTANCE = 0.005
"""Vertices of a frond that are at most this much farther from its support than the nearest one stay there;
relative to the height."""
FEWEST_FACES_OF_ARMS = 3
"""Two arms, and a face between them. Most pieces are cards of two faces."""
Smoothing = Callable[[RenderPrimitive, Bindings, Ints], Bindings]
"""Smoothed bindings of the vertices of a primitive, from the initial ones; some vertices (k,) are fixed."""


def vertex_bindings(
    tree: TreeMesh, axis: Axis, smoothing: Smoothing = lambda part, bindings, fixed: bindings
) -> Bindings:
    """The bindings of every render vertex of a tree, primitives concatenated.

    ``smoothing`` may change those of wood, and of foliage that is bound along branches; what attaches to wood
    follows it.
    """
    supports = Supports(axis, tree.height_m / SUPPORT_SAMPLES)
    added = tree.added_wood()
    if added:
        supports.add(added, wood_bindings(added, axis))
    found: dict[int, Bindings] = {}
    for k in sorted(range(len(tree.primitives)), key=lambda k: KINDS.index(tree.primitives[k].kind)):
        primitive = as_stored(tree.primitives[k])
        if primitive.kind == "wood":
            found[k] = smoothing(primitive, wood_bindings(primitive, axis), np.zeros(0, np.int64))
        else:
            found[k] = _attached(primitive, supports, axis, tree.height_m, smoothing)
        if primitive.kind != "leaves" and len(primitive.faces):
            supports.add(primitive, found[k])
    return Bindings.concatenated([found[k] for k in range(len(tree.primitives))])


def _attached(
    primitive: RenderPrimitive, supports: Supports, axis: Axis, height_m: float, smoothing: Smoothing
) -> Bindings:
    """Every piece with the binding of what it touches, or bound along the branches that it surrounds."""
    piece = foliage_pieces(primitive)
    samples = edge_samples(primitive, height_m / PIECE_SAMPLES)  # a card may touch with the middle of an edge
    rigid = supports.nearest(samples.place_m, piece[samples.ends[:, 0]]).take(piece)
    if primitive.kind == "twigs":
        return rigid
    bindings = _along_branches(primitive, piece, rigid, axis, height_m)
    bent = np.flatnonzero((bindings.child != rigid.child) | (bindings.share != rigid.share))
    if not len(bent):
        return bindings
    apart_m = supports.distance_m(primitive.positions_m[bent])
    fixed = np.flatnonzero(apart_m < rigid.distance_m[bent] + TOUCH_DISTANCE * height_m)
    return _smoothed_part(primitive, bindings, bent, fixed, smoothing)


def _smoothed_part(
    primitive: RenderPrimitive, bindings: Bindings, part: Ints, fixed: Ints, smoothing: Smoothing
) -> Bindings:
    """The bindings with those of some vertices (k,) smoothed, as a mesh of their own, some of it fixed."""
    index = np.full(len(primitive.positions_m), -1, dtype=np.int64)
    index[part] = np.arange(len(part))
    faces = index[primitive.faces]
    faces = faces[(faces >= 0).all(axis=1)]
    if not len(faces):
        return bindings
    own = replace(primitive, positions_m=primitive.positions_m[part], faces=faces)
    return bindings.replaced(part, smoothing(own, bindings.take(part), fixed))


def _along_branches(
    primitive: RenderPrimitive, piece: Ints, rigid: Bindings, axis: Axis, height_m: float
) -> Bindings:
    """The bindings with large pieces bound along the branches that they surround."""
    size_m = piece_size(primitive.positions_m, piece)
    by_piece = np.argsort(piece, kind="stable")
    end = np.cumsum(np.bincount(piece, minlength=len(size_m)))
    place = np.empty(len(piece), dtype=np.int64)
    place[by_piece] = np.arange(len(piece)) - np.concatenate([[0], end])[piece[by_piece]]
    face_piece = piece[primitive.faces[:, 0]]
    faces = place[primitive.faces[np.argsort(face_piece, kind="stable")]]
    face_end = np.cumsum(np.bincount(face_piece, minlength=len(size_m)))
    bent: list[Ints] = [np.zeros(0, np.int64)]
    along: list[Bindings] = [rigid.take(bent[0])]
    for number in np.flatnonzero(size_m > LARGE_PIECE * height_m).tolist():
        own = by_piece[end[number - 1] if number else 0 : end[number]]
        own_faces = faces[face_end[number - 1] if number else 0 : face_end[number]]
        start = rigid.take(own[:1])
        for arm in _arms(primitive.positions_m[own], own_faces, start):
            found = chord_bindings(primitive.positions_m[own[arm]], int(start.child[0]), axis, height_m)
            if found is not None:
                bent.append(own[arm])
                along.append(found)
    return rigid.replaced(np.concatenate(bent), Bindings.concatenated(along))


def _arms(positions_m: Floats, faces: Ints, start: Bindings) -> list[Ints]:
    """The vertices (k,) of a piece, or of each of its arms: fronds that are joined where they grow."""
    every = np.arange(len(positions_m))
    if len(faces) < FEWEST_FACES_OF_ARMS:
        return [every]
    arm = arms_of(positions_m, faces, start.at_m[0])
    of_vertex = np.zeros(len(positions_m), dtype=np.int64)
    of_vertex[faces.ravel()] = np.repeat(arm, 3)
    return [every[of_vertex == number] for number in range(int(arm.max()) + 1)]
