"""What intake hands on: a tree in metres with its wood and its foliage told apart, and the errors it raises.

Frame: y up, origin at the centre of the trunk's base, right-handed as glTF.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from galewood.util import Floats, Ints

Kind = Literal["wood", "leaves"]
Axis = Literal["x", "y", "z"]


@dataclass(frozen=True)
class ImportOptions:
    """Everything intake would otherwise assume; None leaves the choice to it."""

    species: str | None = None
    height_m: float | None = None
    up_axis: Axis | None = None
    wood: tuple[str, ...] | None = None  # names of materials, nodes or meshes that are wood


@dataclass(frozen=True)
class Material:
    """A glTF material, its texture indices replaced by keys of `images`."""

    json: dict[str, Any] = field(default_factory=dict[str, Any])
    images: dict[str, tuple[bytes, str]] = field(
        default_factory=dict[str, tuple[bytes, str]]
    )  # key: bytes, mime
    samplers: dict[str, dict[str, Any]] = field(default_factory=dict[str, dict[str, Any]])


@dataclass(frozen=True)
class RawPart:
    """One drawable piece as a file gave it, in the file's own axes and units."""

    labels: tuple[str, ...]  # material, node and mesh names, in the order in which they are trusted
    positions: Floats
    faces: Ints
    normals: Floats | None = None
    uv: Floats | None = None
    colours: Floats | None = None
    material: Material | None = None


@dataclass(frozen=True)
class RenderPrimitive:
    """One mesh to draw: positions (n, 3) in metres, faces (m, 3), per-vertex extras or None."""

    name: str
    kind: Kind
    positions_m: Floats
    faces: Ints
    normals: Floats | None = None
    uv: Floats | None = None
    material: Material | None = None
    colours: Floats | None = None


@dataclass(frozen=True)
class TreeMesh:
    """A tree ready for meshing: primitives (wood first), the welded wood surface, what was assumed."""

    primitives: list[RenderPrimitive]
    wood_vertices_m: Floats
    wood_faces: Ints
    height_m: float
    species: str | None
    report: dict[str, Any]
