"""One primitive of a glTF mesh: vertices with default morph weights, triangles, colours, material."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from galewood.formats.gltf.document import COMPONENTS, GltfDocument, as_floats, broken
from galewood.formats.gltf.draco import EXTENSION_NAME as DRACO
from galewood.formats.gltf.draco import DracoPrimitive
from galewood.formats.gltf.material import natural, read_material
from galewood.formats.gltf.scene import Placed
from galewood.formats.gltf.uv import UvChoice, choose_uv
from galewood.formats.types import Material
from galewood.util import Floats, Ints

Json = dict[str, Any]
TRIANGLE_LIST, TRIANGLE_STRIP, TRIANGLE_FAN = 4, 5, 6
SPARE_VERTICES = 2  # vertices per used one beyond which the unused are removed: some files share one buffer
Rows = Callable[[str], NDArray[Any] | None]


@dataclass(frozen=True)
class Influences:
    """Joints (n, k) of a skin, and their weights (n, k), which add up to 1."""

    joints: NDArray[np.int64]
    weights: Floats


@dataclass(frozen=True)
class Primitive:
    """Vertices (n, …) and triangles (m, 3) in the coordinates of the mesh."""

    labels: tuple[str, ...]
    positions: Floats
    faces: Ints
    normals: Floats | None
    uv: Floats | None
    colours: Floats | None
    influences: Influences | None
    material: Material


class PrimitiveReader:
    """Reads primitives of a document; materials are read once."""

    def __init__(self, document: GltfDocument) -> None:
        self._document = document
        self._materials: dict[int | None, tuple[Material, UvChoice]] = {}

    def read(self, raw: Json, placed: Placed, copies: int) -> Primitive:
        """The primitive, which will be drawn `copies` times: the limits hold for all copies together."""
        document = self._document
        packed = DracoPrimitive(document, raw) if DRACO in raw.get("extensions", {}) else None
        count = len(packed.faces) if packed else _triangle_count(document, raw)
        document.budget.add_faces(count * copies)
        rows = self._rows(raw, packed)
        positions = rows("POSITION")
        if positions is None or positions.shape[1] != 3:
            raise broken("gltf-structure", "A primitive has no positions.")
        faces = packed.faces if packed else self._faces(raw, len(positions))
        if faces.size and int(faces.max()) >= len(positions):
            raise broken(
                "index-out-of-range",
                f"A face refers to vertex {faces.max()}, but there are only {len(positions)}.",
            )
        kept = _kept(faces, len(positions))
        document.budget.add_vertices((len(positions) if kept is None else len(kept)) * copies)
        material, choice = self._material(raw.get("material"))
        weights = placed.node.get("weights", placed.mesh.get("weights", []))
        uv = rows(f"TEXCOORD_{choice.texture_set}")
        found = Primitive(
            labels=(() if not material.json.get("name") else (str(material.json["name"]),)) + placed.names,
            positions=self._morphed(positions, "POSITION", raw, weights),
            faces=faces,
            normals=self._morphed(rows("NORMAL"), "NORMAL", raw, weights),
            uv=None if uv is None else choice.applied(uv),
            colours=rows("COLOR_0"),
            influences=_influences(rows) if "skin" in placed.node else None,
            material=material,
        )
        return found if kept is None else _restricted(found, kept)

    def _rows(self, raw: Json, packed: DracoPrimitive | None) -> Callable[[str], Floats | None]:
        attributes, document = raw["attributes"], self._document

        def rows(name: str) -> Floats | None:
            if name not in attributes:
                return None
            decoded = packed.attribute(name) if packed else None
            if decoded is None:
                return document.floats(attributes[name])
            accessor = document.json["accessors"][natural(attributes[name])]
            if decoded.dtype.kind in "iu":  # the decoder widens integers
                decoded = decoded.astype(COMPONENTS[accessor["componentType"]])
            return as_floats(decoded, accessor)

        return rows

    def _faces(self, raw: Json, count: int) -> Ints:
        if "indices" in raw:
            indices = self._document.accessor(raw["indices"])[:, 0].astype(np.int64)
        else:
            indices = np.arange(count, dtype=np.int64)
        return _triangles(indices, raw.get("mode", TRIANGLE_LIST))

    def _material(self, index: int | None) -> tuple[Material, UvChoice]:
        if index not in self._materials:
            document = self._document
            raw = {} if index is None else document.json["materials"][natural(index)]
            material = read_material(document.json, raw, document.image)
            self._materials[index] = (material, choose_uv(material, document.source))
        return self._materials[index]

    def _morphed(self, rows: Any, name: str, raw: Json, weights: list[float]) -> Any:
        """Rows with the morph targets of the given default weights added (specification, section 3.7.2.2)."""
        if rows is None:
            return None
        for target, weight in zip(raw.get("targets", []), weights, strict=False):
            if float(weight) == 0.0 or name not in target:
                continue
            change = self._document.floats(target[name])
            if change is None or change.shape != rows.shape:
                raise broken(
                    "gltf-structure", "A morph target and its mesh differ in their number of vertices."
                )
            rows = rows + float(weight) * change
        return rows


def _triangle_count(document: GltfDocument, raw: Json) -> int:
    source = raw["indices"] if "indices" in raw else raw["attributes"]["POSITION"]
    corners = natural(document.json["accessors"][natural(source)]["count"])
    return corners // 3 if raw.get("mode", TRIANGLE_LIST) == TRIANGLE_LIST else max(corners - 2, 0)


def _triangles(indices: NDArray[np.int64], mode: int) -> Ints:
    if mode == TRIANGLE_LIST:
        return indices[: len(indices) // 3 * 3].reshape(-1, 3).astype(np.int32)
    i = np.arange(max(len(indices) - 2, 0))
    if mode == TRIANGLE_FAN:
        return np.column_stack(
            [np.broadcast_to(indices[:1], i.shape), indices[i + 1], indices[i + 2]]
        ).astype(np.int32)
    odd = i % 2
    return np.column_stack([indices[i], indices[i + 1 + odd], indices[i + 2 - odd]]).astype(np.int32)


def _kept(faces: Ints, count: int) -> NDArray[np.int64] | None:
    """The used vertices, if many others are not used; None: keep all."""
    if count <= SPARE_VERTICES * max(faces.size, 1):
        return None
    return np.unique(faces).astype(np.int64)


def _restricted(found: Primitive, kept: NDArray[np.int64]) -> Primitive:
    def pick(rows: Floats | None) -> Floats | None:
        return None if rows is None else rows[kept]

    influences = found.influences
    return Primitive(
        labels=found.labels,
        positions=found.positions[kept],
        faces=np.searchsorted(kept, found.faces).astype(np.int32),
        normals=pick(found.normals),
        uv=pick(found.uv),
        colours=pick(found.colours),
        influences=influences and Influences(influences.joints[kept], influences.weights[kept]),
        material=found.material,
    )


def _influences(rows: Rows) -> Influences | None:
    """All joints and weights of the vertices; the weights are normalised."""
    joints: list[NDArray[Any]] = []
    weights: list[NDArray[Any]] = []
    while True:
        joint, weight = rows(f"JOINTS_{len(joints)}"), rows(f"WEIGHTS_{len(joints)}")
        if joint is None or weight is None:
            break
        joints.append(joint)
        weights.append(weight)
    if not joints:
        return None
    weight = np.maximum(np.concatenate(weights, axis=1), 0.0)
    total = weight.sum(axis=1, keepdims=True)
    weight = np.where(total > 0, weight / np.where(total > 0, total, 1.0), 0.0)
    weight[total[:, 0] <= 0, 0] = 1.0  # a vertex without weights follows its first joint
    return Influences(np.concatenate(joints, axis=1).astype(np.int64), weight)
