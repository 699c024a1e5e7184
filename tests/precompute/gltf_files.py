"""A writer of GLB files with the features that other programs use, for the tests."""

import io
import json
import struct
from typing import Any

import DracoPy
import meshopt
import numpy as np
from galewood.tree.repair import Surface
from PIL import Image

Json = dict[str, Any]
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
DRACO, MESHOPT = "KHR_draco_mesh_compression", "EXT_meshopt_compression"
SQUARE_UV = np.array([[0.0, 1], [1, 1], [1, 0], [0, 0]])


class GltfFile:
    """A document under construction; every method returns the index of what it adds."""

    def __init__(self) -> None:
        self.json: Json = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "accessors": [],
            "bufferViews": [],
        }
        self.binary = bytearray()

    def use(self, name: str, required: bool = True) -> None:
        for key in ("extensionsUsed", "extensionsRequired")[: 1 + required]:
            if name not in self.json.setdefault(key, []):
                self.json[key].append(name)

    def slice_of(self, content: bytes) -> Json:
        self.binary += bytes(-len(self.binary) % 4)
        found = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        self.binary += content
        return found

    def view(self, content: bytes, **more: Any) -> int:
        self.json["bufferViews"].append(self.slice_of(content) | more)
        return len(self.json["bufferViews"]) - 1

    def accessor(self, rows: np.ndarray, view: int | None = None, **more: Any) -> int:
        """Rows (n, width), packed with each row padded to four bytes; without data if `view` is -1."""
        rows = rows.reshape(len(rows), -1)
        kind = rows.dtype.str[1:]
        given: Json = {"componentType": COMPONENTS[kind], "count": len(rows), "type": TYPES[rows.shape[1]]}
        if view is None:
            padded, stride = aligned(rows)
            view = self.view(padded, **({"byteStride": stride} if stride != rows.itemsize else {}))
        if view >= 0:
            given["bufferView"] = view
        self.json["accessors"].append(given | more)
        return len(self.json["accessors"]) - 1

    def indices(self, faces: np.ndarray) -> int:
        flat = faces.reshape(-1).astype("<u4")
        view = self.view(flat.tobytes())
        given = {"bufferView": view, "componentType": 5125, "count": len(flat), "type": "SCALAR"}
        self.json["accessors"].append(given)
        return len(self.json["accessors"]) - 1

    def plain(self, surface: Surface, **more: Any) -> Json:
        """A primitive with float positions."""
        return {
            "attributes": {"POSITION": self.accessor(surface.vertices.astype("<f4"))},
            "indices": self.indices(surface.faces),
        } | more

    def draco(self, surface: Surface, bits: int = 14, **more: Any) -> Json:
        """A primitive whose positions and triangles are compressed with Draco."""
        self.use(DRACO)
        content = DracoPy.encode(
            surface.vertices.astype("<f4"), surface.faces.astype("<u4"), quantization_bits=bits
        )
        decoded = DracoPy.decode(content)
        extension = {"bufferView": self.view(content), "attributes": {"POSITION": 0}}
        positions = self.accessor(decoded.points.astype("<f4"), -1)
        corners = self.accessor(decoded.faces.reshape(-1, 1).astype("<u4"), -1)
        return {
            "attributes": {"POSITION": positions},
            "indices": corners,
            "extensions": {DRACO: extension},
        } | more

    def meshopt_view(self, content: bytes, count: int, stride: int, mode: str, **more: Any) -> int:
        """A buffer view whose encoded bytes are given."""
        self.use(MESHOPT)
        packed = self.slice_of(content) | {"count": count, "byteStride": stride, "mode": mode} | more
        given = {"buffer": 0, "byteLength": count * stride, "extensions": {MESHOPT: packed}}
        if mode == "ATTRIBUTES":
            given["byteStride"] = stride
        self.json["bufferViews"].append(given)
        return len(self.json["bufferViews"]) - 1

    def meshopt(self, surface: Surface, exponent_bits: int = 15, **more: Any) -> Json:
        """A primitive whose positions (exponential filter) and triangles are compressed with meshopt."""
        faces = surface.faces.reshape(-1).astype("<u4")
        rows = meshopt.encode_filter_exp(surface.vertices.astype("<f4"), exponent_bits)
        content = meshopt.encode_gltf_buffer(rows, "ATTRIBUTES")
        view = self.meshopt_view(content, len(rows), 12, "ATTRIBUTES", filter="EXPONENTIAL")
        positions = self.accessor(surface.vertices.astype("<f4"), view)
        packed = meshopt.encode_gltf_buffer(faces, "TRIANGLES")
        corners = self.accessor(faces[:, None], self.meshopt_view(packed, len(faces), 4, "TRIANGLES"))
        return {"attributes": {"POSITION": positions}, "indices": corners} | more

    def mesh(self, *primitives: Json, **more: Any) -> int:
        self.json["meshes"].append({"primitives": list(primitives)} | more)
        return len(self.json["meshes"]) - 1

    def node(self, root: bool = True, **given: Any) -> int:
        self.json["nodes"].append(given)
        if root:
            self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)
        return len(self.json["nodes"]) - 1

    def material(
        self, name: str, content: bytes, mime: str, extension: str | None = None, **slot: Any
    ) -> int:
        """A material whose base colour is an embedded image, behind an extension if one is given."""
        for key in ("images", "textures", "materials"):
            self.json.setdefault(key, [])
        self.json["images"].append({"bufferView": self.view(content), "mimeType": mime, "name": name})
        source: Json = {"source": len(self.json["images"]) - 1}
        if extension:
            self.use(extension)
            source = {"extensions": {extension: source}}
        self.json["textures"].append(source)
        texture = {"index": len(self.json["textures"]) - 1} | slot
        self.json["materials"].append(
            {"name": name, "alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": texture}}
        )
        return len(self.json["materials"]) - 1

    def bytes(self) -> bytes:
        self.json["buffers"] = [{"byteLength": len(self.binary)}]
        document = {key: value for key, value in self.json.items() if value != []}
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        body = bytes(self.binary) + bytes(-len(self.binary) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(body), b"BIN\0") + body
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def aligned(rows: np.ndarray) -> tuple[bytes, int]:
    """Rows padded to a multiple of four bytes, as glTF demands of vertex attributes, and their length."""
    width = rows.shape[1] * rows.itemsize
    stride = (width + 3) // 4 * 4
    padded = np.zeros((len(rows), stride), dtype=np.uint8)
    padded[:, :width] = np.ascontiguousarray(rows).view(np.uint8).reshape(len(rows), width)
    return padded.tobytes(), stride


