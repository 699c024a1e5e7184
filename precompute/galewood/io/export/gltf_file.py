"""A render mesh opened for changes, with pygltflib: attributes, nodes, skins and animations are added."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from galewood.io.export.errors import ExportError
from galewood.table import Table
from galewood.util import Floats

if TYPE_CHECKING:
    import pygltflib

GLTF_FLOAT, UNSIGNED_BYTE, UNSIGNED_SHORT, UNSIGNED_INT = 5126, 5121, 5123, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
COMPONENTS = {"f": GLTF_FLOAT, "u1": UNSIGNED_BYTE, "u2": UNSIGNED_SHORT, "u4": UNSIGNED_INT}
KINDS = {GLTF_FLOAT: "<f4", UNSIGNED_BYTE: "u1", UNSIGNED_SHORT: "<u2", UNSIGNED_INT: "<u4"}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class GltfFile:
    """A GLB of a table's render mesh: one mesh per primitive of the table, in its order."""

    def __init__(self, glb: bytes, table: Table) -> None:
        """Raises ExportError for a file that is not a GLB, or not the mesh of the table."""
        self.gltf = _loaded(glb)
        self._binary = bytearray(self.gltf.binary_blob() or b"")
        self.counts = [int(primitive["vertices"]) for primitive in table.metadata["primitives"]]
        found = [self._vertices(mesh) for mesh in self.gltf.meshes]
        if found != self.counts:
            raise ExportError(
                "the vertices of the mesh differ from those of the table's mesh: use the GLB of its build"
            )

    def _vertices(self, mesh: pygltflib.Mesh) -> int:
        return int(self.gltf.accessors[given(mesh.primitives[0].attributes.POSITION)].count)

    def rest_m(self) -> Floats:
        """(v, 3) vertices of all meshes, one after another."""
        return np.concatenate(
            [self._rows(given(mesh.primitives[0].attributes.POSITION)) for mesh in self.gltf.meshes]
        ).astype(np.float64)

    def normals(self) -> Floats:
        """(v, 3) normals of all meshes."""
        return np.concatenate(
            [self._rows(given(mesh.primitives[0].attributes.NORMAL)) for mesh in self.gltf.meshes]
        ).astype(np.float64)

    def faces(self) -> list[npt.NDArray[np.int64]]:
        """(f, 3) triangles of each mesh."""
        used = [given(mesh.primitives[0].indices) for mesh in self.gltf.meshes]
        return [self._rows(index).astype(np.int64).reshape(-1, 3) for index in used]

    def _rows(self, index: int) -> npt.NDArray[Any]:
        """(n, k) the values of an accessor."""
        accessor = self.gltf.accessors[index]
        width = next(width for width, kind in TYPES.items() if kind == accessor.type)
        view = self.gltf.bufferViews[given(accessor.bufferView)]
        start = int(view.byteOffset or 0) + int(accessor.byteOffset or 0)
        kind, count = KINDS[accessor.componentType], width * int(accessor.count)
        return np.frombuffer(bytes(self._binary), kind, count, start).reshape(-1, width)

    def texture_coordinates(self) -> list[npt.NDArray[np.float32] | None]:
        """(v, 2) first texture coordinates of each mesh; None: it has none."""
        used = [mesh.primitives[0].attributes.TEXCOORD_0 for mesh in self.gltf.meshes]
        return [None if index is None else self._rows(index) for index in used]

    def image(self, index: int) -> tuple[bytes, str]:
        """The content and the media type of an image."""
        image = self.gltf.images[index]
        view = self.gltf.bufferViews[given(image.bufferView)]
        start = int(view.byteOffset or 0)
        return bytes(self._binary[start : start + view.byteLength]), str(image.mimeType)

    def add_attribute(self, name: str, rows: npt.NDArray[Any]) -> None:
        """Add a vertex attribute: rows (v, k) of all meshes, one after another, float32, uint8 or uint16."""
        for mesh, part in zip(self.gltf.meshes, np.split(rows, np.cumsum(self.counts)[:-1]), strict=True):
            setattr(mesh.primitives[0].attributes, name, self.add_rows(part, target=ARRAY_BUFFER))

    def add_second_coordinates(self, rows: npt.NDArray[np.float32]) -> None:
        """Add TEXCOORD_1 (v, 2); a mesh without TEXCOORD_0 gets zeros there, as sets must not be skipped."""
        for mesh, count in zip(self.gltf.meshes, self.counts, strict=True):
            attributes = mesh.primitives[0].attributes
            if attributes.TEXCOORD_0 is None:
                attributes.TEXCOORD_0 = self.add_rows(np.zeros((count, 2), np.float32), target=ARRAY_BUFFER)
        self.add_attribute("TEXCOORD_1", rows)

    def add_rows(self, rows: npt.NDArray[Any], *, bounds: bool = False, target: int | None = None) -> int:
        """Add an accessor of rows (n, k) or (n,) and return its index; ``bounds``: with its range."""
        import pygltflib

        wide = rows.reshape(len(rows), -1)
        kind = "f" if wide.dtype.kind == "f" else f"u{wide.dtype.itemsize}"
        values = np.ascontiguousarray(wide, "<f4" if kind == "f" else f"<{kind}")
        self._binary += b"\0" * (-len(self._binary) % 4)
        view = pygltflib.BufferView(
            buffer=0, byteOffset=len(self._binary), byteLength=values.nbytes, target=target
        )
        self._binary += values.tobytes()
        self.gltf.bufferViews.append(view)
        accessor = pygltflib.Accessor(
            bufferView=len(self.gltf.bufferViews) - 1,
            componentType=COMPONENTS[kind],
            count=len(values),
            type=TYPES[values.shape[1]],
        )
        if bounds:
            accessor.min, accessor.max = values.min(axis=0).tolist(), values.max(axis=0).tolist()
        self.gltf.accessors.append(accessor)
        return len(self.gltf.accessors) - 1

    def keep(self, part: int, kept: npt.NDArray[np.bool_], rest_m: Floats) -> None:
        """Leave out the other vertices of a mesh with their triangles, and move the kept ones.

        Args:
            part: Number of the mesh.
            kept: (v,) its vertices to keep; whole triangles are kept.
            rest_m: (v, 3) where they are then.
        """
        primitive, faces = self.gltf.meshes[part].primitives[0], self.faces()[part]
        used = {name: index for name, index in vars(primitive.attributes).items() if isinstance(index, int)}
        for name, index in used.items():
            rows = rest_m.astype(np.float32) if name == "POSITION" else self._rows(index)
            found = self.add_rows(rows[kept], bounds=name == "POSITION", target=ARRAY_BUFFER)
            self.gltf.accessors[found].normalized = self.gltf.accessors[index].normalized
            setattr(primitive.attributes, name, found)
        number = np.cumsum(kept) - 1
        corners = number[faces[kept[faces].all(axis=1)]].ravel()
        small = np.uint16 if kept.sum() < 65535 else np.uint32
        primitive.indices = self.add_rows(corners.astype(small), target=ELEMENT_ARRAY_BUFFER)
        self.counts[part] = int(kept.sum())

    def drop_unused(self) -> None:
        """Write the binary part again with what meshes, skins, animations and pictures use."""
        gltf, before, views = self.gltf, bytes(self._binary), list(self.gltf.bufferViews)
        accessors = list(gltf.accessors)
        self._binary, gltf.bufferViews, gltf.accessors = bytearray(), [], []
        moved, placed = dict[int, int](), dict[int, int]()

        def view_of(index: int) -> int:
            if index not in placed:
                view = views[index]
                start = int(view.byteOffset or 0)
                self._binary += b"\0" * (-len(self._binary) % 4)
                view.byteOffset = len(self._binary)
                self._binary += before[start : start + view.byteLength]
                placed[index] = len(gltf.bufferViews)
                gltf.bufferViews.append(view)
            return placed[index]

        def accessor_of(index: int) -> int:
            if index not in moved:
                accessor = accessors[index]
                accessor.bufferView = view_of(given(accessor.bufferView))
                moved[index] = len(gltf.accessors)
                gltf.accessors.append(accessor)
            return moved[index]

        for mesh in gltf.meshes:
            primitive = mesh.primitives[0]
            for name, index in vars(primitive.attributes).items():
                if isinstance(index, int):
                    setattr(primitive.attributes, name, accessor_of(index))
            primitive.indices = accessor_of(given(primitive.indices))
        for skin in gltf.skins:
            skin.inverseBindMatrices = accessor_of(given(skin.inverseBindMatrices))
        for sampler in (one for animation in gltf.animations for one in animation.samplers):
            sampler.input, sampler.output = accessor_of(sampler.input), accessor_of(sampler.output)
        for image in gltf.images:
            image.bufferView = view_of(given(image.bufferView))

    def note(self, name: str, about: dict[str, Any]) -> None:
        """Store a description in the extras of the scene."""
        scene = self.gltf.scenes[self.gltf.scene or 0]
        scene.extras = {**(scene.extras or {}), name: about}

    def extend(
        self, name: str, about: dict[str, Any], of_nodes: Mapping[int, dict[str, Any]] | None = None
    ) -> None:
        """Add an extension that programs need not know: to the asset, and to nodes by their indices."""
        self.gltf.extensionsUsed = [*(self.gltf.extensionsUsed or []), name]
        self.gltf.extensions = {**(self.gltf.extensions or {}), name: about}
        for index, of_node in (of_nodes or {}).items():
            node = self.gltf.nodes[index]
            node.extensions = {**(node.extensions or {}), name: of_node}

    def glb(self) -> bytes:
        """The file's bytes."""
        self.gltf.buffers[0].byteLength = len(self._binary)
        self.gltf.set_binary_blob(bytes(self._binary))
        return b"".join(self.gltf.save_to_bytes())


def given(index: int | None) -> int:
    """An index that the render meshes of builds always have. Raises ExportError without it."""
    if index is None:
        raise ExportError("the mesh lacks positions, normals, triangles or images: use the GLB of its build")
    return index


def _loaded(glb: bytes) -> pygltflib.GLTF2:
    import pygltflib

    document = None
    if len(glb) >= 20 and glb[:4] == b"glTF":
        try:
            document = pygltflib.GLTF2.load_from_bytes(glb)
        except (ValueError, KeyError, TypeError, IndexError, AttributeError, struct.error):
            raise ExportError("the mesh file is damaged: its glTF document cannot be read") from None
    if document is None:
        raise ExportError("the mesh is not a GLB file")
    return document
