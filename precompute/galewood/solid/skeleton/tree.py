"""From sections to a rooted tree: parents, tips, removal of spurs, branches by longest reach. Arrays only."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from galewood.solid.skeleton.levels import Sections
from galewood.util import Floats, Ints

BUMP_RADII = 1.5  # of a limb; sections are oblique, so a bump on the bark starts behind the axis
LONGEST_SPUR = 3.0  # relative to the largest radius
SPUR_RADII = 1.2  # a twig that protrudes by less than this many of its own radii is a spur


@dataclass(frozen=True)
class Tree:
    """A rooted tree of skeleton points.

    points_m (p, 3), parent (p,) with −1 at the root (parents precede children), area_m2 (p, 3), piece (p,):
    the slab component between a point and its parent.
    """

    points_m: Floats
    parent: Ints
    area_m2: Floats
    piece: Ints


def linked_tree(
    sections: Sections, vertices_m: Floats, cells: Ints, distance_m: Floats, base_m: Floats
) -> Tree:
    """Link each section to the one below; the base comes first, and each twig ends with a tip."""
    lower: dict[int, list[int]] = {}
    for index, piece in enumerate(sections.above.tolist()):
        lower.setdefault(piece, []).append(index)
    points, parent, area, pieces = [base_m], [-1], [np.zeros(3)], [-1]
    for index in range(len(sections.level)):
        candidates = lower.get(int(sections.below[index]), [])
        if not candidates:  # the first section of all, or of a limb that is a surface of its own
            candidates = np.flatnonzero(sections.level < sections.level[index]).tolist()
        gaps = np.linalg.norm(sections.centre_m[candidates] - sections.centre_m[index], axis=1)
        points.append(sections.centre_m[index])
        parent.append(candidates[int(np.argmin(gaps))] + 1 if candidates else 0)
        area.append(sections.area_m2[index])
        pieces.append(int(sections.below[index]))
    has_upper = set(sections.below.tolist())
    far = _farthest(sections, cells, distance_m)
    for piece, indices in lower.items():
        if piece not in has_upper and piece in far:
            section = indices[0] + 1
            points.append(_tip(points[section], points[parent[section]], vertices_m[far[piece]]))
            parent.append(section)
            area.append(sections.area_m2[indices[0]] * 0.25)
            pieces.append(piece)
    return Tree(
        np.array(points), np.array(parent, dtype=np.int32), np.array(area), np.array(pieces, dtype=np.int32)
    )


def section_radii(tree: Tree, points_m: Floats) -> Floats:
    """Radius (p,) of the circle with the area of each section projected along the axis."""
    along = points_m - points_m[np.maximum(tree.parent, 0)]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    whole = np.linalg.norm(tree.area_m2, axis=1)
    projected = np.abs(np.einsum("ij,ij->i", tree.area_m2, along))
    radius = np.sqrt(np.maximum(projected, 0.5 * whole) / np.pi)
    children = np.flatnonzero(tree.parent == 0)
    radius[0] = radius[children].max() if len(children) else 0.0
    return radius


def meetings(sections: Sections) -> int:
    """Number of loops in the wood: places where two paths from the roots meet because limbs fused in the
    solid.

    All but one of the paths then end there and count as branches, although none ends there in nature.
    """
    _, count = np.unique(sections.above, return_counts=True)
    return int((count - 1).sum())


def _tip(last_m: Floats, before_m: Floats, far_m: Floats) -> Floats:
    """The tip of a twig: the farthest vertex, which lies on the bark, projected onto the axis."""
    along = last_m - before_m
    along = along / max(float(np.linalg.norm(along)), 1e-300)
    return last_m + along * max(float((far_m - last_m) @ along), 0.0)


def _farthest(sections: Sections, cells: Ints, distance_m: Floats) -> dict[int, int]:
    """The vertex of greatest distance in each slab component."""
    corners = cells[sections.pair_cell]
    best = corners[np.arange(len(corners)), np.argmax(distance_m[corners], axis=1)]
    order = np.argsort(distance_m[best])
    return dict(zip(sections.pair_piece[order].tolist(), best[order].tolist(), strict=True))


def reach(points_m: Floats, parent: Ints) -> Floats:
    """Length (p,) of the longest path outwards from each point."""
    result = np.zeros(len(parent))
    for i in range(len(parent) - 1, 0, -1):
        p = parent[i]
        result[p] = max(result[p], result[i] + float(np.linalg.norm(points_m[i] - points_m[p])))
    return result


def branches(points_m: Floats, parent: Ints) -> Ints:
    """Branch (p,) of each point: a branch continues with the child of longest reach; 0 is the trunk."""
    far = reach(points_m, parent)
    length = np.zeros(len(parent))
    length[1:] = far[1:] + np.linalg.norm(points_m[1:] - points_m[parent[1:]], axis=1)
    successor = np.full(len(parent), -1)
    for i in range(1, len(parent)):
        p = parent[i]
        if successor[p] < 0 or length[i] > length[successor[p]]:
            successor[p] = i
    branch = np.zeros(len(parent), dtype=np.int32)
    count = 1
    for i in range(1, len(parent)):
        if successor[parent[i]] == i:
            branch[i] = branch[parent[i]]
        else:
            branch[i] = count
            count += 1
    return branch


def without_spurs(tree: Tree, radius_m: Floats) -> tuple[Tree, Ints]:
    """The tree without spurs, and for each old point the new point that replaces it."""
    tree, moved = _parents_first(tree)
    radius_m = radius_m[np.argsort(moved)]
    replacement = np.arange(len(tree.parent))
    while True:
        branch = branches(tree.points_m, tree.parent)
        drop = _spurs(tree, branch, radius_m)
        if not drop.any():
            return tree, replacement[moved].astype(np.int32)
        survivor = np.arange(len(drop))
        for i in range(len(drop)):
            if drop[i]:
                survivor[i] = survivor[tree.parent[i]]
        new = np.cumsum(~drop) - 1
        replacement = new[survivor[replacement]]
        keep = ~drop
        parent = np.where(tree.parent[keep] < 0, -1, new[tree.parent[keep]]).astype(np.int32)
        tree = replace(
            tree,
            points_m=tree.points_m[keep],
            parent=parent,
            area_m2=tree.area_m2[keep],
            piece=tree.piece[keep],
        )
        radius_m = radius_m[keep]


def _spurs(tree: Tree, branch: Ints, radius_m: Floats) -> np.ndarray:
    """Points of terminal branches that barely protrude from tsuccessor parent."""
    drop = np.zeros(len(branch), dtype=bool)
    far = reach(tree.points_m, tree.parent)
    parents = np.unique(branch[tree.parent[1:]][branch[1:] != branch[tree.parent[1:]]])
    for number in range(1, int(branch.max()) + 1):
        own = np.flatnonzero(branch == number)
        if number not in parents and _within(tree, radius_m, own, float(far[own[0]])):
            drop[own] = True
    return drop


def _within(tree: Tree, radius_m: Floats, own: Ints, length: float) -> bool:
    """Whether a branch ends within the thickness of a point that it grows from."""
    margin = SPUR_RADII * float(np.median(radius_m[own]))
    child, point = int(own[0]), int(tree.parent[own[0]])
    while point >= 0:
        length += float(np.linalg.norm(tree.points_m[child] - tree.points_m[point]))
        if length < BUMP_RADII * radius_m[point] + margin:
            return True
        if length > LONGEST_SPUR * radius_m.max():
            return False
        child, point = point, int(tree.parent[point])
    return False


def _parents_first(tree: Tree) -> tuple[Tree, Ints]:
    """The same tree with every parent before its children, and the new index of each old point."""
    depth = np.zeros(len(tree.parent), dtype=np.int64)
    for i in range(len(tree.parent)):
        trail = []
        j = i
        while j > 0 and depth[j] == 0:
            trail.append(j)
            j = int(tree.parent[j])
        for step, k in enumerate(reversed(trail), start=1):
            depth[k] = depth[j] + step
    order = np.argsort(depth, kind="stable")
    new = np.argsort(order)
    parent = np.where(tree.parent[order] < 0, -1, new[tree.parent[order]]).astype(np.int32)
    sorted_tree = Tree(tree.points_m[order], parent, tree.area_m2[order], tree.piece[order])
    return sorted_tree, new.astype(np.int32)
