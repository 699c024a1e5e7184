"""Buffers of a GLB compressed with meshopt: rows in the same order, rounded to what a picture shows.

Sources: EXT_meshopt_compression and KHR_mesh_quantization (Khronos glTF extensions).
"""

from __future__ import annotations

from typing import Any, ClassVar

import meshopt
import numpy as np
from numpy.typing import NDArray

from galewood.util import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, GLTF_FLOAT, Json

GLTF_BYTE, UNSIGNED_BYTE = 5120, 5121
COMPONENTS = {5123: "<u2", 5125: "<u4", GLTF_FLOAT: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
POSITION_BITS, UV_BITS = 18, 16
"""Bits of a coordinate with its sign; 18 for a tree of 16 to 32 m are steps of 0.24 mm."""
NORMAL_BITS, NORMAL_STRIDE = 8, 4
MESHOPT_EXTENSION, QUANTIZATION_EXTENSION = "EXT_meshopt_compression", "KHR_mesh_quantization"


class CompressedBuffers:
    """Accessors of a document, one after the other, each as a compressed buffer view of its own."""

    EXTENSIONS: ClassVar = (MESHOPT_EXTENSION, QUANTIZATION_EXTENSION)

    def __init__(self, document: Json, body: bytes) -> None:
        self.binary = b""
        self._source, self._body = document, body
        self._accessors: list[Json] = [{} for _ in document["accessors"]]
        self._views: list[Json] = []
        self._decoded_bytes = 0

    def attribute(self, name: str, index: int) -> None:
        """Compress the rows of a vertex attribute."""
        rows = self._rows(index)
        if name == "NORMAL":
            packed = meshopt.encode_filter_oct(
                np.hstack([rows, np.ones((len(rows), 1), np.float32)]).astype("<f4"),
                NORMAL_STRIDE,
                NORMAL_BITS,
            )
            view = self._view(packed, NORMAL_STRIDE, "OCTAHEDRAL")
            kind: Json = {"componentType": GLTF_BYTE, "normalized": True}
        elif name.startswith("COLOR"):
            packed = np.round(np.clip(rows, 0, 1) * 255).astype(np.uint8)
            view = self._view(packed, packed.shape[1], None)
            kind = {"componentType": UNSIGNED_BYTE, "normalized": True}
        else:
            bits = POSITION_BITS if name == "POSITION" else UV_BITS
            packed = meshopt.encode_filter_exp(rows, bits, "SharedComponent")
            view = self._view(packed, 4 * rows.shape[1], "EXPONENTIAL")
            kind = {"componentType": GLTF_FLOAT}
        old = self._source["accessors"][index]
        self._accessors[index] = {"bufferView": view, "count": len(rows), "type": old["type"]} | kind
        if name == "POSITION":
            self._accessors[index] |= self._bounds(view, len(rows))

    def indices(self, index: int) -> None:
        """Compress the corners of triangles."""
        corners = self._rows(index)
        stride = corners.dtype.itemsize
        view = self._append(meshopt.encode_gltf_buffer(corners, "TRIANGLES"), len(corners), stride)
        view["extensions"][MESHOPT_EXTENSION] |= {"mode": "TRIANGLES"}
        view["target"] = ELEMENT_ARRAY_BUFFER
        old = self._source["accessors"][index]
        self._accessors[index] = old | {"bufferView": len(self._views) - 1}

    def document(self) -> Json:
        """Accessors, buffer views and buffers; the second buffer is the one that readers decode into."""
        fallback = {"byteLength": self._decoded_bytes, "extensions": {MESHOPT_EXTENSION: {"fallback": True}}}
        return {
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": len(self.binary)}, fallback],
        }

    def _rows(self, index: int) -> NDArray[Any]:
        accessor = self._source["accessors"][index]
        view = self._source["bufferViews"][accessor["bufferView"]]
        width = WIDTHS[accessor["type"]]
        kind = COMPONENTS[accessor["componentType"]]
        values = np.frombuffer(self._body, kind, accessor["count"] * width, view["byteOffset"])
        return values.reshape(-1, width)

    def _view(self, rows: NDArray[Any], stride: int, scheme: str | None) -> int:
        view = self._append(meshopt.encode_gltf_buffer(rows, "ATTRIBUTES"), len(rows), stride)
        view["extensions"][MESHOPT_EXTENSION] |= {"mode": "ATTRIBUTES"} | (
            {"filter": scheme} if scheme else {}
        )
        view |= {"byteStride": stride, "target": ARRAY_BUFFER}
        return len(self._views) - 1

    def _append(self, content: bytes, count: int, stride: int) -> Json:
        start = len(self.binary)
        self.binary += content + b"\0" * (-len(content) % 4)
        packed = {
            "buffer": 0,
            "byteOffset": start,
            "byteLength": len(content),
            "byteStride": stride,
            "count": count,
        }
        view = {
            "buffer": 1,
            "byteOffset": self._decoded_bytes,
            "byteLength": count * stride,
            "extensions": {MESHOPT_EXTENSION: packed},
        }
        self._decoded_bytes += count * stride + -(count * stride) % 4
        self._views.append(view)
        return view

    def _bounds(self, view: int, count: int) -> Json:
        packed = self._views[view]["extensions"][MESHOPT_EXTENSION]
        content = self.binary[packed["byteOffset"] :][: packed["byteLength"]]
        decoded = meshopt.decode_gltf_buffer(content, count, 12, "ATTRIBUTES", "EXPONENTIAL")
        rows = np.frombuffer(decoded.tobytes(), "<f4").reshape(-1, 3)
        return {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
