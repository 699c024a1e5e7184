"""Buffers, accessors and images of a glTF 2.0 document; every index, offset and size is checked.

Source: glTF 2.0 specification, sections 3.6 (buffers, accessors) and 3.8.3 (images).
"""

from __future__ import annotations

import base64
import binascii
from typing import Any

import numpy as np
from numpy.typing import NDArray

from galewood.formats.companions import Source
from galewood.formats.gltf.material import natural
from galewood.formats.gltf.meshopt import compressed_view, decode_view
from galewood.formats.limits import MAX_VERTICES, Budget
from galewood.formats.textures import drawable
from galewood.util import Floats, MeshError

Json = dict[str, Any]
COMPONENTS = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
MAX_ROWS = 3 * MAX_VERTICES  # of one accessor
PACK_HINT = (
    "Upload one .glb file (in Blender: glTF Binary), or a ZIP of the .gltf, its .bin and its textures."
)


def broken(code: str, title: str, hint: str = "The file is damaged; export it again.") -> MeshError:
    """The error for a file that contradicts itself."""
    return MeshError(code, "malformed", title, hint)


class GltfDocument:
    """A document with its buffers.

    Lookups raise MeshError or, for missing elements, IndexError or KeyError.
    """

    def __init__(self, document: Json, binary: bytes | None, source: Source) -> None:
        self.json = document
        self.source = source
        self.budget = Budget()
        self._binary = binary
        self._buffers: dict[int, bytes] = {}
        self._decoded: dict[int, bytes] = {}
        self._images: dict[int, tuple[bytes, str] | None] = {}

    def accessor(self, index: int) -> NDArray[Any]:
        """Accessor values (count, width) in the stored component type."""
        accessor = self.json["accessors"][natural(index)]
        kind = np.dtype(COMPONENTS[accessor["componentType"]]).newbyteorder("<")
        width, count = WIDTHS[accessor["type"]], natural(accessor["count"])
        if "bufferView" in accessor:
            values = self._strided(accessor["bufferView"], accessor, kind, width, count)
        else:
            _check_rows(count)
            values = np.zeros((count, width), kind)
        if "sparse" in accessor:
            self._substitute(values, accessor["sparse"], kind, width)
        return values

    def floats(self, index: int | None) -> Floats | None:
        """Accessor values as floats; normalised integers are mapped to [0, 1] or [-1, 1]."""
        if index is None:
            return None
        return as_floats(self.accessor(index), self.json["accessors"][index])

    def view_bytes(self, index: int) -> tuple[bytes, int]:
        """Bytes of a buffer view and its stride (0: tightly packed)."""
        view = self.json["bufferViews"][natural(index)]
        stride = natural(view.get("byteStride", 0))
        packed = compressed_view(view)
        if packed is None:
            return self._slice(view), stride
        if index not in self._decoded:
            self._decoded[index] = decode_view(packed, self._slice(packed), self.budget)
        return self._decoded[index], natural(packed["byteStride"])

    def image(self, index: int) -> tuple[bytes, str] | None:
        """Content and MIME type of an image that browsers can draw; None, after a warning, for any other."""
        if index not in self._images:
            self._images[index] = self._read_image(index)
        return self._images[index]

    def _read_image(self, index: int) -> tuple[bytes, str] | None:
        image = self.json["images"][natural(index)]
        uri = image.get("uri", "")
        name = str(image.get("name") or ("" if uri.startswith("data:") else uri) or f"image {index}")[:80]
        if "bufferView" in image:
            content = self.view_bytes(image["bufferView"])[0]
        elif uri.startswith("data:"):
            content = data_uri(uri)
        else:
            content = self.source.files.find(uri)
        if content is None:
            self.source.warn(f"The texture {name!r} is in another file and is not drawn. {PACK_HINT}")
            return None
        return drawable(content, name, self.source)

    def _slice(self, view: Json) -> bytes:
        start, size = natural(view.get("byteOffset", 0)), natural(view["byteLength"])
        content = self._buffer(natural(view["buffer"]))
        if start + size > len(content):
            raise broken("truncated", "A buffer view extends beyond the end of its buffer.")
        return content[start : start + size]

    def _buffer(self, index: int) -> bytes:
        if index not in self._buffers:
            self._buffers[index] = self._read_buffer(index)
        return self._buffers[index]

    def _read_buffer(self, index: int) -> bytes:
        buffer = self.json["buffers"][index]
        uri = buffer.get("uri")
        if uri is None and index == 0 and self._binary is not None:
            content = self._binary
        elif isinstance(uri, str) and uri.startswith("data:"):
            content = data_uri(uri)
        else:
            content = self.source.files.find(uri) if isinstance(uri, str) else None
        if content is None:
            raise broken(
                "external-buffers",
                "The glTF stores its geometry in another file, which was not found beside it.",
                PACK_HINT,
            )
        if len(content) < int(buffer.get("byteLength", 0)):
            raise broken("truncated", "A glTF buffer is shorter than declared.")
        return content

    def _strided(
        self, view: int, accessor: Json, kind: np.dtype[Any], width: int, count: int
    ) -> NDArray[Any]:
        content, stride = self.view_bytes(view)
        stride = stride or width * kind.itemsize
        start = _natural_offset(accessor)
        if stride < width * kind.itemsize or start + stride * (count - 1) + width * kind.itemsize > len(
            content
        ):
            raise broken("truncated", "An accessor extends beyond the end of its data.")
        return np.ndarray((count, width), kind, content, start, (stride, kind.itemsize)).copy()

    def _substitute(self, values: NDArray[Any], sparse: Json, kind: np.dtype[Any], width: int) -> None:
        """Replace some rows, in place, as a sparse accessor says."""
        count = natural(sparse["count"])
        where, what = sparse["indices"], sparse["values"]
        index_kind = np.dtype(COMPONENTS[where["componentType"]]).newbyteorder("<")
        rows = self._strided(where["bufferView"], where, index_kind, 1, count)[:, 0].astype(np.int64)
        if rows.size and int(rows.max()) >= len(values):
            raise broken("gltf-structure", "A sparse accessor replaces a row that does not exist.")
        values[rows] = self._strided(what["bufferView"], what, kind, width, count)


def _natural_offset(holder: Json) -> int:
    return natural(holder.get("byteOffset", 0))


def _check_rows(count: int) -> None:
    if count > MAX_ROWS:
        raise broken("wrong-count", f"An accessor without data declares {count} elements.")


def as_floats(values: NDArray[Any], accessor: Json) -> Floats:
    """Values (n, width) as floats; normalised integers as in the specification, section 3.6.2.2."""
    if accessor.get("normalized") and values.dtype.kind in "iu":
        return np.maximum(values.astype(np.float64) / np.iinfo(values.dtype).max, -1.0)
    return values.astype(np.float64)


def data_uri(uri: str) -> bytes:
    """Content of a base64 data URI."""
    head, _, body = uri.partition(",")
    if not head.endswith(";base64"):
        raise broken("gltf-structure", "A data URI of the glTF is not base64.")
    try:
        return base64.b64decode(body, validate=True)
    except (binascii.Error, ValueError) as error:
        raise broken("gltf-structure", "A data URI of the glTF cannot be decoded.") from error
