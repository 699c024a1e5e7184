"""Pictures of a build: the tetrahedra, and the skeleton with the sampled elements."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, to_rgba
from numpy.typing import NDArray

from galewood.pipeline.pictures.canvas import (
    INK_COLOUR,
    PAGE_COLOUR,
    SOFT_INK,
    Camera,
    add_faces,
    bare_axes,
    empty_page,
    frame_points,
    lit,
    png,
    write_title,
)
from galewood.solid.skeleton import Skeleton
from galewood.solid.tets import FACES_OF_TET, TetMesh, boundary_faces
from galewood.util import Floats, Ints

BARK_RGB, SAPWOOD_RGB = np.array([0.80, 0.57, 0.37]), np.array([0.98, 0.80, 0.52])
SAMPLE_COLOUR = "#ffd36b"
ORDER_COLOURS = LinearSegmentedColormap.from_list(
    "orders", ["#f2ad3f", "#e0664f", "#b0568f", "#6f6fc4", "#58a6d6"]
)
ADDED_COLOUR = to_rgba("#6fd08c")
MOST_ORDERS = 5
CLOSE_UP_SHARE = 0.06
"""Half the width of the close-up's view over the height of the wood."""
CLOSE_UP_ASPECT_RATIO = 1.35
"""Aspect ratio of the close-up: height over width."""
CUT_SHARE = 0.04
"""Distance of the cut in front of the middle of the wood, over half the width of the close-up."""
TET_SCALE = 0.84
"""Scale of the tetrahedra in the close-up, so that gaps separate them."""


def tetrahedra_png(mesh: TetMesh) -> bytes:
    """PNG of the wood's surface, with a close-up of the tetrahedra inside the first fork."""
    figure, camera = empty_page(), Camera()
    whole = bare_axes(figure, (0.02, 0.02, 0.70, 0.87))
    _draw_wood(whole, mesh, camera)
    near = bare_axes(figure, (0.665, 0.04, 0.31, 0.42))
    centre = first_fork(mesh)
    half_m = CLOSE_UP_SHARE * float(np.ptp(mesh.vertices_m[:, 1]))
    _draw_inside(near, mesh, camera, centre, half_m)
    _mark(whole, near, camera.view(centre[None])[0], half_m)
    height_m = float(np.ptp(mesh.vertices_m[:, 1]))
    facts = f"{len(mesh.tets):,} tetrahedra, {len(mesh.vertices_m):,} vertices, {height_m:.1f} m of wood"
    write_title(figure, "The wood as finite elements", facts)
    return png(figure)


def _draw_wood(plot: Axes, mesh: TetMesh, camera: Camera) -> None:
    view = camera.view(mesh.vertices_m)
    faces = view[boundary_faces(mesh.tets)]
    add_faces(plot, faces, lit(faces, BARK_RGB), edge=0.72, width=0.35)
    frame_points(plot, view[:, :2])


def first_fork(mesh: TetMesh) -> Floats:
    """(3,) m: middle of the wood where it first spreads to three times its width at the base."""
    centre = mesh.vertices_m[mesh.tets].mean(axis=1)
    low, high = centre[:, 1].min(), centre[:, 1].max()
    slab = np.minimum((40 * (centre[:, 1] - low) / (high - low)).astype(int), 39)
    foot = np.ptp(centre[slab <= 1][:, [0, 2]], axis=0).max()
    for k in range(2, 30):
        inside = centre[slab == k]
        if len(inside) and np.ptp(inside[:, [0, 2]], axis=0).max() > 3.0 * foot:
            return np.median(centre[np.abs(slab - k) <= 1], axis=0)
    return np.median(centre[slab == 10], axis=0) if (slab == 10).any() else centre[0]


def _draw_inside(plot: Axes, mesh: TetMesh, camera: Camera, at_m: Floats, half_m: float) -> None:
    """Draw the tetrahedra behind a cut through a point, each shrunk towards its centre."""
    view, middle = camera.view(mesh.vertices_m), camera.view(at_m[None])[0]
    corners = view[mesh.tets]
    centre = corners.mean(axis=1)
    near = np.abs(centre[:, :2] - middle[:2]) < half_m * np.array([1.3, CLOSE_UP_ASPECT_RATIO + 0.4])
    shown = near.all(axis=1) & (centre[:, 2] < middle[2] + CUT_SHARE * half_m)
    corners, centre = corners[shown], centre[shown]
    small = centre[:, None] + TET_SCALE * (corners - centre[:, None])
    faces = small[:, FACES_OF_TET].reshape(-1, 3, 3)
    depth = np.clip(np.repeat((middle[2] - centre[:, 2]) / half_m, 4), 0.0, 1.0)[:, None]
    add_faces(plot, faces, lit(faces, SAPWOOD_RGB + depth * (BARK_RGB - SAPWOOD_RGB)), edge=0.45, width=0.5)
    plot.set_xlim(middle[0] - half_m, middle[0] + half_m)
    plot.set_ylim(middle[1] - CLOSE_UP_ASPECT_RATIO * half_m, middle[1] + CLOSE_UP_ASPECT_RATIO * half_m)


