"""Exports a tree's motion as an animated GLB, for programs that cannot read tables.

The table's modes become morph targets and the motion their weights: a morph displaces a vertex by
Σ basis_k q_k, and turns with its branch to first order; the viewer turns it completely. The file has the
precision of the table and a few megabytes, whatever the length of the motion.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.player import WindDrivenTrees
from galewood.table import Table, vertex_rows
from galewood.util import Floats
from galewood.wind import Wind, WindField

Json = dict[str, Any]

FLOAT = 5126
SETTLE_S = 8.0
"""Duration that is played from rest before the exported motion starts."""
LEAST_M = 2e-4
"""Modes that displace no vertex farther than this in the whole motion are left out."""
LOOP_S = 2.0
"""Duration over which the end of a loop blends into the motion before its start."""


class ExportError(ValueError):
    """The mesh is not a valid GLB, or not the mesh of the table."""


def blown(table: Table, wind: Wind, seconds: float, *, loop: bool = False) -> Floats:
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


def sampled(table: Table, name: str) -> Floats:
    """(T, r) coordinates q of a recorded run of the table (FEM). Raises KeyError for an unknown name."""
    records = table.records
    names = records.metadata.get("winds", [])[: len(records.trajectory) - 1]
    if name not in names:
        raise KeyError(f"no run {name!r} in this table; it has {', '.join(names)}")
    first, last = records.trajectory[names.index(name) : names.index(name) + 2]
    return table.recorded_q_m[int(first) : int(last)]


def animated_glb(table: Table, glb: bytes, q: Floats) -> bytes:
    """Return the render mesh ``glb`` animated by q (T, r), one frame per table step. Raises ExportError."""
    document, binary = _read(glb)
    counts = [int(primitive["vertices"]) for primitive in table.metadata["primitives"]]
    if [_vertices(document, mesh) for mesh in document["meshes"]] != counts:
        raise ExportError("the mesh has other vertices than the mesh of the table: use the GLB of its build")
    file = _File(document, binary)
    reach = np.abs(q).max(axis=0)
    farthest_m = np.linalg.norm(table.node_basis, axis=1).max(axis=0) * reach
    kept = np.flatnonzero(farthest_m > LEAST_M)
    kept = kept if len(kept) else np.array([0])
    scale = np.where(reach > 0, reach, 1.0)
    rest_m = np.concatenate([file.positions(mesh) for mesh in document["meshes"]])
    shapes = vertex_rows(table, rest_m)[:, :, kept] * scale[kept].astype(np.float32)
    for mesh, rows in zip(document["meshes"], np.split(shapes, np.cumsum(counts)[:-1]), strict=True):
        file.add_targets(mesh, rows)
    file.animate(q[:, kept] / scale[kept], float(table.metadata["dt_s"]))
    return file.glb()


def _vertices(document: Json, mesh: Json) -> int:
    return int(document["accessors"][mesh["primitives"][0]["attributes"]["POSITION"]]["count"])


class _File:
    """A GLB under construction."""

    def __init__(self, document: Json, binary: bytes) -> None:
        self._document, self._binary = document, bytearray(binary)

    def add_targets(self, mesh: Json, shapes: npt.NDArray[np.float32]) -> None:
        """Add morph targets of displacements (v, 3, k), all at weight zero."""
        count = shapes.shape[2]
        targets = [{"POSITION": self._floats(shapes[:, :, k], "VEC3")} for k in range(count)]
        mesh["primitives"][0]["targets"] = targets
        mesh["weights"] = [0.0] * count
        mesh["extras"] = {"targetNames": [f"mode {k}" for k in range(count)]}

    def positions(self, mesh: Json) -> npt.NDArray[np.float32]:
        """(v, 3) vertices of a mesh."""
        accessor = self._document["accessors"][mesh["primitives"][0]["attributes"]["POSITION"]]
        view = self._document["bufferViews"][accessor["bufferView"]]
        start = int(view.get("byteOffset", 0)) + int(accessor.get("byteOffset", 0))
        values = np.frombuffer(bytes(self._binary), "<f4", 3 * int(accessor["count"]), start)
        return values.reshape(-1, 3)

    def animate(self, weights: Floats, dt_s: float) -> None:
        """Animate the weights (T, k) of all meshes with frames dt_s apart."""
        time = self._floats(np.arange(len(weights), dtype=np.float32)[:, None] * np.float32(dt_s), "SCALAR")
        sampler = {"input": time, "output": self._floats(weights.reshape(-1, 1), "SCALAR")}
        channels = [
            {"sampler": 0, "target": {"node": index, "path": "weights"}}
            for index, node in enumerate(self._document["nodes"])
            if "mesh" in node
        ]
        sway = {"name": "sway", "samplers": [sampler | {"interpolation": "LINEAR"}], "channels": channels}
        self._document["animations"] = [sway]

    def _floats(self, rows: npt.NDArray[Any], kind: str) -> int:
        values = np.ascontiguousarray(rows, "<f4")
        self._binary += b"\0" * (-len(self._binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": values.nbytes}
        self._binary += values.tobytes()
        self._document["bufferViews"].append(view)
        accessor = {
            "bufferView": len(self._document["bufferViews"]) - 1,
            "componentType": FLOAT,
            "count": len(values),
            "type": kind,
            "min": values.min(axis=0).tolist(),
            "max": values.max(axis=0).tolist(),
        }
        self._document["accessors"].append(accessor)
        return len(self._document["accessors"]) - 1

    def glb(self) -> bytes:
        self._document["buffers"][0]["byteLength"] = len(self._binary)
        text = json.dumps(self._document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        body = bytes(self._binary) + b"\0" * (-len(self._binary) % 4)
        parts = [(b"JSON", text), (b"BIN\0", body)]
        chunks = b"".join(struct.pack("<I4s", len(content), name) + content for name, content in parts)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _read(glb: bytes) -> tuple[Json, bytes]:
    """Split a GLB into its JSON and its binary chunk. Raises ExportError."""
    if len(glb) < 20 or glb[:4] != b"glTF":
        raise ExportError("the mesh is not a GLB file")
    size = int.from_bytes(glb[12:16], "little")
    try:
        document = json.loads(glb[20 : 20 + size])
    except ValueError as error:
        raise ExportError("the mesh file is damaged: its JSON cannot be read") from error
    binary = glb[20 + size + 8 :]
    return document, binary[: int(document["buffers"][0]["byteLength"])]
