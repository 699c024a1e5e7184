"""Pictures of what was made of a tree, for a report and for the eye."""

from __future__ import annotations

import io

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from precompute.intake_types import Floats, Ints
from precompute.skeleton import Skeleton
from precompute.tet_quality import boundary_faces
from precompute.tetrahedra import TetMesh

VIEWS = (("from the front", 0), ("from the side", 2))
WOOD, SAMPLE = "#d8cfc4", "#c0392b"


def skeleton_png(mesh: TetMesh, skeleton: Skeleton, sampled: Ints) -> bytes:
    """PNG: the skeleton over the wood from two sides, a colour per branch, width by radius, sampled
    elements in red."""
    figure = Figure(figsize=(9.0, 6.0), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    centres = mesh.vertices_m[mesh.tets[sampled]].mean(axis=1)
    for (title, axis), plot in zip(VIEWS, figure.subplots(1, 2, sharey=True), strict=True):
        plot.add_collection(_wood(mesh, axis))
        plot.add_collection(_lines(skeleton, axis))
        plot.scatter(centres[:, axis], centres[:, 1], s=14, color=SAMPLE, zorder=3)
        plot.set_aspect("equal")
        plot.autoscale_view()
        plot.set_title(title, fontsize=9)
        plot.set_xlabel("m", fontsize=8)
        plot.tick_params(labelsize=8)
    count = int(skeleton.branch.max()) + 1
    figure.suptitle(
        f"{len(mesh.tets)} tetrahedra, {count} branches, {len(sampled)} sampled elements", fontsize=10
    )
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": "Galewood"})
    return stream.getvalue()


def _wood(mesh: TetMesh, axis: int) -> LineCollection:
    """Edges of the wood's surface, pale."""
    faces = boundary_faces(mesh.tets)
    edges = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    return LineCollection(list(_flat(mesh.vertices_m, axis)[edges]), colors=WOOD, linewidths=0.4, zorder=1)


def _lines(skeleton: Skeleton, axis: int) -> LineCollection:
    flat = _flat(skeleton.points_m, axis)
    child = np.flatnonzero(skeleton.parent >= 0)
    segments = np.stack([flat[skeleton.parent[child]], flat[child]], axis=1)
    colours = colormaps["tab20"](skeleton.branch[child] % 20)
    widths = 0.8 + 5.0 * skeleton.radius_m[child] / float(skeleton.radius_m.max())
    return LineCollection(list(segments), colors=colours, linewidths=widths, capstyle="round", zorder=2)


def _flat(points_m: Floats, axis: int) -> Floats:
    return points_m[:, [axis, 1]]
