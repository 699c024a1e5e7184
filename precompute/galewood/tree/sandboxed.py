"""Mesh import in a child process: whatever an upload does to the reader, the caller gets a tree or a
MeshError.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from galewood.formats import MAX_BYTES, pack_material, unpack_material
from galewood.options import ImportRequest
from galewood.sandbox import Arrays, Limits, from_json_array, run_limited, to_bytes_array, to_json_array
from galewood.tree.importer import read_tree, render_glb
from galewood.tree.piece_mesh import pieces_glb
from galewood.tree.types import RenderPrimitive, TreeMesh
from galewood.util import MeshError

IMPORT_LIMITS = Limits(memory_bytes=3 << 30, cpu_s=120)  # the largest mesh as an OBJ takes a third of both
OPTIONAL_ROWS = ("normals", "uv", "colours")


def import_mesh_sandboxed(
    data: bytes,
    filename: str,
    options: ImportRequest | None = None,
    limits: Limits | None = None,
    then: str | None = None,
) -> tuple[TreeMesh, bytes]:
    """Run read_tree and render_glb in a child process; returns the tree and its render GLB.

    ``then`` is the name ("module:function") of a function that the child calls with the tree, and whose tree
    it returns instead: it adds to the report what would take too long in this process.

    Raises MeshError, also if the child exceeds its time or memory, is killed or crashes.
    """
    if len(data) > MAX_BYTES:  # rejected without starting a process
        raise MeshError(
            "file-too-large",
            "too-large",
            f"The file is larger than {MAX_BYTES >> 20} MB.",
            "Reduce the number of faces.",
        )
    request = {"filename": filename, "options": _as_json(options), "then": then}
    result = run_limited(
        "galewood.tree.sandboxed:read_in_child",
        {"data": to_bytes_array(data), "request": to_json_array(request)},
        limits or IMPORT_LIMITS,
        what="Reading the mesh",
    )
    return unpack_tree(result), result["glb"].tobytes()


def read_in_child(arguments: Arrays) -> Arrays:
    """The part of import_mesh_sandboxed that runs in the child."""
    request = from_json_array(arguments["request"])
    options = ImportRequest.model_validate(request["options"])
    tree = read_tree(arguments["data"].tobytes(), request["filename"], options)
    glb = render_glb(tree)
    if then := request.get("then"):
        module, name = then.split(":")
        tree = getattr(import_module(module), name)(tree)
    return pack_tree(tree) | {"glb": to_bytes_array(glb)}


def pieces_sandboxed(
    data: bytes, filename: str, options: ImportRequest | None = None, limits: Limits | None = None
) -> bytes:
    """Run pieces_glb in a child process: all pieces of a file that was imported before. Raises MeshError."""
    request = {"filename": filename, "options": _as_json(options)}
    result = run_limited(
        "galewood.tree.sandboxed:pieces_in_child",
        {"data": to_bytes_array(data), "request": to_json_array(request)},
        limits or IMPORT_LIMITS,
        what="Reading the mesh",
    )
    return result["glb"].tobytes()


def pieces_in_child(arguments: Arrays) -> Arrays:
    """The part of pieces_sandboxed that runs in the child."""
    request = from_json_array(arguments["request"])
    options = ImportRequest.model_validate(request["options"])
    return {"glb": to_bytes_array(pieces_glb(arguments["data"].tobytes(), request["filename"], options))}


def _as_json(options: ImportRequest | None) -> dict[str, Any]:
    """The options of the import, also of a request that has further ones."""
    return options.model_dump(include=set(ImportRequest.model_fields), exclude_none=True) if options else {}


def pack_tree(tree: TreeMesh) -> Arrays:
    """Serialise a tree, including its materials, to plain arrays."""
    arrays: Arrays = {"wood_vertices_m": tree.wood_vertices_m, "wood_faces": tree.wood_faces}
    heads: list[dict[str, Any]] = []
    for i, primitive in enumerate(tree.primitives):
        arrays[f"positions_{i}"], arrays[f"faces_{i}"] = primitive.positions_m, primitive.faces
        for name in OPTIONAL_ROWS:
            rows = getattr(primitive, name)
            if rows is not None:
                arrays[f"{name}_{i}"] = rows
        material, images = pack_material(primitive.material)
        for key, content in images.items():
            arrays[f"image_{i}_{key}"] = to_bytes_array(content)
        heads.append({"name": primitive.name, "kind": primitive.kind, "material": material})
    head = {
        "primitives": heads,
        "height_m": tree.height_m,
        "species": tree.species,
        "report": tree.report,
        "added_faces": tree.added_faces,
    }
    return arrays | {"head": to_json_array(head)}


def unpack_tree(arrays: Arrays) -> TreeMesh:
    """Inverse of pack_tree."""
    head = from_json_array(arrays["head"])
    primitives = [_primitive(arrays, i, h) for i, h in enumerate(head["primitives"])]
    return TreeMesh(
        primitives,
        arrays["wood_vertices_m"],
        arrays["wood_faces"],
        head["height_m"],
        head["species"],
        head["report"],
        head["added_faces"],
    )


def _primitive(arrays: Arrays, i: int, head: dict[str, Any]) -> RenderPrimitive:
    prefix = f"image_{i}_"
    images = {key[len(prefix) :]: rows.tobytes() for key, rows in arrays.items() if key.startswith(prefix)}
    extras = {name: arrays.get(f"{name}_{i}") for name in OPTIONAL_ROWS}
    material = unpack_material(head["material"], images)
    return RenderPrimitive(
        head["name"],
        head["kind"],
        arrays[f"positions_{i}"],
        arrays[f"faces_{i}"],
        material=material,
        **extras,
    )