def _mark(whole: Axes, near: Axes, middle: Floats, half_m: float) -> None:
    """Frame the close-up and mark its place in the whole picture."""
    x, y = (
        half_m * np.array([-1, 1, 1, -1, -1]),
        CLOSE_UP_ASPECT_RATIO * half_m * np.array([-1, -1, 1, 1, -1]),
    )
    whole.plot(middle[0] + x, middle[1] + y, color=SOFT_INK, linewidth=0.8)
    x, y = [0, 1, 1, 0, 0], [0, 0, 1, 1, 0]
    near.plot(x, y, transform=near.transAxes, color=SOFT_INK, linewidth=1.2, clip_on=False)


def skeleton_png(
    mesh: TetMesh, skeleton: Skeleton, sampled: Ints, added: NDArray[np.bool_] | None = None
) -> bytes:
    """PNG of the skeleton inside the wood from two sides, coloured by branching order, with the sampled
    elements; ``added`` (p,): which points are in wood that is not drawn.
    """
    figure = empty_page()
    for box, turn_deg in (((0.01, 0.02, 0.49, 0.87), 35.0), ((0.50, 0.02, 0.49, 0.87), 125.0)):
        camera, plot = Camera(turn_deg, 0.0), bare_axes(figure, box)
        _draw_ghost(plot, mesh, camera)
        plot.add_collection(_lines(skeleton, camera, added))
        _draw_samples(plot, camera.view(mesh.vertices_m[mesh.tets[sampled]].mean(axis=1)))
        frame_points(plot, camera.view(mesh.vertices_m)[:, :2])
    branches = int(skeleton.branch.max()) + 1
    facts = f"{branches} branches, coloured by order; {len(sampled)} sampled elements, from two sides"
    facts += "; green: added wood, which is not drawn" if added is not None and added.any() else ""
    write_title(figure, "The skeleton", facts)
    return png(figure)


def _draw_ghost(plot: Axes, mesh: TetMesh, camera: Camera) -> None:
    view = camera.view(mesh.vertices_m)
    faces = view[boundary_faces(mesh.tets)]
    colour = np.full((len(faces), 3), 0.185) * np.array([0.85, 1.0, 1.12])
    add_faces(plot, faces, colour, edge=1.0, width=0.6)


def branch_order(skeleton: Skeleton) -> Ints:
    """(branches,) number of forks between each branch and the trunk (0 for the trunk)."""
    _, first = np.unique(skeleton.branch, return_index=True)
    parent_branch = skeleton.branch[np.maximum(skeleton.parent[first], 0)]
    order = np.zeros(len(first), np.int64)
    for _ in range(len(first)):
        deeper = np.where(parent_branch == np.arange(len(first)), 0, order[parent_branch] + 1)
        if np.array_equal(deeper, order):
            break
        order = deeper
    return order


def _lines(skeleton: Skeleton, camera: Camera, added: NDArray[np.bool_] | None) -> LineCollection:
    flat = camera.view(skeleton.points_m)[:, :2]
    child = np.flatnonzero(skeleton.parent >= 0)
    order = np.minimum(branch_order(skeleton), MOST_ORDERS)[skeleton.branch[child]]
    twigs_first = np.argsort(-order, kind="stable")
    child, order = child[twigs_first], order[twigs_first]
    widths = 0.9 + 6.0 * skeleton.radius_m[child] / float(skeleton.radius_m.max())
    segments = list(np.stack([flat[skeleton.parent[child]], flat[child]], axis=1))
    colours = ORDER_COLOURS(order / max(int(order.max()), 1))
    if added is not None:
        colours[added[child]] = ADDED_COLOUR
    return LineCollection(segments, colors=colours, linewidths=widths, capstyle="round", zorder=2)


def _draw_samples(plot: Axes, centres: Floats) -> None:
    plot.scatter(centres[:, 0], centres[:, 1], s=150, color=SAMPLE_COLOUR, alpha=0.16, linewidths=0, zorder=3)
    plot.scatter(
        centres[:, 0], centres[:, 1], s=26, color=INK_COLOUR, edgecolors=PAGE_COLOUR, linewidths=1.0, zorder=4
    )
