"""File format detection by content, and reading of the parts.

File names in the data are never opened: other files are only found in an uploaded archive.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Any

from galewood.formats import qsm
from galewood.formats.archive import Archive, ArchiveFolder, model_in
from galewood.formats.companions import Source
from galewood.formats.foreign import ACCEPTED_HINT, refuse_foreign, refuse_points
from galewood.formats.gltf.reading import read_glb, read_gltf
from galewood.formats.limits import MAX_BYTES
from galewood.formats.meshes.assimp import reader_of
from galewood.formats.meshes.obj import read_obj
from galewood.formats.meshes.ply import read_ply
from galewood.formats.meshes.stl import is_binary_stl, read_stl
from galewood.formats.types import RawPart
from galewood.options import ImportRequest
from galewood.util import MeshError

ZIP_HEADER = b"PK\x03\x04"
EMPTY_ZIP = b"PK\x05\x06"
FBX_HEADERS = (b"Kaydara FBX", b"; FBX")
THREE_DS = b"MM"
NAMES = {"gltf": "glTF", "treeqsm": "a MATLAB file", "csv": "a table of cylinders"}


@dataclass(frozen=True)
class FileContent:
    """The name of a file's format and its parts; of a scanned tree also a report; warnings."""

    file_format: str
    parts: list[RawPart]
    qsm: dict[str, Any] | None = None
    warnings: list[str] = field(default_factory=list[str])


def read_parts(data: bytes, filename: str, options: ImportRequest) -> FileContent:
    """The format and the parts of a file, or of the only model in a ZIP archive.

    Raises MeshError with reason "malformed", "too-large", "unsuitable" or "unsupported".
    """
    if not data.strip():
        raise MeshError("empty-file", "malformed", "The file is empty.", ACCEPTED_HINT)
    check_size(data)
    if not data.startswith((ZIP_HEADER, EMPTY_ZIP)):
        return _read_model(data, filename, options, Source())
    archive = Archive(data)
    name, warnings = model_in(archive)
    source = Source(ArchiveFolder(archive, posixpath.dirname(name)), warnings)
    content = archive.read(name)
    if content.startswith(ZIP_HEADER) or not content.strip():
        raise MeshError(
            "nested-archive",
            "unsupported",
            f"{name[:80]!r} in the ZIP archive is not a model.",
            ACCEPTED_HINT,
        )
    return _read_model(content, name, options, source)


def check_size(data: bytes) -> None:
    """MeshError for a file of more than MAX_BYTES."""
    if len(data) > MAX_BYTES:
        raise MeshError(
            "file-too-large",
            "too-large",
            f"The file is larger than {MAX_BYTES >> 20} MB.",
            "Reduce the number of faces.",
        )


def _read_model(data: bytes, filename: str, options: ImportRequest, source: Source) -> FileContent:
    """The content; whatever fails unexpectedly while bytes of unknown origin are parsed is their fault."""
    kind = detect_format(data, filename)
    try:
        return _content(data, kind, options, source)
    except (MeshError, MemoryError):
        raise
    except Exception as error:
        raise _damaged(kind, error) from error


def _content(data: bytes, kind: str, options: ImportRequest, source: Source) -> FileContent:
    if kind == "treeqsm" or kind == "csv":
        scanned = qsm.read_qsm(data, kind, options)
        return FileContent(kind, scanned.parts, scanned.report, source.warnings + scanned.warnings)
    return FileContent(kind, READERS[kind](data, source), warnings=source.warnings)


def _damaged(kind: str, error: Exception) -> MeshError:
    """The error for a file on which a reader fails in a way that it does not know itself."""
    what = "nested too deep" if isinstance(error, RecursionError) else "damaged or malformed"
    return MeshError(
        "malformed-file",
        "malformed",
        f"The file cannot be read as {NAMES.get(kind, kind.upper())}: it is {what}.",
        "Open it in Blender or another modelling program and export it as GLB (glTF Binary).",
    )


def detect_format(data: bytes, filename: str) -> str:
    """The format (a key of READERS, "treeqsm" or "csv") by content, else by name."""
    head = data[:64].lstrip(b"\xef\xbb\xbf \t\r\n")
    if data[:4] == b"glTF":
        return "glb"
    if re.match(rb"ply\s", data[:8]):
        return "ply"
    if data.startswith((b"MATLAB ", qsm.HDF5_HEADER)):
        return "treeqsm"
    if head.startswith(FBX_HEADERS):
        return "fbx"
    if head.startswith(b"<") and b"<COLLADA" in data[:2048]:
        return "dae"
    if head.startswith(THREE_DS) and int.from_bytes(data[2:6], "little") == len(data):
        return "3ds"
    if head.startswith(b"{"):
        return "gltf"
    if is_binary_stl(data):  # its header may begin with anything
        return "stl"
    refuse_foreign(data)
    return _by_content_without_magic(data, PurePath(filename).suffix.lower())


def _by_content_without_magic(data: bytes, suffix: str) -> str:
    if suffix == ".csv" or qsm.has_cylinder_columns(data):
        return "csv"
    if suffix == ".stl" or re.match(rb"\s*solid\b[^\0]*\bfacet\b", data[:1024]):
        return "stl"
    if re.search(rb"^[ \t]*v[ \t]+\S", data, re.MULTILINE):
        return "obj"
    if suffix == ".glb":
        raise MeshError(
            "not-a-glb",
            "malformed",
            "The file is named .glb but does not begin with a GLB header.",
            ACCEPTED_HINT,
        )
    refuse_points(data)
    raise MeshError(
        "unsupported-type", "unsupported", "The file is not in a supported mesh format.", ACCEPTED_HINT
    )


READERS: dict[str, Callable[[bytes, Source], list[RawPart]]] = {
    "glb": read_glb,
    "gltf": read_gltf,
    "fbx": reader_of("fbx"),
    "dae": reader_of("dae"),
    "3ds": reader_of("3ds"),
    "ply": read_ply,
    "stl": read_stl,
    "obj": read_obj,
}
