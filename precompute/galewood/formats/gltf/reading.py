"""glTF 2.0 reader that works on bytes only; other files come from the uploaded archive or not at all.

Compressed (Draco, meshopt) and quantised data are decoded, skins and morph targets are applied as the file
draws them at rest, instances are expanded. Whatever is not used is reported. Source: glTF 2.0 specification,
sections 3.7 (meshes) and 4 (GLB).
"""

from __future__ import annotations

import json
import struct
from typing import Any

from galewood.formats.companions import Source
from galewood.formats.gltf.document import GltfDocument, broken
from galewood.formats.gltf.extensions import check_required, warn_of_unused
from galewood.formats.gltf.instancing import instance_matrices
from galewood.formats.gltf.placement import moved_as_a_whole, moved_by_vertex
from galewood.formats.gltf.primitive import (
    TRIANGLE_FAN,
    TRIANGLE_LIST,
    TRIANGLE_STRIP,
    PrimitiveReader,
)
from galewood.formats.gltf.scene import placed_meshes
from galewood.formats.gltf.schema import checked_document
from galewood.formats.gltf.skins import Skins
from galewood.formats.types import RawPart

Json = dict[str, Any]
GLB_HEADER_BYTES = 12
CHUNK_JSON, CHUNK_BIN = 0x4E4F534A, 0x004E4942


def read_glb(data: bytes, source: Source | None = None) -> list[RawPart]:
    """Parts of a binary glTF with node transforms applied (+Y up, file units). Raises MeshError."""
    if len(data) < GLB_HEADER_BYTES + 8:
        raise broken("truncated", "The GLB header is incomplete.")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise broken("gltf-version", f"The file has glTF version {version}; only version 2 is supported.")
    if length > len(data):
        raise broken("truncated", f"The GLB declares {length} bytes but has only {len(data)}.")
    document, binary = _chunks(data[:length])
    return _parts(document, binary, source or Source())


def read_gltf(data: bytes, source: Source | None = None) -> list[RawPart]:
    """Parts of a .gltf file, whose buffers are data URIs or companions of the file. Raises MeshError."""
    return _parts(parsed_json(data), None, source or Source())


def _without_nulls(pairs: list[tuple[str, Any]]) -> Json:
    """A JSON object without the fields that are null, which some exporters write for missing ones."""
    return {name: value for name, value in pairs if value is not None}


def parsed_json(data: bytes) -> Json:
    """The JSON object of a glTF; MeshError if it cannot be parsed."""
    try:
        # the hook takes time and memory for each object
        document = json.loads(data, object_pairs_hook=_without_nulls if b"null" in data else None)
    except (ValueError, RecursionError) as error:
        raise broken("gltf-json", "The JSON of the glTF cannot be parsed.") from error
    if not isinstance(document, dict):
        raise broken("gltf-json", "The JSON of the glTF is not an object.")
    return document


def _chunks(data: bytes) -> tuple[Json, bytes | None]:
    document: Json | None = None
    binary: bytes | None = None
    offset = GLB_HEADER_BYTES
    while offset + 8 <= len(data):
        size, kind = struct.unpack_from("<II", data, offset)
        body = data[offset + 8 : offset + 8 + size]
        if len(body) != size:
            raise broken("truncated", "A GLB chunk extends beyond the end of the file.")
        if document is None and kind == CHUNK_JSON:
            document = parsed_json(body)
        elif binary is None and kind == CHUNK_BIN:
            binary = body
        offset += 8 + size
    if document is None:
        raise broken("gltf-structure", "The GLB has no JSON chunk.")
    return document, binary


def _parts(raw: Json, binary: bytes | None, source: Source) -> list[RawPart]:
    document = checked_document(raw)
    try:
        check_required(document)
        warn_of_unused(document, source)
        return _scene_parts(GltfDocument(document, binary, source))
    except (KeyError, IndexError) as error:
        raise broken(
            "gltf-structure", f"The glTF refers to an element that does not exist: {error}."
        ) from error


def _scene_parts(document: GltfDocument) -> list[RawPart]:
    """Every triangle primitive of the default scene, at its place or places."""
    reader, skins = PrimitiveReader(document), Skins(document)
    found: list[RawPart] = []
    for placed in placed_meshes(document.json):
        for raw in placed.mesh.get("primitives", []):
            if raw.get("mode", TRIANGLE_LIST) not in (TRIANGLE_LIST, TRIANGLE_STRIP, TRIANGLE_FAN):
                document.source.warn("Points and lines in the file are not used.")
                continue
            matrices = instance_matrices(document, placed)
            primitive = reader.read(raw, placed, len(matrices))
            if "skin" in placed.node and primitive.influences is not None:
                at_rest = skins.vertex_matrices(placed.node["skin"], primitive.influences)
                found.append(moved_by_vertex(primitive, at_rest))
            else:
                found.append(moved_as_a_whole(primitive, matrices))
    return found
