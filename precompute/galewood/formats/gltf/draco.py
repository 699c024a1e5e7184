"""Primitives compressed with Draco (KHR_draco_mesh_compression).

The package DracoPy decodes them: a binding of Google's decoder. The counts that a stream declares are
compared with the limits before anything is decoded.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from galewood.formats.gltf.document import GltfDocument, broken
from galewood.formats.limits import MAX_VERTICES, check_faces
from galewood.util import Ints, MeshError

Json = dict[str, Any]
EXTENSION_NAME = "KHR_draco_mesh_compression"
HEADER_BYTES = 11
TRIANGULAR_MESH, SEQUENTIAL_METHOD, EDGEBREAKER_METHOD = 1, 0, 1
HAS_METADATA = 0x8000


class DracoPrimitive:
    """The decoded mesh of a primitive: triangles, and rows of each attribute."""

    def __init__(self, document: GltfDocument, primitive: Json) -> None:
        extension = primitive["extensions"][EXTENSION_NAME]
        self._ids: dict[str, int] = extension["attributes"]
        content = document.view_bytes(extension["bufferView"])[0]
        _check_declared(content)
        self._mesh = _decode(content)
        self.faces: Ints = np.asarray(self._mesh.faces, dtype=np.int32).reshape(-1, 3)

    def attribute(self, name: str) -> NDArray[Any] | None:
        """Rows (n, width) of an attribute in the type in which it is stored, or None."""
        if name not in self._ids:
            return None
        found = self._mesh.get_attribute_by_unique_id(self._ids[name])
        if found is None:
            raise broken("gltf-structure", f"A compressed mesh lacks its attribute {name}.")
        return np.asarray(found["data"]).reshape(len(self._mesh.points), -1)


def _decode(content: bytes) -> Any:
    import DracoPy  # only compressed files need it

    try:
        return DracoPy.decode(content)
    except MemoryError:
        raise
    except Exception as error:
        raise _damaged() from error


def _check_declared(content: bytes) -> None:
    """Compare the triangles and vertices that the stream's header declares with the limits.

    Source: Draco bitstream specification, sections 3 (header) and 5 (connectivity).
    """
    if len(content) < HEADER_BYTES or content[:5] != b"DRACO":
        raise _damaged()
    major, minor, kind, method, flags = struct.unpack_from("<BBBBH", content, 5)
    if kind != TRIANGULAR_MESH:
        raise broken("draco-damaged", "A compressed mesh is a point cloud.")
    if (
        flags & HAS_METADATA
        or (major, minor) < (2, 2)
        or method not in (SEQUENTIAL_METHOD, EDGEBREAKER_METHOD)
    ):
        return  # older streams, which few files have, are limited only by the memory of the process
    at = HEADER_BYTES + (1 if method == EDGEBREAKER_METHOD else 0)
    first, at = _varint(content, at)
    second = _varint(content, at)[0]
    faces, vertices = (second, first) if method == EDGEBREAKER_METHOD else (first, second)
    check_faces(faces)
    if vertices > MAX_VERTICES:
        raise broken("wrong-count", f"A compressed mesh declares {vertices} vertices.")


def _varint(content: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        if at >= len(content) or shift > 63:
            raise _damaged()
        byte = content[at]
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if not byte & 0x80:
            return value, at


def _damaged() -> MeshError:
    return broken("draco-damaged", "A mesh compressed with Draco cannot be decoded.")
