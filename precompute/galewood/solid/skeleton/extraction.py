"""Skeleton extraction: a rooted tree of branches with radii, and the assignment of every tetrahedron to it.

Geodesic level sets define the topology; L1-medial centring defines the centre lines.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from galewood.solid.skeleton.centre import fitted_lines, l1_centred
from galewood.solid.skeleton.levels import Sections, cut_sections, geodesic_distance, inner_faces
from galewood.solid.skeleton.roots import root_vertices
from galewood.solid.skeleton.tree import Tree, branches, linked_tree, meetings, section_radii, without_spurs
from galewood.solid.tets import TetMesh
from galewood.util import Floats, Int32s, Ints

STEPS_PER_HEIGHT = 100
SAMPLES_OF_TET = np.array(
    [[0.7, 0.1, 0.1, 0.1], [0.1, 0.7, 0.1, 0.1], [0.1, 0.1, 0.7, 0.1], [0.1, 0.1, 0.1, 0.7]]
)


@dataclass(frozen=True)
class Skeleton:
    """Skeleton points and the per-tet quantities derived from them.

    points_m (p, 3), parent (p,) with −1 at the root, radius_m (p,), branch (p,) with 0 for the trunk;
    tet_fibre (m, 3) unit vectors away from the root, tet_branch (m,), tet_point (m,) the skeleton point a tet
    belongs to.
    """

    points_m: Floats
    parent: Int32s
    radius_m: Floats
    branch: Int32s
    tet_fibre: Floats
    tet_branch: Int32s
    tet_point: Int32s
    report: dict[str, Any]

    @property
    def tet_radius_m(self) -> Floats:
        """(m,) radius of the limb at each tet, as meshed, m."""
        return self.radius_m[self.tet_point]


def extract_skeleton(mesh: TetMesh) -> Skeleton:
    """Extract the skeleton of a connected tetrahedral mesh; the y axis points up."""
    vertices, tets = mesh.vertices_m, mesh.tets
    step_m = float(np.ptp(vertices[:, 1])) / STEPS_PER_HEIGHT
    roots = root_vertices(vertices, tets)
    faces = inner_faces(tets)
    distance = geodesic_distance(vertices, tets, roots, faces)
    sections = cut_sections(vertices, tets, distance, faces, step_m)
    base = vertices[roots].mean(axis=0)
    tree = linked_tree(sections, vertices, tets, distance, base)
    tree, replacement = without_spurs(tree, section_radii(tree, tree.points_m))
    branch = branches(tree.points_m, tree.parent)
    radius = section_radii(tree, tree.points_m)
    owner = owners(vertices[tets].mean(axis=1), sections, tree, replacement, radius)
    samples = np.einsum("sk,mkd->msd", SAMPLES_OF_TET, vertices[tets]).reshape(-1, 3)
    centred = l1_centred(
        tree.points_m, branch, tree.parent, radius, samples, np.repeat(branch[owner], 4), step_m
    )
    points, tangent = fitted_lines(centred, branch, tree.parent, radius, step_m)
    return Skeleton(
        points_m=points,
        parent=tree.parent.astype(np.int32),
        radius_m=radius,
        branch=branch.astype(np.int32),
        tet_fibre=_fibres(mesh, points, tangent, tree.parent, branch, owner),
        tet_branch=branch[owner].astype(np.int32),
        tet_point=owner.astype(np.int32),
        report={
            "points": len(points),
            "branches": int(branch.max()) + 1,
            "length_m": float(np.linalg.norm(points[1:] - points[tree.parent[1:]], axis=1).sum()),
            "step_m": step_m,
            "trunk_radius_m": float(np.percentile(radius[branch == 0], 90)),
            "root_vertices": len(roots),
            "meetings": meetings(sections),
        },
    )


def owners(centre: Floats, sections: Sections, tree: Tree, replacement: Ints, radius_m: Floats) -> Int32s:
    """The skeleton point (m,) that each cell with this centre (m, 3) belongs to: the nearest link of its slab
    component, in units of its radius.
    """
    links: dict[int, list[int]] = {}
    for point, piece in enumerate(tree.piece.tolist()):
        links.setdefault(piece, []).append(point)
    for index, piece in enumerate(
        sections.above.tolist()
    ):  # if all links of a component were spurs, use the section below
        links.setdefault(piece, [int(replacement[index + 1])])
    best = np.full(len(centre), np.inf)
    owner = np.zeros(len(centre), dtype=np.int32)
    order = np.argsort(sections.pair_piece, kind="stable")
    bounds = np.flatnonzero(np.diff(sections.pair_piece[order])) + 1
    for chosen in np.split(order, bounds):
        tets = np.unique(sections.pair_cell[chosen])
        for point in links.get(int(sections.pair_piece[chosen[0]]), [0]):
            start = tree.points_m[max(int(tree.parent[point]), 0)]
            gap = segment_distance(centre[tets], start, tree.points_m[point]) / max(radius_m[point], 1e-9)
            nearer = gap < best[tets]
            best[tets[nearer]] = gap[nearer]
            owner[tets[nearer]] = point
    return owner


def segment_distance(points: Floats, start: Floats, end: Floats) -> Floats:
    """Distance (k,) of points (k, 3) from a segment."""
    along = end - start
    share = np.clip((points - start) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
    return np.linalg.norm(points - start - share[:, None] * along, axis=1)


def _fibres(
    mesh: TetMesh, points_m: Floats, tangent: Floats, parent: Ints, branch: Ints, owner: Ints
) -> Floats:
    """Tangent at each tet's centre, interpolated between its point and the parent if on the same branch."""
    centre = mesh.vertices_m[mesh.tets].mean(axis=1)
    below = np.maximum(parent[owner], 0)
    along = points_m[owner] - points_m[below]
    share = np.einsum("ij,ij->i", centre - points_m[below], along) / np.maximum(
        (along**2).sum(axis=1), 1e-300
    )
    share = np.where(branch[below] == branch[owner], np.clip(share, 0.0, 1.0), 1.0)[:, None]
    fibre = share * tangent[owner] + (1.0 - share) * tangent[below]
    length = np.linalg.norm(fibre, axis=1, keepdims=True)
    return np.where(length > 1e-9, fibre / np.maximum(length, 1e-300), tangent[owner])


