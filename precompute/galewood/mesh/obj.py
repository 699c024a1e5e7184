"""Wavefront OBJ reader: group and material names are kept, other files are never opened."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from galewood.mesh.types import RawPart
from galewood.util import Floats, MeshError

MISSING = 0  # OBJ indices start at 1; 0 means absent
Corner = tuple[int, int, int]


@dataclass
class _Obj:
    vertices: list[list[float]] = field(default_factory=list[list[float]])
    uvs: list[list[float]] = field(default_factory=list[list[float]])
    normals: list[list[float]] = field(default_factory=list[list[float]])
    parts: dict[tuple[str, ...], list[tuple[Corner, Corner, Corner]]] = field(
        default_factory=dict[tuple[str, ...], list[tuple[Corner, Corner, Corner]]]
    )
    names: dict[str, str] = field(default_factory=dict[str, str])


def read_obj(data: bytes) -> list[RawPart]:
    """Parts of an OBJ file, one per (usemtl, g, o). Raises MeshError on lines that cannot be parsed."""
    obj = _Obj()
    for number, line in _lines(_decoded(data)):
        try:
            _take(obj, line.split())
        except (ValueError, IndexError) as error:
            raise MeshError(
                "obj-syntax",
                "malformed",
                f"Line {number} of the OBJ is invalid.",
                f"Correct it and try again: {line[:60]!r}.",
            ) from error
    return [_part(obj, names, corners) for names, corners in obj.parts.items()]


def _decoded(data: bytes) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")  # latin-1 decodes every byte, so names survive even if misread


def _lines(text: str) -> Iterator[tuple[int, str]]:
    """Numbered logical lines: comments removed, continuations joined."""
    held = ""
    for number, raw in enumerate(text.splitlines(), start=1):
        line = held + raw.split("#", 1)[0].rstrip()
        if line.endswith("\\"):
            held = line[:-1] + " "
            continue
        held = ""
        if line.strip():
            yield number, line.strip()


def _take(obj: _Obj, words: list[str]) -> None:
    match words[0]:
        case "v":
            obj.vertices.append([float(w) for w in words[1:4]])
            if len(obj.vertices[-1]) != 3:
                raise ValueError("a vertex needs three coordinates")
        case "vt":
            obj.uvs.append([float(words[1]), float(words[2]) if len(words) > 2 else 0.0])
        case "vn":
            obj.normals.append([float(w) for w in words[1:4]])
        case "f":
            _take_face(obj, words[1:])
        case "o" | "g" | "usemtl":
            obj.names[words[0]] = " ".join(words[1:])
        case _:
            pass  # includes mtllib: file names in the data are never opened


def _take_face(obj: _Obj, words: list[str]) -> None:
    corners = [_corner(obj, word) for word in words]
    if len(corners) < 3:
        raise ValueError("a face needs three corners")
    names = tuple(obj.names.get(key, "") for key in ("usemtl", "g", "o"))
    fan = obj.parts.setdefault(names, [])
    for i in range(1, len(corners) - 1):
        fan.append((corners[0], corners[i], corners[i + 1]))


def _corner(obj: _Obj, word: str) -> Corner:
    fields = [*word.split("/"), "", ""]
    return (
        _index(fields[0], len(obj.vertices), required=True),
        _index(fields[1], len(obj.uvs)),
        _index(fields[2], len(obj.normals)),
    )


def _index(text: str, count: int, required: bool = False) -> int:
    value = int(text) if text or required else MISSING
    if value < 0:
        value += count + 1
    if (required or text) and not 1 <= value <= count:
        raise ValueError(f"index {text} is out of range")
    return value


def _part(obj: _Obj, names: tuple[str, ...], triangles: list[tuple[Corner, Corner, Corner]]) -> RawPart:
    corners = np.array(triangles, dtype=np.int64).reshape(-1, 3)
    unique, inverse = np.unique(corners, axis=0, return_inverse=True)
    return RawPart(
        labels=tuple(n for n in names if n),
        positions=np.array(obj.vertices, dtype=np.float64)[unique[:, 0] - 1],
        faces=inverse.reshape(-1, 3).astype(np.int32),
        normals=_attribute(obj.normals, unique[:, 2]),
        uv=_flipped(_attribute(obj.uvs, unique[:, 1])),
    )


def _attribute(rows: list[list[float]], indices: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Floats | None:
    if not rows or bool((indices == MISSING).any()):
        return None
    return np.array(rows, dtype=np.float64)[indices - 1]


def _flipped(uv: Floats | None) -> Floats | None:
    """Texture coordinates with v reversed: v points up in OBJ and down in glTF."""
    return None if uv is None else np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])