def leaf_image(form: str, side: int = 16) -> bytes:
    """A green square on a transparent ground, lossless, in a format of Pillow."""
    pixels = np.zeros((side, side, 4), dtype=np.uint8)
    pixels[side // 4 : 3 * side // 4, side // 4 : 3 * side // 4] = (30, 160, 20, 255)
    stream = io.BytesIO()
    Image.fromarray(pixels, "RGBA").save(
        stream, form, **({"lossless": True, "exact": True} if form == "WEBP" else {})
    )
    return stream.getvalue()


def ktx2(rgba: tuple[int, int, int, int], width: int = 8, height: int = 8) -> bytes:
    """A KTX2 file of one colour: UASTC blocks of the "solid colour" mode, without supercompression.

    Source: KTX 2.0 specification; UASTC LDR 4x4 texture specification, mode 8.
    """
    block = solid_uastc_block(rgba)
    blocks = ((width + 3) // 4) * ((height + 3) // 4)
    data = block * blocks
    descriptor = _uastc_descriptor()
    header = b"\xabKTX 20\xbb\r\n\x1a\n" + struct.pack("<9I", 0, 1, width, height, 0, 0, 1, 1, 0)
    offset = 80 + 24 + len(descriptor)
    start = (offset + 15) // 16 * 16
    index = struct.pack("<4I2Q", 80 + 24, len(descriptor), 0, 0, 0, 0)
    level = struct.pack("<3Q", start, len(data), len(data))
    return header + index + level + descriptor + bytes(start - offset) + data


def solid_uastc_block(rgba: tuple[int, int, int, int]) -> bytes:
    """The five bits of mode 8 (binary 10111, the lowest first), then the colour, then ETC1 hints of zero."""
    bits = 0b10111
    for k, channel in enumerate(rgba):
        bits |= channel << (5 + 8 * k)
    return bits.to_bytes(16, "little")


def _uastc_descriptor() -> bytes:
    """A basic data format descriptor: colour model 166 (UASTC), sRGB, one RGBA channel of 128 bits."""
    head = struct.pack("<2HI", 0, 0, 0)[:4] + struct.pack("<2H", 2, 24 + 16)
    body = bytes([166, 1, 2, 0, 3, 3, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0])
    sample = struct.pack("<HBB4BII", 0, 127, 3, 0, 0, 0, 0, 0, 0xFFFFFFFF)
    content = head + body + sample
    return struct.pack("<I", 4 + len(content)) + content
