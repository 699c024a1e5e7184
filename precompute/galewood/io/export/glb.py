"""Exports a tree's motion as an animated GLB, for programs that cannot read tables.

The table's modes become morph targets and the motion their weights: a morph displaces a vertex by
Σ basis_k q_k, and turns with its branch to first order; the viewer turns it completely. So the file is as
precise as the table for small motion only (``linear_error_percent``); its size hardly depends on the length.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from galewood.io.export.gltf_file import ARRAY_BUFFER, GltfFile
from galewood.io.export.gltf_names import give_names
from galewood.io.export.looped import Loop, seam
from galewood.solid.skinning import drawn_positions, vertex_rows
from galewood.table import Table
from galewood.util import Floats

if TYPE_CHECKING:
    import pygltflib

MEASURED_POSES = 24
LEAST_M = 2e-4
"""Modes that displace no vertex farther than this in the whole motion are left out."""


def export_glb(table: Table, glb: bytes, loop: Loop, folder: Path, name: str) -> dict[str, Any]:
    """Write the animated GLB and a description; return it. Raises ExportError."""
    file = GltfFile(glb, table)
    give_names(file.gltf, name)
    rest_m = file.rest_m()
    poses = loop.q()[:: max(1, loop.frames // MEASURED_POSES)]
    description: dict[str, Any] = {
        "format": "galewood-glb",
        "version": 1,
        "mesh": f"{name}.glb",
        "animation": f"{name}_sway",
        **loop.about(table),
        "measured": {"error_percent_of_height": linear_error_percent(table, rest_m, poses)}
        | seam(table, rest_m, loop),
    }
    add_morphs(file, table, rest_m, loop, f"{name}_sway")
    file.note("galewood_glb", description)
    (folder / f"{name}.glb").write_bytes(file.glb())
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    return description


def add_morphs(
    file: GltfFile, table: Table, rest_m: Floats, loop: Loop, animation: str, modes: int | None = None
) -> tuple[npt.NDArray[np.int64], Floats]:
    """Add the modes that the motion needs as morph targets, and their weights over time; only the first
    ``modes``.

    Returns the modes of the targets (k,), and the q of each of them at a weight of 1 (k,), m.
    """
    q = loop.keys()[:, :modes]
    reach = np.abs(q).max(axis=0)
    farthest_m = np.linalg.norm(table.node_basis[:, :, :modes], axis=1).max(axis=0) * reach
    kept = np.flatnonzero(farthest_m > LEAST_M)
    kept = kept if len(kept) else np.array([0])
    scale = np.where(reach > 0, reach, 1.0)
    shapes = vertex_rows(table, rest_m)[:, :, kept] * scale[kept].astype(np.float32)
    splits = np.cumsum(file.counts)[:-1]
    for mesh, rows in zip(file.gltf.meshes, np.split(shapes, splits), strict=True):
        _add_targets(file, mesh, rows)
    _animate(file, q[:, kept] / scale[kept], loop.key_times_s(), animation)
    return kept, scale[kept]


def linear_error_percent(table: Table, rest_m: Floats, q: Floats, modes: int | None = None) -> float:
    """Largest distance of a morphed vertex from where the table draws it, in % of the height.

    ``q`` (T, r): the poses; morph targets of the first ``modes`` displace vertices along lines, the table
    turns them about their branches.
    """
    rows = vertex_rows(table, rest_m)[:, :, :modes]
    apart = (rest_m + rows @ pose[:modes] - drawn_positions(table, rest_m, pose) for pose in q)
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


def _animate(file: GltfFile, weights: Floats, times_s: Floats, name: str) -> None:
    """Animate the weights (T, k) of all meshes."""
    import pygltflib

    time = file.add_rows(times_s.astype(np.float32), bounds=True)
    output = file.add_rows(weights.reshape(-1).astype(np.float32), bounds=True)
    sampler = pygltflib.AnimationSampler(input=time, output=output, interpolation="LINEAR")
    channels = [
        pygltflib.AnimationChannel(
            sampler=0, target=pygltflib.AnimationChannelTarget(node=index, path="weights")
        )
        for index, node in enumerate(file.gltf.nodes)
        if node.mesh is not None
    ]
    file.gltf.animations.append(pygltflib.Animation(name=name, samplers=[sampler], channels=channels))
