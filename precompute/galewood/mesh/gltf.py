"""glTF 2.0 reader that works on bytes only: every offset is checked and external files are rejected.

Quantised attributes (KHR_mesh_quantization) are decoded. Draco, meshopt and sparse accessors are rejected
with specific errors. Source: glTF 2.0 specification, sections 3.6 (buffers, accessors) and 4 (GLB).
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from galewood.mesh.gltf_material import read_material
from galewood.mesh.gltf_scene import mesh_instances
from galewood.mesh.types import RawPart
from galewood.util import Floats, Ints, MeshError

Json = dict[str, Any]
GLB_HEADER_BYTES = 12
CHUNK_JSON, CHUNK_BIN = 0x4E4F534A, 0x004E4942
COMPONENTS = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
UNDERSTOOD = {"KHR_mesh_quantization", "KHR_texture_transform", "KHR_materials_unlit"}
REFUSED = {
    "KHR_draco_mesh_compression": (
        "draco-compressed",
        "Draco",
        "npx @gltf-transform/cli copy in.glb out.glb",
    ),
    "EXT_meshopt_compression": (
        "meshopt-compressed",
        "meshopt",
        "npx @gltf-transform/cli copy in.glb out.glb",
    ),
    "KHR_meshopt_compression": (
        "meshopt-compressed",
        "meshopt",
        "npx @gltf-transform/cli copy in.glb out.glb",
    ),
}
TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = 4, 5, 6


def read_glb(data: bytes) -> list[RawPart]:
    """Parts of a binary glTF with node transforms applied (+Y up, file units). Raises MeshError."""
    if len(data) < GLB_HEADER_BYTES + 8:
        raise _broken("truncated", "The GLB header is incomplete.")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise _broken("gltf-version", f"The file has glTF version {version}; only version 2 is supported.")
    if length > len(data):
        raise _broken("truncated", f"The GLB declares {length} bytes but has only {len(data)}.")
    document, binary = _chunks(data[:length])
    return _parts(document, binary)


def read_gltf(data: bytes) -> list[RawPart]:
    """Parts of a stand-alone .gltf file, whose buffers must be data URIs. Raises MeshError."""
    return _parts(_json(data), None)


def _chunks(data: bytes) -> tuple[Json, bytes | None]:
    document: Json | None = None
    binary: bytes | None = None
    offset = GLB_HEADER_BYTES
    while offset + 8 <= len(data):
        size, kind = struct.unpack_from("<II", data, offset)
        body = data[offset + 8 : offset + 8 + size]
        if len(body) != size:
            raise _broken("truncated", "A GLB chunk extends beyond the end of the file.")
        if document is None and kind == CHUNK_JSON:
            document = _json(body)
        elif binary is None and kind == CHUNK_BIN:
            binary = body
        offset += 8 + size
    if document is None:
        raise _broken("gltf-structure", "The GLB has no JSON chunk.")
    return document, binary


def _json(data: bytes) -> Json:
    try:
        document = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise _broken("gltf-json", "The JSON of the glTF cannot be parsed.") from error
    if not isinstance(document, dict):
        raise _broken("gltf-json", "The JSON of the glTF is not an object.")
    return document


def _broken(code: str, title: str, hint: str = "The file is damaged; export it again.") -> MeshError:
    return MeshError(code, "malformed", title, hint)


def _parts(document: Json, binary: bytes | None) -> list[RawPart]:
    try:
        return _Gltf(document, binary).parts()
    except (KeyError, IndexError, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise _broken(
            "gltf-structure", f"The glTF refers to an element that does not exist ({error})."
        ) from error


class _Gltf:
    """A document with its buffers; every lookup is checked, so that invalid files raise MeshError."""

    def __init__(self, document: Json, binary: bytes | None) -> None:
        self.document = document
        self._reject_extensions()
        self.buffers = [self._buffer(i, b, binary) for i, b in enumerate(document.get("buffers", []))]

    def parts(self) -> list[RawPart]:
        """All triangle primitives of the default scene."""
        return [
            self._part(primitive, labels, matrix)
            for mesh, labels, matrix in mesh_instances(self.document)
            for primitive in mesh.get("primitives", [])
            if primitive.get("mode", TRIANGLES) in (TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN)
        ]

    def _reject_extensions(self) -> None:
        required = self.document.get("extensionsRequired", [])
        for name in required:
            if name in REFUSED:
                code, word, command = REFUSED[name]
                raise MeshError(
                    code,
                    "unsuitable",
                    f"The mesh is compressed with {word} ({name}), which is not supported.",
                    f"Save it without compression, for example with: {command}",
                )  # fmt: skip
        unknown = [
            str(n) for n in required if n not in UNDERSTOOD and not str(n).startswith("KHR_materials_")
        ]
        if any("texture" not in n for n in unknown):
            raise MeshError(
                "gltf-extension",
                "unsuitable",
                f"The glTF requires unsupported extensions: {', '.join(unknown)}.",
                "Export the file without them.",
            )

    def _buffer(self, index: int, buffer: Json, binary: bytes | None) -> bytes:
        uri = buffer.get("uri")
        if uri is None and index == 0 and binary is not None:
            content = binary
        elif isinstance(uri, str) and uri.startswith("data:"):
            content = data_uri(uri)[0]
        else:
            raise MeshError(
                "external-buffers", "malformed",
                "The glTF stores its geometry in another file; external buffers are not supported.",
                "Export one .glb file (in Blender: glTF Binary).",
            )  # fmt: skip
        if len(content) < int(buffer.get("byteLength", 0)):
            raise _broken("truncated", "A glTF buffer is shorter than declared.")
        return content

    def view_bytes(self, index: int) -> tuple[bytes, int]:
        """Bytes of a buffer view and its stride (0: tightly packed)."""
        view = self.document["bufferViews"][_natural(index)]
        if any(name in view.get("extensions", {}) for name in REFUSED):
            raise MeshError(
                "meshopt-compressed",
                "unsuitable",
                "A buffer view is compressed with meshopt, which is not supported.",
                "Save the file without compression.",
            )
        start, size = _natural(view.get("byteOffset", 0)), _natural(view["byteLength"])
        content = self.buffers[_natural(view["buffer"])]
        if start + size > len(content):
            raise _broken("truncated", "A buffer view extends beyond the end of its buffer.")
        return content[start : start + size], _natural(view.get("byteStride", 0))

    def accessor(self, index: int) -> NDArray[Any]:
        """Accessor values (count, width) in the stored component type."""
        accessor = self.document["accessors"][_natural(index)]
        if "sparse" in accessor or "bufferView" not in accessor:
            raise MeshError(
                "gltf-sparse",
                "unsuitable",
                "The glTF uses sparse or empty accessors, which are not supported.",
                "Export the file without them.",
            )
        kind = np.dtype(COMPONENTS[accessor["componentType"]]).newbyteorder("<")
        width, count = WIDTHS[accessor["type"]], _natural(accessor["count"])
        content, stride = self.view_bytes(accessor["bufferView"])
        stride = stride or width * kind.itemsize
        start = _natural(accessor.get("byteOffset", 0))
        if stride < width * kind.itemsize or start + stride * (count - 1) + width * kind.itemsize > len(
            content
        ):
            raise _broken("truncated", "An accessor extends beyond the end of its data.")
        return np.ndarray((count, width), kind, content, start, (stride, kind.itemsize)).copy()

    def floats(self, index: int | None) -> Floats | None:
        """Accessor values as floats; normalised integers are mapped to [0, 1] or [-1, 1]."""
        if index is None:
            return None
        values = self.accessor(index)
        if self.document["accessors"][index].get("normalized") and values.dtype.kind in "iu":
            return np.maximum(values.astype(np.float64) / np.iinfo(values.dtype).max, -1.0)
        return values.astype(np.float64)

    def _part(self, primitive: Json, labels: tuple[str, ...], matrix: Floats) -> RawPart:
        attributes = primitive["attributes"]
        positions = self.floats(attributes["POSITION"])
        if positions is None or positions.shape[1] != 3:
            raise _broken("gltf-structure", "A primitive has no positions.")
        normals, colours = self.floats(attributes.get("NORMAL")), self.floats(attributes.get("COLOR_0"))
        index = primitive.get("material")
        raw = {} if index is None else self.document["materials"][_natural(index)]
        name = raw.get("name", "")
        return RawPart(
            labels=((str(name),) if name else ()) + labels,
            positions=positions @ matrix[:3, :3].T + matrix[:3, 3],
            faces=_restore_winding(self._faces(primitive, len(positions)), matrix),
            normals=None if normals is None else _rotated(normals, matrix),
            uv=self.floats(attributes.get("TEXCOORD_0")),
            colours=colours,
            material=read_material(self.document, raw, self.image_bytes),
        )

    def _faces(self, primitive: Json, count: int) -> Ints:
        if "indices" in primitive:
            indices = self.accessor(primitive["indices"])[:, 0].astype(np.int64)
        else:
            indices = np.arange(count, dtype=np.int64)
        if indices.size and int(indices.max()) >= count:
            raise _broken(
                "index-out-of-range", f"A face refers to vertex {indices.max()}, but there are only {count}."
            )
        return _triangles(indices, primitive.get("mode", TRIANGLES))

    def image_bytes(self, image: Json) -> tuple[bytes, str] | None:
        """Content and MIME type of an embedded image; None for external images, which are ignored."""
        if "bufferView" in image:
            return self.view_bytes(image["bufferView"])[0], str(image.get("mimeType", "image/png"))
        uri = image.get("uri", "")
        return data_uri(uri) if uri.startswith("data:") else None


def _natural(value: Any) -> int:
    """The index, if it is a non-negative integer, else IndexError: Python would accept negative ones."""
    if not isinstance(value, int) or value < 0:
        raise IndexError(f"index {value!r}")
    return value


def _triangles(indices: NDArray[np.int64], mode: int) -> Ints:
    if mode == TRIANGLES:
        return indices[: len(indices) // 3 * 3].reshape(-1, 3).astype(np.int32)
    i = np.arange(max(len(indices) - 2, 0))
    if mode == TRIANGLE_FAN:
        return np.column_stack(
            [np.broadcast_to(indices[:1], i.shape), indices[i + 1], indices[i + 2]]
        ).astype(np.int32)
    odd = i % 2
    return np.column_stack([indices[i], indices[i + 1 + odd], indices[i + 2 - odd]]).astype(np.int32)


def _restore_winding(faces: Ints, matrix: Floats) -> Ints:
    """Reverse the faces of mirrored nodes, which would otherwise be inside out."""
    return np.ascontiguousarray(faces[:, ::-1]) if np.linalg.det(matrix[:3, :3]) < 0 else faces


def _rotated(normals: Floats, matrix: Floats) -> Floats:
    linear = matrix[:3, :3]
    if abs(np.linalg.det(linear)) < 1e-30:
        return normals
    turned = normals @ np.linalg.inv(linear)  # rows times (A⁻ᵀ)ᵀ
    return turned / np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-30)


def data_uri(uri: str) -> tuple[bytes, str]:
    """Content and MIME type of a base64 data URI."""
    head, _, body = uri.partition(",")
    if not head.endswith(";base64"):
        raise _broken("gltf-structure", "A data URI of the glTF is not base64.")
    try:
        return base64.b64decode(body, validate=True), head[5:-7]
    except (binascii.Error, ValueError) as error:
        raise _broken("gltf-structure", "A data URI of the glTF cannot be decoded.") from error
