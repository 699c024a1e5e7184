"""All pieces of a file as a GLB to choose from, with the piece of every vertex; left out ones too."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from galewood.formats import Material, RawPart, read_parts
from galewood.options import ImportRequest
from galewood.tree.importer import classify_content
from galewood.tree.pieces.classification import Classification
from galewood.tree.render_mesh import GlbWriter
from galewood.tree.types import RenderPrimitive
from galewood.util import Floats, Ints

CUT_OUT = 0.02  # parts of which less is cut out by alpha need no texture


def pieces_glb(data: bytes, filename: str, options: ImportRequest | None = None) -> bytes:
    """The pieces of the chosen tree and of no tree, y up, in the file's unit. Raises MeshError.

    One primitive per part. The vertex attribute `_PIECE` is a row of `extras.pieces` of the document: equally
    long lists of the part, the number within the part, and the kind. No vertex belongs to two pieces.
    """
    options = options or ImportRequest()
    content = read_parts(data, filename, options)
    parts, _, found = classify_content(content, options)
    rows, listed = _rows(found)
    writer = GlbWriter()
    for number, part in enumerate(parts):
        row_of_face = rows[found.pieces.of_face[number]]
        faces = np.flatnonzero(row_of_face >= 0)
        if len(faces):
            made, row_of_vertex = _separated(part, faces, row_of_face[faces])
            textured = bool((found.pieces.cut_out[found.pieces.part == number] > CUT_OUT).any())
            made = replace(made, name=f"part_{number}", **({} if textured else {"uv": None}))
            made = replace(made, material=_base_texture(made.material) if textured else None)
            writer.add(made, row_of_vertex)
    writer.document["extras"] = {"pieces": listed}
    return writer.glb()


@dataclass(frozen=True)
class DetectedFaces:
    """Faces of a tree and of what is left out: corners (k, 3, 3), y up, kinds (k,), which are uncertain."""

    corners: Floats
    kind: list[str]
    unsure: NDArray[np.bool_]


def detected_faces(data: bytes, filename: str, options: ImportRequest | None = None) -> DetectedFaces:
    """What was detected in a file, without its other trees. Raises MeshError."""
    options = options or ImportRequest()
    parts, _, found = classify_content(read_parts(data, filename, options), options)
    corners = np.concatenate([part.positions[part.faces] for part in parts])
    groups = [found.groups[g] for g in np.concatenate(found.group_of_face).tolist()]
    shown = np.array([group.tree in (0, found.tree) for group in groups])
    kept = [group for group in groups if group.tree in (0, found.tree)]
    unsure = np.array([not (group.sure or group.chosen) for group in kept], dtype=bool)
    return DetectedFaces(corners[shown], [group.kind for group in kept], unsure)


def _rows(found: Classification) -> tuple[Ints, dict[str, list[Any]]]:
    """The row of each piece, −1 for those of other trees, and the columns of the rows."""
    pieces = found.pieces
    kind = np.full(len(pieces), "other", dtype=object)
    shown = np.zeros(len(pieces), dtype=bool)
    for group in found.groups:
        kind[group.pieces] = group.kind
        shown[group.pieces] = group.tree in (0, found.tree)
    own = np.flatnonzero(shown)
    rows = np.full(len(pieces), -1, dtype=np.int32)
    rows[own] = np.arange(len(own))
    listed = {
        "part": pieces.part[own].tolist(),
        "number": pieces.number[own].tolist(),
        "kind": kind[own].tolist(),
    }
    return rows, listed


def _separated(part: RawPart, faces: Ints, row: Ints) -> tuple[RenderPrimitive, Ints]:
    """The faces with a vertex of its own for every piece at it, and the row of each vertex."""
    corner = part.faces[faces].astype(np.int64)
    key = row[:, None].astype(np.int64) * len(part.positions) + corner
    used, index = np.unique(key, return_inverse=True)
    vertex = used % len(part.positions)
    made = RenderPrimitive(
        "",
        "leaves",  # drawn from both sides
        part.positions[vertex],
        index.reshape(-1, 3).astype(np.int32),
        uv=None if part.uv is None else part.uv[vertex],
        material=part.material,
    )
    return made, (used // len(part.positions)).astype(np.int32)


def _base_texture(material: Material | None) -> Material | None:
    """The material with its base colour texture alone."""
    pbr = material.json.get("pbrMetallicRoughness", {}) if material else {}
    info = pbr.get("baseColorTexture")
    if material is None or info is None:
        return None
    key = info["index"]
    sampler = {key: material.samplers[key]} if key in material.samplers else {}
    json = {"pbrMetallicRoughness": {"baseColorTexture": info}}
    return Material(json, {key: material.images[key]}, sampler)
