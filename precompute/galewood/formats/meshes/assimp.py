"""FBX, COLLADA (DAE) and 3DS files, read by assimp_py, a binding of the Open Asset Import Library.

Files whose objects are nested too deep, or in a circle, are refused first: the library follows them by
recursion, so that its stack overflows and the process dies. It reads from a file, so the bytes are written to
the temporary folder, which in the sandbox is the only folder it can write to. It places all meshes in the
scene and turns the file's axes to +Y up.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from galewood.formats.colours import linear_from_srgb, painted
from galewood.formats.companions import Source, base_name
from galewood.formats.limits import Budget
from galewood.formats.meshes.collada_nesting import problem_of_collada
from galewood.formats.meshes.fbx_nesting import problem_of_fbx
from galewood.formats.textures import cut_out_by_alpha, drawable
from galewood.formats.types import Material, RawPart
from galewood.util import Floats, MeshError, shown_text

Json = dict[str, Any]
NAMES = {"fbx": "FBX", "dae": "COLLADA", "3ds": "3DS"}
EMBEDDED_PREFIX = "*"  # names of textures inside the file begin with it
TRACK_CHUNK = b"\x02\xb0"  # of the chunk that may attach a 3DS object to another; rare in other data
MAX_TRACKS = 4_000


def reader_of(suffix: str) -> Callable[[bytes, Source], list[RawPart]]:
    """The reader of the format with the given suffix ("fbx", "dae" or "3ds")."""

    def read(data: bytes, source: Source) -> list[RawPart]:
        _check_nesting(data, suffix)
        scene = _loaded(data, suffix)
        budget = Budget()
        materials = [_material(raw, source) for raw in scene.materials]
        parts: list[RawPart] = []
        for mesh in scene.meshes:
            budget.add_faces(int(mesh.num_faces))
            budget.add_vertices(int(mesh.num_vertices))
            parts.append(_part(mesh, materials))
        return parts

    return read


def _check_nesting(data: bytes, suffix: str) -> None:
    """MeshError if the library would not survive the nesting of a file."""
    try:
        problem = PROBLEMS[suffix](data)
    except ValueError as error:
        raise _unreadable(suffix) from error
    if problem:
        raise MeshError(
            "nested-too-deep",
            "unsuitable",
            f"The objects of the {NAMES[suffix]} file {problem}.",
            "Apply the transforms, join the objects and export a single mesh.",
        )


def _problem_of_3ds(data: bytes) -> str | None:
    return (
        f"have more than {MAX_TRACKS} places in its hierarchy"
        if data.count(TRACK_CHUNK) > MAX_TRACKS
        else None
    )


def _unreadable(suffix: str) -> MeshError:
    return MeshError(
        "unreadable",
        "malformed",
        f"The {NAMES[suffix]} file cannot be read.",
        "Open it in Blender or another modelling program and export it as GLB (glTF Binary).",
    )


PROBLEMS: dict[str, Callable[[bytes], str | None]] = {
    "fbx": problem_of_fbx,
    "dae": problem_of_collada,
    "3ds": _problem_of_3ds,
}
"""What the library would not survive: the end of a sentence, or None. ValueError if the file is damaged."""


def _loaded(data: bytes, suffix: str) -> Any:
    import assimp_py  # only these formats need it

    steps = (
        assimp_py.Process_Triangulate
        | assimp_py.Process_PreTransformVertices
        | assimp_py.Process_JoinIdenticalVertices
        | assimp_py.Process_SortByPType
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"mesh.{suffix}")
        path.write_bytes(data)
        try:
            return assimp_py.import_file(str(path), steps)
        except MemoryError:
            raise
        except Exception as error:
            raise _unreadable(suffix) from error


def _part(mesh: Any, materials: list[Material]) -> RawPart:
    material = materials[mesh.material_index] if mesh.material_index < len(materials) else Material()
    colours = [
        np.asarray(rows, dtype=np.float64).reshape(mesh.num_vertices, -1) for rows in mesh.colors or []
    ]
    names = (material.json.get("name", ""), shown_text(str(mesh.name)))
    return RawPart(
        labels=tuple(dict.fromkeys(name for name in names if name)),
        positions=np.array(mesh.vertices, dtype=np.float64).reshape(-1, 3),
        faces=np.array(mesh.indices, dtype=np.int32).reshape(-1, 3),
        normals=_rows(mesh.normals, mesh.num_vertices),
        uv=_uv(mesh),
        colours=linear_from_srgb(colours[0]) if colours else None,
        material=material if material.json else painted() if colours else None,
    )


def _rows(values: Any, count: int) -> Floats | None:
    if values is None or not len(values):
        return None
    return np.array(values, dtype=np.float64).reshape(count, -1)


def _uv(mesh: Any) -> Floats | None:
    uv = _rows(mesh.texcoords[0], mesh.num_vertices) if mesh.texcoords else None
    return None if uv is None else np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])


def _material(raw: Json, source: Source) -> Material:
    name = shown_text(str(raw.get("NAME", "")))
    colour = np.array(raw.get("COLOR_DIFFUSE", (1.0, 1.0, 1.0)), dtype=np.float64)[:3]
    pbr: Json = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
    pbr["baseColorFactor"] = [*linear_from_srgb(colour).tolist(), 1.0]
    found = Material({"name": name, "pbrMetallicRoughness": pbr})
    for kind, files in raw.get("TEXTURES", {}).items():
        for file in files if isinstance(files, (list, tuple)) else [files]:
            _take_texture(found, int(kind) == _diffuse(), str(file), source)
    return found


def _diffuse() -> int:
    import assimp_py

    return int(assimp_py.TextureType_DIFFUSE)


def _take_texture(material: Material, is_diffuse: bool, file: str, source: Source) -> None:
    """Use the first diffuse texture that can be read as the base colour; it replaces the plain colour."""
    pbr = material.json["pbrMetallicRoughness"]
    if not is_diffuse or "baseColorTexture" in pbr:
        return
    content = None if file.startswith(EMBEDDED_PREFIX) else source.files.find(file)
    if content is None:
        where = "is inside the FBX file" if file.startswith(EMBEDDED_PREFIX) else "is in another file"
        source.warn(
            f"The texture {base_name(file)[:80]!r} {where} and is not drawn. Export the model as GLB, or "
            "upload a ZIP archive of it with its textures."
        )
        return
    image = drawable(content, base_name(file)[:80], source)
    if image is not None:
        material.images["base"] = image
        pbr |= {"baseColorTexture": {"index": "base"}, "baseColorFactor": [1.0, 1.0, 1.0, 1.0]}
        cut_out_by_alpha(material, "base")
