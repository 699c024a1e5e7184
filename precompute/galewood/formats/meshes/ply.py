"""PLY files, ASCII and binary, with the colours of vertices or faces. trimesh reads the elements."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from galewood.formats.colours import linear_from_srgb, painted
from galewood.formats.companions import Source
from galewood.formats.foreign import point_cloud
from galewood.formats.limits import check_faces
from galewood.formats.meshes.stl import loaded
from galewood.formats.types import RawPart
from galewood.util import Floats, MeshError

SIZES = {
    "char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2, "uint16": 2,
    "int": 4, "uint": 4, "int32": 4, "uint32": 4, "float": 4, "float32": 4, "double": 8, "float64": 8,
}  # fmt: skip
MAX_HEADER_BYTES = 65_536


def read_ply(data: bytes, source: Source) -> list[RawPart]:
    """The part of a PLY file; the declared counts are checked against the length first. Raises MeshError."""
    end = data.find(b"end_header")
    if end < 0 or end > MAX_HEADER_BYTES:
        raise MeshError("truncated", "malformed", "The PLY header is incomplete.", "Export the file again.")
    counts = _checked_counts(data[:end].decode("latin-1"), len(data) - end)
    if not counts.get("face") and not counts.get("tristrips") and counts.get("vertex"):
        raise point_cloud("The PLY holds points without faces.")
    check_faces(counts.get("face", 0))
    mesh = loaded(data, "ply")
    try:
        return [_part(mesh, source)]
    except (AttributeError, ValueError, TypeError, IndexError) as error:
        raise MeshError(
            "unreadable", "malformed", "The PLY file cannot be read.", "Export it again."
        ) from error


def _part(mesh: Any, source: Source) -> RawPart:
    positions = np.array(mesh.vertices, dtype=np.float64).reshape(-1, 3)
    faces = np.array(mesh.faces, dtype=np.int64).reshape(-1, 3).astype(np.int32)
    visual = mesh.visual
    colours: Floats | None = None
    uv: Any = None
    if visual.kind == "vertex":
        colours = _linear(visual.vertex_colors)
    elif visual.kind == "face":  # every face gets corners of its own, which can have its colour
        colours = np.repeat(_linear(visual.face_colors), 3, axis=0)
        positions, faces = (
            positions[faces].reshape(-1, 3),
            np.arange(faces.size, dtype=np.int32).reshape(-1, 3),
        )
    elif visual.kind == "texture":
        uv = np.asarray(visual.uv, dtype=np.float64)
        uv = np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])
        source.warn("The texture of the PLY file is not drawn: it is in another file.")
    material = None if colours is None else painted()
    return RawPart((), positions, faces, uv=uv, colours=colours, material=material)


def _linear(colours: Any) -> Floats:
    return linear_from_srgb(np.asarray(colours, dtype=np.float64).reshape(-1, 4)[:, :3] / 255.0)


def _checked_counts(header: str, body_bytes: int) -> dict[str, int]:
    is_text = "format ascii" in header
    need, row = 0, 0
    count = 0
    counts: dict[str, int] = {}
    for line in [*header.splitlines(), "element end 0"]:
        words = line.split()
        if words[:1] == ["element"]:
            need += count * row
            count, row = _count(words), 0
            counts[words[1]] = count
        elif words[:1] == ["property"] and len(words) > 1:
            row += 2 if is_text else (1 if words[1] == "list" else SIZES.get(words[1], 1))
    if need > body_bytes + 16:
        raise MeshError(
            "wrong-count",
            "malformed",
            f"The PLY declares at least {need} bytes of elements but has only {body_bytes}.",
            "The file is truncated or damaged; export it again.",
        )  # fmt: skip
    return counts


def _count(words: list[str]) -> int:
    if len(words) != 3 or not re.fullmatch(r"[0-9]{1,18}", words[2]):
        raise MeshError(
            "ply-syntax",
            "malformed",
            "An element line of the PLY header is invalid.",
            "Export the file again.",
        )
    return int(words[2])
