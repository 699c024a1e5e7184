"""File format detection by content, and reading of the parts. File names in the data are never opened."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Any

import numpy as np

from galewood.mesh import qsm
from galewood.mesh.gltf import read_glb, read_gltf
from galewood.mesh.obj import read_obj
from galewood.mesh.types import ImportOptions, RawPart
from galewood.util import MeshError

MAX_BYTES = 64 * 1024 * 1024
STL_HEADER_BYTES = 84
STL_FACE_BYTES = 50
PLY_BYTES = {
    "char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2, "uint16": 2,
    "int": 4, "uint": 4, "int32": 4, "uint32": 4, "float": 4, "float32": 4, "double": 8, "float64": 8,
}  # fmt: skip
FOREIGN = {
    b"PK\x03\x04": "a ZIP archive", b"\x1f\x8b": "a gzip file", b"%PDF": "a PDF", b"\x89PNG": "a PNG image",
    b"\xff\xd8\xff": "a JPEG image", b"GIF8": "a GIF image", b"BZh": "a bzip2 file",
    b"7z\xbc\xaf": "a 7z archive",
    b"Rar!": "a RAR archive", b"Kaydara FBX": "an FBX file", b"BLENDER": "a Blender file",
    b"\x7fELF": "a program",
    b"MZ": "a program", b"<": "an HTML or XML page", b"\x28\xb5\x2f\xfd": "a Zstandard file",
}  # fmt: skip
ACCEPTED = "Upload a GLB, OBJ, PLY or STL file, or the cylinders of a scanned tree (MAT, CSV)."


@dataclass(frozen=True)
class FileContent:
    """The name of a file's format and its parts; of a scanned tree also a report and warnings."""

    file_format: str
    parts: list[RawPart]
    qsm: dict[str, Any] | None = None
    warnings: list[str] = field(default_factory=list[str])


def read_parts(data: bytes, filename: str, options: ImportOptions) -> FileContent:
    """The format and the parts of a file.

    Raises MeshError with reason "malformed", "too-large" or "unsupported".
    """
    if not data.strip():
        raise MeshError("empty-file", "malformed", "The file is empty.", ACCEPTED)
    if len(data) > MAX_BYTES:
        raise MeshError(
            "file-too-large",
            "too-large",
            f"The file is larger than {MAX_BYTES >> 20} MB.",
            "Reduce the number of faces.",
        )
    kind = detect_format(data, filename)
    if kind == "treeqsm" or kind == "csv":
        scanned = qsm.read_qsm(data, kind, options)
        return FileContent(kind, scanned.parts, scanned.report, scanned.warnings)
    return FileContent(kind, READERS[kind](data))


def detect_format(data: bytes, filename: str) -> str:
    """The format ("glb", "gltf", "ply", "stl", "obj", "treeqsm", "csv") by content, else by the file name."""
    head = data[:64].lstrip(b"\xef\xbb\xbf \t\r\n")
    if data[:4] == b"glTF":
        return "glb"
    if re.match(rb"ply\s", data[:8]):
        return "ply"
    if data.startswith((b"MATLAB ", qsm.HDF5)):
        return "treeqsm"
    for magic, what in FOREIGN.items():
        if head.startswith(magic):
            raise MeshError("unsupported-type", "unsupported", f"The file is {what}, not a mesh.", ACCEPTED)
    if head.startswith(b"{"):
        return "gltf"
    return _by_content_without_magic(data, PurePath(filename).suffix.lower())


def _by_content_without_magic(data: bytes, suffix: str) -> str:
    if suffix == ".csv" or qsm.has_cylinder_columns(data):
        return "csv"
    if suffix == ".stl" or _is_binary_stl(data) or re.match(rb"\s*solid\b[^\0]*\bfacet\b", data[:1024]):
        return "stl"
    if re.search(rb"^[ \t]*v[ \t]+\S", data, re.MULTILINE):
        return "obj"
    if suffix == ".glb":
        raise MeshError(
            "not-a-glb", "malformed", "The file is named .glb but does not begin with a GLB header.", ACCEPTED
        )
    raise MeshError(
        "unsupported-type", "unsupported", "The file is not in a supported mesh format.", ACCEPTED
    )


def _is_binary_stl(data: bytes) -> bool:
    return len(data) >= STL_HEADER_BYTES and len(data) == STL_HEADER_BYTES + STL_FACE_BYTES * _stl_count(data)


def _stl_count(data: bytes) -> int:
    return int.from_bytes(data[80:84], "little")


def read_stl(data: bytes) -> list[RawPart]:
    """Binary or ASCII STL; the declared face count is checked against the length before allocation."""
    is_text = data.lstrip()[:5] == b"solid" and b"facet" in data[:4096]
    if not is_text and not _is_binary_stl(data):
        declared = _stl_count(data) if len(data) >= STL_HEADER_BYTES else 0
        raise MeshError(
            "wrong-count", "malformed", f"The STL declares {declared} triangles but has {len(data)} bytes.",
            "The file is truncated or damaged; export it again.",
        )  # fmt: skip
    return _through_trimesh(data, "stl_ascii" if is_text else "stl")


def read_ply(data: bytes) -> list[RawPart]:
    """ASCII or binary PLY; the declared counts are checked against the length first."""
    end = data.find(b"end_header")
    if end < 0 or end > 65536:
        raise MeshError("truncated", "malformed", "The PLY header is incomplete.", "Export the file again.")
    _check_ply_counts(data[:end].decode("latin-1"), len(data) - end)
    return _through_trimesh(data, "ply")


def _check_ply_counts(header: str, body_bytes: int) -> None:
    is_text = "format ascii" in header
    need, row = 0, 0
    count = 0
    for line in [*header.splitlines(), "element end 0"]:
        words = line.split()
        if words[:1] == ["element"]:
            need += count * row
            count, row = _ply_count(words), 0
        elif words[:1] == ["property"] and len(words) > 1:
            row += 2 if is_text else (1 if words[1] == "list" else PLY_BYTES.get(words[1], 1))
    if need > body_bytes + 16:
        raise MeshError(
            "wrong-count",
            "malformed",
            f"The PLY declares at least {need} bytes of elements but has only {body_bytes}.",
            "The file is truncated or damaged; export it again.",
        )  # fmt: skip


def _ply_count(words: list[str]) -> int:
    if len(words) != 3 or not words[2].isdigit():
        raise MeshError(
            "ply-syntax",
            "malformed",
            "An element line of the PLY header is invalid.",
            "Export the file again.",
        )
    return int(words[2])


def _through_trimesh(data: bytes, file_type: str) -> list[RawPart]:
    import trimesh  # slow to load, and most uploads are GLB files

    try:
        mesh: Any = trimesh.load(io.BytesIO(data), file_type=file_type, process=False)
        positions = np.array(mesh.vertices, dtype=np.float64).reshape(-1, 3)
        faces = np.array(mesh.faces, dtype=np.int64).reshape(-1, 3)
    except MemoryError:
        raise
    except Exception as error:
        raise MeshError(
            "unreadable",
            "malformed",
            f"The {file_type[:3].upper()} file cannot be read.",
            "The file is truncated or damaged; export it again.",
        ) from error
    return [RawPart(labels=(), positions=positions, faces=faces.astype(np.int32))]


READERS: dict[str, Callable[[bytes], list[RawPart]]] = {
    "glb": read_glb,
    "gltf": read_gltf,
    "ply": read_ply,
    "stl": read_stl,
    "obj": read_obj,
}
