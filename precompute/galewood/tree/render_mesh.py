"""The tree as a GLB for rendering: transforms applied, one mesh per primitive, vertices in table order."""

from __future__ import annotations

import copy

import numpy as np

from galewood.formats import SLOTS, Material
from galewood.tree.types import RenderPrimitive, TreeMesh
from galewood.util import (
    ARRAY_BUFFER,
    ELEMENT_ARRAY_BUFFER,
    GLTF_FLOAT,
    WEBP_EXTENSION,
    WEBP_MIME,
    Floats,
    Ints,
    Json,
    packed_glb,
)

UNSIGNED_SHORT, UNSIGNED_INT = 5123, 5125
DEFAULT_COLOURS = {
    "wood": [0.28, 0.2, 0.14, 1.0],
    "twigs": [0.28, 0.2, 0.14, 1.0],
    "leaves": [0.22, 0.36, 0.1, 1.0],
}


def render_glb(tree: TreeMesh) -> bytes:
    """The tree's primitives, in order, as a valid binary glTF 2.0; deterministic for a given tree."""
    writer = GlbWriter()
    for primitive in tree.primitives:
        writer.add(primitive)
    return writer.glb()


class GlbWriter:
    """Collects primitives in a glTF document."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.document: Json = {
            "asset": {"version": "2.0", "generator": "Galewood"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "accessors": [],
            "bufferViews": [],
            "materials": [],
            "textures": [],
            "images": [],
            "samplers": [],
        }
        self.images: dict[bytes, int] = {}
        self.extensions: set[str] = set()

    def add(self, primitive: RenderPrimitive, piece: Ints | None = None) -> None:
        """Add a primitive as a mesh; with the row of each vertex's piece, `piece` (n,), without normals."""
        attributes = {"POSITION": self._floats(primitive.positions_m, bounds=True)}
        if piece is not None:
            attributes["_PIECE"] = self._floats(piece[:, None].astype(np.float64))
        else:
            normals = primitive.normals if primitive.normals is not None else vertex_normals(primitive)
            attributes["NORMAL"] = self._floats(normals)
        if primitive.uv is not None:
            attributes["TEXCOORD_0"] = self._floats(primitive.uv)
        if primitive.colours is not None:
            attributes["COLOR_0"] = self._floats(primitive.colours)
        mesh = {
            "name": primitive.name,
            "primitives": [
                {
                    "attributes": attributes,
                    "indices": self._indices(primitive.faces),
                    "material": self._material(primitive.material, primitive.kind),
                    "mode": 4,
                }
            ],
        }
        self.document["meshes"].append(mesh)
        self.document["nodes"].append({"name": primitive.name, "mesh": len(self.document["meshes"]) - 1})
        self.document["scenes"][0]["nodes"].append(len(self.document["nodes"]) - 1)

    def glb(self) -> bytes:
        """The document as a binary glTF 2.0."""
        self.document["buffers"] = [{"byteLength": len(self.binary)}]
        if self.extensions:
            self.document["extensionsUsed"] = sorted(self.extensions)
            self.document["extensionsRequired"] = sorted(self.extensions & {WEBP_EXTENSION})
        document = {k: v for k, v in self.document.items() if v != []}
        return packed_glb(document, bytes(self.binary))

    def _view(self, content: bytes, target: int | None = None) -> int:
        self.binary += b"\0" * (-len(self.binary) % 4)
        view: Json = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        if target is not None:
            view["target"] = target
        self.binary += content
        self.document["bufferViews"].append(view)
        return len(self.document["bufferViews"]) - 1

    def _floats(self, rows: Floats, bounds: bool = False) -> int:
        values = np.ascontiguousarray(rows, dtype="<f4")
        accessor: Json = {
            "bufferView": self._view(values.tobytes(), ARRAY_BUFFER),
            "componentType": GLTF_FLOAT,
            "count": len(values),
            "type": f"VEC{values.shape[1]}" if values.shape[1] > 1 else "SCALAR",
        }
        if bounds:
            accessor |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        return self._accessor(accessor)

    def _indices(self, faces: Ints) -> int:
        small = int(faces.max()) < 65535
        values = np.ascontiguousarray(faces.reshape(-1), dtype="<u2" if small else "<u4")
        return self._accessor(
            {
                "bufferView": self._view(values.tobytes(), ELEMENT_ARRAY_BUFFER),
                "componentType": UNSIGNED_SHORT if small else UNSIGNED_INT,
                "count": len(values),
                "type": "SCALAR",
            }
        )

    def _accessor(self, accessor: Json) -> int:
        self.document["accessors"].append(accessor)
        return len(self.document["accessors"]) - 1

    def _material(self, material: Material | None, kind: str) -> int:
        raw: Json = copy.deepcopy(material.json) if material else {}
        if not raw:
            raw = {"pbrMetallicRoughness": {"baseColorFactor": DEFAULT_COLOURS[kind], "metallicFactor": 0.0}}
        for group, slot in SLOTS:
            holder = raw.get(group, {}) if group else raw
            if material and slot in holder:
                info = holder[slot]
                self.extensions.update(info.get("extensions", {}))
                info["index"] = self._texture(material, info["index"])
        self.extensions.update(raw.get("extensions", {}))
        if kind == "leaves":
            raw["doubleSided"] = True
        self.document["materials"].append(raw)
        return len(self.document["materials"]) - 1

    def _texture(self, material: Material, key: str) -> int:
        content, mime = material.images[key]
        if content not in self.images:
            self.document["images"].append({"bufferView": self._view(content), "mimeType": mime})
            self.images[content] = len(self.document["images"]) - 1
        self.document["samplers"].append(material.samplers.get(key, {}))
        source: Json = {"source": self.images[content]}
        if mime == WEBP_MIME:  # the extension has no plain fallback here, so the file requires it
            self.extensions.add(WEBP_EXTENSION)
            source = {"extensions": {WEBP_EXTENSION: source}}
        self.document["textures"].append(source | {"sampler": len(self.document["samplers"]) - 1})
        return len(self.document["textures"]) - 1


def vertex_normals(primitive: RenderPrimitive) -> Floats:
    """Area-weighted vertex normals (n, 3) of a primitive that has none."""
    corners = primitive.positions_m[primitive.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros_like(primitive.positions_m)
    for k in range(3):
        np.add.at(total, primitive.faces[:, k], normal)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 0, total / np.maximum(length, 1e-300), (0.0, 1.0, 0.0))
