"""STL files, binary and text. The declared count is checked against the length before allocation."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from galewood.formats.companions import Source
from galewood.formats.types import RawPart
from galewood.util import MeshError

HEADER_BYTES = 84
FACE_BYTES = 50


def read_stl(data: bytes, source: Source) -> list[RawPart]:
    """The part of a binary or ASCII STL. Raises MeshError."""
    is_text = data.lstrip()[:5] == b"solid" and b"facet" in data[:4096]
    if not is_text and not is_binary_stl(data):
        declared = _declared(data) if len(data) >= HEADER_BYTES else 0
        raise MeshError(
            "wrong-count", "malformed", f"The STL declares {declared} triangles but has {len(data)} bytes.",
            "The file is truncated or damaged; export it again.",
        )  # fmt: skip
    mesh = loaded(data, "stl_ascii" if is_text else "stl")
    positions = np.array(mesh.vertices, dtype=np.float64).reshape(-1, 3)
    return [RawPart((), positions, np.array(mesh.faces, dtype=np.int32).reshape(-1, 3))]


def is_binary_stl(data: bytes) -> bool:
    """Whether the length of the file is that of a binary STL with the declared number of triangles."""
    return len(data) >= HEADER_BYTES and len(data) == HEADER_BYTES + FACE_BYTES * _declared(data)


def _declared(data: bytes) -> int:
    return int.from_bytes(data[80:84], "little")


def loaded(data: bytes, file_type: str) -> Any:
    """What trimesh makes of a file without merging vertices; MeshError if it fails."""
    import trimesh  # slow to load, and most uploads are GLB files

    try:
        return trimesh.load(io.BytesIO(data), file_type=file_type, process=False)
    except MemoryError:
        raise
    except Exception as error:
        raise MeshError(
            "unreadable",
            "malformed",
            f"The {file_type[:3].upper()} file cannot be read.",
            "The file is truncated or damaged; export it again.",
        ) from error
