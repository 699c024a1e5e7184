"""Wavefront OBJ reader: groups, materials with their colours and textures, vertex colours.

Material libraries and textures come from the uploaded archive; files of this computer are never opened.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from galewood.formats.colours import linear_from_srgb, painted
from galewood.formats.companions import Source
from galewood.formats.limits import check_faces
from galewood.formats.meshes.mtl import read_libraries
from galewood.formats.types import Material, RawPart
from galewood.util import Floats, MeshError, shown_text

MISSING_INDEX = 0  # OBJ indices start at 1; 0 means absent
Corner = tuple[int, int, int]
COLOURED_VERTEX_LENGTH = 6  # numbers of a vertex with a colour
NOT_DRAWN = {"p": "points", "l": "lines", "curv": "curves", "surf": "surfaces"}


@dataclass
class _Obj:
    vertices: list[list[float]] = field(default_factory=list[list[float]])
    colours: list[list[float]] = field(default_factory=list[list[float]])
    uvs: list[list[float]] = field(default_factory=list[list[float]])
    normals: list[list[float]] = field(default_factory=list[list[float]])
    corners: dict[tuple[str, ...], list[Corner]] = field(
        default_factory=dict[tuple[str, ...], list[Corner]]
    )  # of triangles, three in a row, by (usemtl, g, o)
    names: dict[str, str] = field(default_factory=dict[str, str])
    libraries: list[str] = field(default_factory=list[str])
    current: list[Corner] | None = None
    triangles: int = 0


def read_obj(data: bytes, source: Source) -> list[RawPart]:
    """Parts of an OBJ file, one per (usemtl, g, o). Raises MeshError on lines that cannot be parsed."""
    check_faces(data.count(b"\nf ") + data.count(b"\nf\t"))  # before there is an object for each line
    obj = _Obj()
    for number, line in _lines(_decoded(data)):
        try:
            _take(obj, line.split(), source)
        except (ValueError, IndexError) as error:
            raise MeshError(
                "obj-syntax",
                "malformed",
                f"Line {number} of the OBJ is invalid.",
                f"Correct it and try again: {line[:60]!r}.",
            ) from error
    used = {names[0] for names in obj.corners}
    materials = read_libraries(obj.libraries, used, source)
    vertices, colours = np.array(obj.vertices, dtype=np.float64), _vertex_colours(obj)
    return [
        _part(obj, names, corners, vertices, colours, materials.get(names[0]))
        for names, corners in obj.corners.items()
    ]


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


def _take(obj: _Obj, words: list[str], source: Source) -> None:
    match words[0]:
        case "v":
            _take_vertex(obj, words)
        case "vt":
            obj.uvs.append([float(words[1]), float(words[2]) if len(words) > 2 else 0.0])
        case "vn":
            obj.normals.append([float(w) for w in words[1:4]])
        case "f":
            _take_face(obj, words[1:])
        case "o" | "g" | "usemtl":
            obj.names[words[0]] = shown_text(" ".join(words[1:]))
            obj.current = None
        case "mtllib":
            obj.libraries.append(" ".join(words[1:]))
        case "p" | "l" | "curv" | "surf":
            source.warn(f"The {NOT_DRAWN[words[0]]} of the OBJ file are not used.")
        case _:
            pass


def _take_vertex(obj: _Obj, words: list[str]) -> None:
    values = [float(w) for w in words[1:]]
    if len(values) < 3:
        raise ValueError("a vertex needs three coordinates")
    obj.vertices.append(values[:3])
    if len(values) >= COLOURED_VERTEX_LENGTH:
        obj.colours.append(values[3:6])


def _take_face(obj: _Obj, words: list[str]) -> None:
    corners = [_corner(obj, word) for word in words]
    if len(corners) < 3:
        raise ValueError("a face needs three corners")
    obj.triangles += len(corners) - 2
    check_faces(obj.triangles)
    if obj.current is None:
        names = tuple(obj.names.get(key, "") for key in ("usemtl", "g", "o"))
        obj.current = obj.corners.setdefault(names, [])
    for i in range(1, len(corners) - 1):
        obj.current += (corners[0], corners[i], corners[i + 1])


def _corner(obj: _Obj, word: str) -> Corner:
    fields = word.split("/")
    first = _index(fields[0], len(obj.vertices))
    if len(fields) == 1:
        return first, MISSING_INDEX, MISSING_INDEX
    second = _index(fields[1], len(obj.uvs)) if fields[1] else MISSING_INDEX
    third = _index(fields[2], len(obj.normals)) if len(fields) > 2 and fields[2] else MISSING_INDEX
    return first, second, third


def _index(text: str, count: int) -> int:
    value = int(text)
    if value < 0:
        value += count + 1
    if not 1 <= value <= count:
        raise ValueError(f"index {text} is out of range")
    return value


def _vertex_colours(obj: _Obj) -> Floats | None:
    """Linear colours (n, 3) if every vertex has one; programs write 0 to 1, some 0 to 255."""
    if not obj.colours or len(obj.colours) != len(obj.vertices):
        return None
    colours = np.array(obj.colours, dtype=np.float64)
    return linear_from_srgb(colours / 255.0 if float(colours.max()) > 1.0 else colours)


def _part(
    obj: _Obj,
    names: tuple[str, ...],
    triangles: list[Corner],
    vertices: Floats,
    colours: Floats | None,
    material: Material | None,
) -> RawPart:
    corners = np.array(triangles, dtype=np.int64).reshape(-1, 3)
    unique, inverse = _distinct(corners)
    point = unique[:, 0] - 1
    return RawPart(
        labels=tuple(n for n in names if n),
        positions=vertices[point],
        faces=inverse.reshape(-1, 3).astype(np.int32),
        normals=_attribute(obj.normals, unique[:, 2]),
        uv=_flipped(_attribute(obj.uvs, unique[:, 1])),
        colours=None if colours is None else colours[point],
        material=material or (None if colours is None else painted()),
    )


def _distinct(corners: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Distinct rows and the row of each corner; sorted by one number, which is faster than by rows."""
    size = corners.max(axis=0) + 1
    if float(size[0]) * float(size[1]) * float(size[2]) > 2.0**62:
        unique, inverse = np.unique(corners, axis=0, return_inverse=True)
        return unique, inverse.reshape(-1)
    key = (corners[:, 0] * size[1] + corners[:, 1]) * size[2] + corners[:, 2]
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    return corners[first], inverse.reshape(-1)


def _attribute(rows: list[list[float]], indices: NDArray[np.int64]) -> Floats | None:
    if not rows or bool((indices == MISSING_INDEX).any()):
        return None
    return np.array(rows, dtype=np.float64)[indices - 1]


def _flipped(uv: Floats | None) -> Floats | None:
    """Texture coordinates with v reversed: v points up in OBJ and down in glTF."""
    return None if uv is None else np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])
