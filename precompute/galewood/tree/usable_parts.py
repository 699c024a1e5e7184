"""Checks of the parts of a file before anything is read from their shape."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from galewood.formats import RawPart, check_faces
from galewood.util import Floats, Ints, MeshError


def usable_parts(parts: list[RawPart]) -> list[RawPart]:
    """The parts that have faces, checked; attributes that are not usable are left out. Raises MeshError."""
    parts = [p for p in parts if len(p.faces) and len(p.positions)]
    count = sum(len(p.faces) for p in parts)
    if count == 0:
        raise MeshError(
            "no-faces", "unsuitable", "The file contains no triangles.", "Export the tree as a triangle mesh."
        )
    check_faces(count)
    bad = sum(
        int((~np.isfinite(p.positions).all(axis=1) | (np.abs(p.positions) > 1e12).any(axis=1)).sum())
        for p in parts
    )
    if bad:
        raise MeshError(
            "non-finite", "unsuitable", f"{bad} vertices have coordinates that are not finite.",
            "Remove them (in Blender: Mesh > Clean Up) and export the file again.",
        )  # fmt: skip
    for part in parts:
        if int(part.faces.min()) < 0 or int(part.faces.max()) >= len(part.positions):
            raise MeshError(
                "index-out-of-range",
                "malformed",
                "A face refers to a vertex that does not exist.",
                "Export the file again.",
            )
    return [_with_finite_extras(p) for p in parts]


def _with_finite_extras(part: RawPart) -> RawPart:
    """Drop normals, texture coordinates and colours that are not finite or have the wrong length."""

    def valid(rows: Floats | None) -> Floats | None:
        return (
            rows
            if rows is not None and len(rows) == len(part.positions) and np.isfinite(rows).all()
            else None
        )

    return replace(part, normals=valid(part.normals), uv=valid(part.uv), colours=valid(part.colours))


def as_one_mesh(parts: list[RawPart]) -> tuple[Floats, Ints]:
    """Vertices (n, 3) and faces (m, 3) of all parts."""
    offsets = np.cumsum([0] + [len(p.positions) for p in parts])
    faces = np.concatenate([p.faces + int(o) for p, o in zip(parts, offsets, strict=False)])
    return np.concatenate([p.positions for p in parts]), faces


def check_volume(vertices: Floats) -> None:
    """Raises MeshError if the vertices lie in a plane."""
    singular = np.linalg.svd(vertices - vertices.mean(axis=0), compute_uv=False)
    if not singular[0] > 0 or singular[-1] < 1e-6 * singular[0] or len(vertices) < 4:
        raise MeshError(
            "no-volume",
            "unsuitable",
            "The mesh is flat and encloses no volume.",
            "Upload a tree with solid wood.",
        )
