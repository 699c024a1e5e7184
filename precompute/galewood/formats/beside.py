"""A mesh on this computer with the files beside it, as the one file that mesh import reads.

Used by the command line and the Python API, never for uploads. Only files in the folder of the mesh, or below
it, are taken.
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from galewood.formats.companions import base_name, local_name
from galewood.formats.gltf.reading import parsed_json
from galewood.formats.limits import MAX_BYTES
from galewood.util import MeshError

LONG_AGO = (1980, 1, 1, 0, 0, 0)  # equal files give equal archives, so results are found in caches
LIBRARY_PATTERN = re.compile(rb"^[ \t]*mtllib[ \t]+(.+?)[ \t\r]*$", re.MULTILINE)
# names of images occur in FBX, DAE, 3DS and MTL files as plain text, with or without folders
IMAGE_PATTERN = re.compile(
    rb"[^\\/\x00-\x1f\"<>:|*?]{1,120}\.(?:png|jpe?g|webp|tga|bmp|tiff?|ktx2|dds)", re.IGNORECASE
)
IMAGE_FOLDERS = ("", "textures", "Textures", "texture", "images", "maps")
MAX_FILES = 500


def mesh_with_companions(path: Path) -> bytes:
    """The bytes of a mesh file; if files beside it belong to it, a ZIP archive of all. OSError."""
    data = path.read_bytes()
    suffix = path.suffix.lower()
    if suffix not in FINDERS:
        return data
    folder = path.resolve().parent
    files: dict[str, Path] = {}
    for name in FINDERS[suffix](data, folder):
        found = _inside(folder, name)
        if found is not None and found != path.resolve() and len(files) < MAX_FILES:
            files[name] = found
    if not files or sum(file.stat().st_size for file in files.values()) > MAX_BYTES:
        return data
    return _archive({path.name: data} | {name: file.read_bytes() for name, file in sorted(files.items())})


def _inside(folder: Path, name: str) -> Path | None:
    """The file of a relative name, unless it is outside the folder, also through links."""
    local = local_name(name)
    if local is None:
        return None
    try:
        found = (folder / local).resolve()
        return found if found.is_relative_to(folder) and found.is_file() else None
    except (OSError, ValueError):
        return None


def _of_gltf(data: bytes, folder: Path) -> Iterator[str]:
    try:
        document = parsed_json(data)
    except MeshError:
        return
    for key in ("buffers", "images"):
        listed: Any = document.get(key)
        for entry in listed if isinstance(listed, list) else []:
            uri = entry.get("uri") if isinstance(entry, dict) else None
            local = local_name(uri) if isinstance(uri, str) else None
            if local is not None:
                yield local


def _of_glb(data: bytes, folder: Path) -> Iterator[str]:
    """Files that the document of a GLB names, which is its first chunk (glTF 2.0, section 4.4)."""
    return _of_gltf(data[20 : 20 + int.from_bytes(data[12:16], "little")], folder)


def _of_obj(data: bytes, folder: Path) -> Iterator[str]:
    for match in LIBRARY_PATTERN.finditer(data):
        name = match[1].decode("utf-8", errors="replace")
        library = _inside(folder, name)
        if library is None:
            continue
        yield local_name(name) or name
        yield from _images_named(library.read_bytes(), folder)


def _images_named(data: bytes, folder: Path) -> Iterator[str]:
    """Images whose names occur in a file and that lie in its folder, or in one for textures."""
    present = {
        base_name(file.name): f"{inner}/{file.name}".lstrip("/")
        for inner in reversed(IMAGE_FOLDERS)
        if (folder / inner).is_dir()
        for file in sorted((folder / inner).iterdir())[: 10 * MAX_FILES]
    }
    text = {
        match[0].decode("utf-8", errors="replace").strip().lower() for match in IMAGE_PATTERN.finditer(data)
    }
    for name, relative in present.items():
        if any(word == name or word.endswith(" " + name) for word in text):
            yield relative


def _archive(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as packed:
        for name, content in files.items():
            packed.writestr(zipfile.ZipInfo(name, LONG_AGO), content)
    return stream.getvalue()


FINDERS = {
    ".gltf": _of_gltf, ".glb": _of_glb, ".obj": _of_obj,
    ".fbx": _images_named, ".dae": _images_named, ".3ds": _images_named,
}  # fmt: skip
