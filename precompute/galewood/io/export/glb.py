"""Exports a tree's motion as an animated GLB, for programs that cannot read tables.

The table's modes become morph targets and the motion their weights: a morph displaces a vertex by
Σ basis_k q_k, and turns with its branch to first order; the viewer turns it completely. So the file is as
precise as the table for small motion only (``linear_error_percent``); its size hardly depends on the length.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from galewood.io.export.gltf_file import ARRAY_BUFFER, GltfFile
from galewood.motion.wind import Wind, WindField
from galewood.player import WindDrivenTrees
from galewood.solid.skinning import drawn_positions, vertex_rows
from galewood.table import Table
from galewood.util import Floats

if TYPE_CHECKING:
    import pygltflib

SETTLE_S = 8.0
"""Duration that is played from rest before the exported motion starts."""
LEAST_M = 2e-4
"""Modes that displace no vertex farther than this in the whole motion are left out."""
LOOP_S = 2.0
"""Duration over which the end of a loop blends into the motion before its start."""


def coordinates_in_wind(table: Table, wind: Wind, seconds: float, *, loop: bool = False) -> Floats:
    """(T + 1, r) coordinates q of one tree in a wind by the modal model, one frame per table step.

    In a ``loop`` the last frame equals the first.
    """
    dt_s, field = float(table.metadata["dt_s"]), WindField(wind)
    tree = WindDrivenTrees(table, [[0.0, 0.0, 0.0, 1.0]])
    before, frames = round(SETTLE_S / dt_s), round(seconds / dt_s) + 1
    track = np.empty((before + frames, tree.q.shape[1]))
    for k in range(len(track)):
        # a little more than the table's step, so that rounding never skips one
        tree.step(field, dt_s * (k + 1), dt_s * (1 + 1e-12))
        track[k] = tree.q[0]
    if not loop:
        return track[before:]
    blend = max(1, min(round(LOOP_S / dt_s), frames - 1, before))
    share = (np.arange(1, blend + 1) / blend)[:, None]
    track[-blend:] += share * (track[before - blend + 1 : before + 1] - track[-blend:])
    return track[before:]


def recorded_coordinates(table: Table, name: str) -> Floats:
    """(T, r) coordinates q of a recorded run of the table (FEM). Raises KeyError for an unknown name."""
    records = table.records
    names = records.metadata.get("winds", [])[: len(records.trajectory) - 1]
    if name not in names:
        raise KeyError(f"no run {name!r} in this table; it has {', '.join(names)}")
    first, last = records.trajectory[names.index(name) : names.index(name) + 2]
    return table.recorded_q_m[int(first) : int(last)]


def animated_glb(table: Table, glb: bytes, q: Floats) -> bytes:
    """Return the render mesh ``glb`` animated by q (T, r), one frame per table step. Raises ExportError."""
    file = GltfFile(glb, table)
    reach = np.abs(q).max(axis=0)
    farthest_m = np.linalg.norm(table.node_basis, axis=1).max(axis=0) * reach
    kept = np.flatnonzero(farthest_m > LEAST_M)
    kept = kept if len(kept) else np.array([0])
    scale = np.where(reach > 0, reach, 1.0)
    shapes = vertex_rows(table, file.rest_m())[:, :, kept] * scale[kept].astype(np.float32)
    splits = np.cumsum(file.counts)[:-1]
    for mesh, rows in zip(file.gltf.meshes, np.split(shapes, splits), strict=True):
        _add_targets(file, mesh, rows)
    _animate(file, q[:, kept] / scale[kept], float(table.metadata["dt_s"]))
    return file.glb()


def linear_error_percent(table: Table, rest_m: Floats, q: Floats) -> float:
    """Largest distance of a morphed vertex from where the table draws it, in % of the height.

    ``q`` (T, r): the poses; morph targets displace vertices along lines, the table turns them about their
    branches.
    """
    rows = vertex_rows(table, rest_m)
    apart = (rest_m + rows @ pose - drawn_positions(table, rest_m, pose) for pose in q)
    farthest_m = max(float(np.linalg.norm(each, axis=1).max()) for each in apart)
    return 100 * farthest_m / float(table.metadata["height_m"])


def _add_targets(file: GltfFile, mesh: pygltflib.Mesh, shapes: npt.NDArray[np.float32]) -> None:
    """Add morph targets of displacements (v, 3, k), all at weight zero."""
    import pygltflib

    count = shapes.shape[2]
    mesh.primitives[0].targets = [
        pygltflib.Attributes(POSITION=file.add_rows(shapes[:, :, k], bounds=True, target=ARRAY_BUFFER))
        for k in range(count)
    ]
    mesh.weights = [0.0] * count
    mesh.extras = {"targetNames": [f"mode {k}" for k in range(count)]}


def _animate(file: GltfFile, weights: Floats, dt_s: float) -> None:
    """Animate the weights (T, k) of all meshes with frames dt_s apart."""
    import pygltflib

    time = file.add_rows(np.arange(len(weights), dtype=np.float32) * np.float32(dt_s), bounds=True)
    output = file.add_rows(weights.reshape(-1).astype(np.float32), bounds=True)
    sampler = pygltflib.AnimationSampler(input=time, output=output, interpolation="LINEAR")
    channels = [
        pygltflib.AnimationChannel(
            sampler=0, target=pygltflib.AnimationChannelTarget(node=index, path="weights")
        )
        for index, node in enumerate(file.gltf.nodes)
        if node.mesh is not None
    ]
    file.gltf.animations.append(pygltflib.Animation(name="sway", samplers=[sampler], channels=channels))
