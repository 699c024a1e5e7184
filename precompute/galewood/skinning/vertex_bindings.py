"""Where every rendered vertex is held: a place on the axis of a branch, with which it moves and turns.

The bark is held beside itself, so that it bends with its branch. Each connected piece of foliage or twigs is
held at one place and so stays rigid; a leaf on a twig shares the place of that twig, and therefore never
leaves it. A piece around whole branches, such as a closed crown or a frond along its rachis, is held along
them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from galewood.mesh import RenderPrimitive, TreeMesh, arms_of
from galewood.model.axis import Axis, Feet, chosen, joined
from galewood.model.bark import bark_feet
from galewood.model.bearers import Bearers, edge_points
from galewood.model.binding import foliage_pieces, piece_size
from galewood.model.midrib import midrib_of
from galewood.util import Ints

KINDS = ("wood", "twigs", "leaves")
"""Kinds of primitives in the order in which they bear each other."""
LARGE_PIECE = 0.1
"""Relative to the height; a larger piece is held along the branches inside it, if there are any."""
SAMPLES, LEAF_SAMPLES = 400, 200
"""What bears and what is borne are sampled at these fractions of the height."""


TOUCH = 0.005
"""Vertices of a frond that are at most this much farther from what bears it than the nearest one stay there;
relative to the height."""
Improved = Callable[[RenderPrimitive, Feet, Ints], Feet]
"""Better places of the vertices of a primitive, from those given; some vertices (k,) stay where they are."""


def holds_of(tree: TreeMesh, axis: Axis, improved: Improved = lambda part, feet, still: feet) -> Feet:
    """The place of every render vertex of a tree on its axis, primitives concatenated.

    ``improved`` may change the places of a wood primitive, and of foliage that is held along branches; what
    hangs on wood follows it.
    """
    bearers = Bearers(axis, tree.height_m / SAMPLES)
    added = tree.added_wood()
    if added:
        bearers.add(added, bark_feet(added, axis))
    found: dict[int, Feet] = {}
    for k in sorted(range(len(tree.primitives)), key=lambda k: KINDS.index(tree.primitives[k].kind)):
        primitive = as_stored(tree.primitives[k])
        if primitive.kind == "wood":
            found[k] = improved(primitive, bark_feet(primitive, axis), np.zeros(0, np.int64))
        else:
            found[k] = _hung(primitive, bearers, axis, tree.height_m, improved)
        if primitive.kind != "leaves" and len(primitive.faces):
            bearers.add(primitive, found[k])
    return joined([found[k] for k in range(len(tree.primitives))])


def as_stored(primitive: RenderPrimitive) -> RenderPrimitive:
    """The primitive with positions rounded to 32 bits, as stored in the render mesh.

    A leaf equally near to two twigs is then held by the same one when that file is read again.
    """
    return replace(primitive, positions_m=primitive.positions_m.astype(np.float32).astype(np.float64))


def _hung(
    primitive: RenderPrimitive, bearers: Bearers, axis: Axis, height_m: float, improved: Improved
) -> Feet:
    """Every piece at the place of what it touches, or at places along the branches that it surrounds."""
    piece = foliage_pieces(primitive)
    points = edge_points(primitive, height_m / LEAF_SAMPLES)  # a card may be borne by the middle of its edge
    feet = chosen(bearers.nearest(points.place_m, piece[points.ends[:, 0]]), piece)
    if primitive.kind == "twigs":
        return feet
    held = _along_branches(primitive, piece, feet, axis, height_m)
    bent = np.flatnonzero((held.child != feet.child) | (held.share != feet.share))
    if not len(bent):
        return held
    apart_m = bearers.distance_m(primitive.positions_m[bent])
    still = np.flatnonzero(apart_m < feet.distance_m[bent] + TOUCH * height_m)
    return _improved_part(primitive, held, bent, still, improved)


def _improved_part(
    primitive: RenderPrimitive, feet: Feet, part: Ints, still: Ints, improved: Improved
) -> Feet:
    """The feet with those of some vertices (k,) improved, as a mesh of their own, of which some stay."""
    index = np.full(len(primitive.positions_m), -1, dtype=np.int64)
    index[part] = np.arange(len(part))
    faces = index[primitive.faces]
    faces = faces[(faces >= 0).all(axis=1)]
    if not len(faces):
        return feet
    own = replace(primitive, positions_m=primitive.positions_m[part], faces=faces)
    found = improved(own, chosen(feet, part), still)
    child, share, at_m = feet.child.copy(), feet.share.copy(), feet.at_m.copy()
    child[part], share[part], at_m[part] = found.child, found.share, found.at_m
    return Feet(child, share, at_m, feet.distance_m)


def _along_branches(primitive: RenderPrimitive, piece: Ints, feet: Feet, axis: Axis, height_m: float) -> Feet:
    """The same, but large pieces are held along the branches that they surround."""
    large = np.flatnonzero(piece_size(primitive.positions_m, piece) > LARGE_PIECE * height_m)
    child, share, at_m = feet.child.copy(), feet.share.copy(), feet.at_m.copy()
    for number in large.tolist():
        own = np.flatnonzero(piece == number)
        held = chosen(feet, own[:1])
        for arm in _arms(primitive, own, held):
            rib = midrib_of(primitive.positions_m[arm], int(held.child[0]), axis, height_m)
            if rib is not None:
                child[arm], share[arm], at_m[arm] = rib.child, rib.share, rib.at_m
    return Feet(child, share, at_m, feet.distance_m)


def _arms(primitive: RenderPrimitive, own: Ints, held: Feet) -> list[Ints]:
    """The vertices (k,) of a piece, or of each of its arms: fronds that are joined where they grow."""
    inside = np.zeros(len(primitive.positions_m), dtype=bool)
    inside[own] = True
    faces = primitive.faces[inside[primitive.faces[:, 0]]]
    if not len(faces):
        return [own]
    arm = arms_of(primitive.positions_m, faces, held.at_m[0])
    of_vertex = np.zeros(len(primitive.positions_m), dtype=np.int64)
    of_vertex[faces.ravel()] = np.repeat(arm, 3)
    return [own[of_vertex[own] == number] for number in range(int(arm.max()) + 1)]