def sampled_elements(mesh: TetMesh, skeleton: Skeleton, count: int) -> Int32s:
    """`count` unclamped tets distributed along the skeleton; a smaller count gives a prefix of a larger one.

    Farthest-point order over the tets nearest to the skeleton points, then over all others. Raises ValueError
    if `count` is out of range.
    """
    if not 1 <= count <= len(mesh.tets):
        raise ValueError(f"cannot sample {count} of {len(mesh.tets)} tetrahedra")
    centre = mesh.vertices_m[mesh.tets].mean(axis=1)
    gap = np.linalg.norm(centre - skeleton.points_m[skeleton.tet_point], axis=1)
    by_gap = np.lexsort((gap, skeleton.tet_point))
    _, first = np.unique(skeleton.tet_point[by_gap], return_index=True)
    on_axis = by_gap[first]
    clamped = np.zeros(len(mesh.vertices_m), dtype=bool)
    clamped[root_vertices(mesh.vertices_m, mesh.tets)] = True
    free = np.logical_not(clamped[mesh.tets].any(axis=1))
    on_axis = on_axis[free[on_axis]]
    taken = _farthest_first(centre, on_axis, np.zeros(0, dtype=np.int64), min(count, len(on_axis)))
    for rest in (np.flatnonzero(free), np.arange(len(mesh.tets))):
        if len(taken) < count:
            others = np.setdiff1d(rest, taken)
            taken = np.concatenate(
                [taken, _farthest_first(centre, others, taken, min(count - len(taken), len(others)))]
            )
    return taken.astype(np.int32)


def _farthest_first(centre: Floats, candidates: Ints, taken: Ints, count: int) -> Ints:
    """Order candidates by farthest-point sampling, beginning with the highest one if none are taken."""
    gap = np.full(len(candidates), np.inf)
    for tet in taken:
        gap = np.minimum(gap, np.linalg.norm(centre[candidates] - centre[tet], axis=1))
    chosen: list[int] = []
    for _ in range(count):
        at = int(np.argmax(gap if len(chosen) or len(taken) else centre[candidates][:, 1]))
        chosen.append(int(candidates[at]))
        gap = np.minimum(gap, np.linalg.norm(centre[candidates] - centre[candidates[at]], axis=1))
        gap[at] = -1.0
    return np.array(chosen, dtype=np.int64)
