"""Face count declared in a mesh file's header: oversized meshes are rejected before they are parsed."""

from __future__ import annotations

import json
import re
import struct

from galewood_server.http import ProblemError

LARGEST_HEAD_BYTES = 4 * 1024 * 1024
_PLY_FACES = re.compile(rb"^element\s+face\s+(\d{1,20})\s*$", re.MULTILINE)
_OBJ_FACE = re.compile(rb"^f[ \t]", re.MULTILINE)


def check_face_count(data: bytes, limit: int) -> None:
    """Raise ProblemError 413 if the file declares more than `limit` faces; mesh import counts them."""
    count = face_count(data)
    # more declared faces than bytes means a corrupt header, for which mesh import has a better message
    if limit < count <= len(data):
        raise ProblemError(
            413,
            "too-many-faces",
            "The mesh has too many triangles",
            detail=f"It declares {count} faces; the limit is {limit}.",
            hint=f"Reduce it to fewer than {limit} faces and upload it again.",
        )


def face_count(data: bytes) -> int:
    """Faces declared by the header of a PLY, STL or GLB file, or `f` lines of an OBJ file; 0 if unknown."""
    if data[:3] == b"ply":
        found = _PLY_FACES.search(data[: data.find(b"end_header") + 1 or 65536].replace(b"\r", b""))
        return int(found[1]) if found else 0
    if data[:4] == b"glTF":
        return _gltf_faces(data)
    if data[:2] == b"PK":  # mesh import counts the faces of what is in the archive
        return 0
    if len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little"):
        return int.from_bytes(data[80:84], "little")
    return sum(1 for _ in _OBJ_FACE.finditer(data))


def _gltf_faces(data: bytes) -> int:
    """A third of the indices of all primitives; 0 for a malformed file, which mesh import then rejects."""
    if len(data) < 20:
        return 0
    (length,) = struct.unpack_from("<I", data, 12)
    if length > LARGEST_HEAD_BYTES:
        return 0
    try:
        scene = json.loads(data[20 : 20 + length])
        accessors = scene["accessors"]
        primitives = [primitive for mesh in scene["meshes"] for primitive in mesh["primitives"]]
        return sum(int(accessors[_corners(primitive)]["count"]) for primitive in primitives) // 3
    except (ValueError, KeyError, IndexError, TypeError, RecursionError):
        return 0


def _corners(primitive: dict[str, dict[str, int]]) -> int:
    indices = primitive.get("indices")
    return indices if isinstance(indices, int) else primitive["attributes"]["POSITION"]
