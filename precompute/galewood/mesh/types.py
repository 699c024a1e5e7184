"""Result of the mesh import: a tree in metres with wood and foliage separated.

Frame: y up, origin at the centre of the trunk's base, right-handed as in glTF.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from galewood.util import Floats, Ints, shown_text

Kind = Literal["wood", "twigs", "leaves"]
"""Wood is meshed. Twigs are wood too thin to be meshed: they are drawn, and hang on it with their mass."""
KINDS: tuple[Kind, ...] = ("wood", "twigs", "leaves")  # in the order of the primitives
Axis = Literal["x", "y", "z", "-x", "-y", "-z"]


@dataclass(frozen=True)
class ImportOptions:
    """Choices that the import otherwise makes itself; None leaves a choice to it."""

    species: str | None = None
    height_m: float | None = None
    up_axis: Axis | None = None
    wood: tuple[str, ...] | None = (
        None  # names of materials, nodes or meshes, or ids of pieces, that are wood
    )
    dbh_cm: float | None = None  # of a scanned tree, like the fields below: diameter at breast height
    min_radius_mm: float | None = None  # thinner branches are dropped
    bare: bool = False  # no leaves are added
    leaves: tuple[str, ...] | None = None  # names or ids of pieces that are leaves
    drop: tuple[str, ...] | None = None  # names or ids of pieces that are left out
    tree: int | None = None  # which tree of a file with several, from 1; None: the largest
    complete: bool | None = None  # whether missing wood is added; None: where the foliage needs it

    def __post_init__(self) -> None:
        """Names are cleaned as those of the file are, so that they still mean the same parts."""
        for field_name in ("wood", "leaves", "drop"):
            names: tuple[str, ...] | None = getattr(self, field_name)
            if names is not None:
                object.__setattr__(self, field_name, tuple(map(shown_text, names)))


@dataclass(frozen=True)
class Material:
    """A glTF material; texture indices are replaced by keys of `images`."""

    json: dict[str, Any] = field(default_factory=dict[str, Any])
    images: dict[str, tuple[bytes, str]] = field(
        default_factory=dict[str, tuple[bytes, str]]
    )  # key: (bytes, MIME type)
    samplers: dict[str, dict[str, Any]] = field(default_factory=dict[str, dict[str, Any]])


@dataclass(frozen=True)
class RawPart:
    """A part as read from the file, in the file's axes and units."""

    labels: tuple[str, ...]  # material, node and mesh names, in order of precedence
    positions: Floats
    faces: Ints
    normals: Floats | None = None
    uv: Floats | None = None
    colours: Floats | None = None
    material: Material | None = None


@dataclass(frozen=True)
class RenderPrimitive:
    """A mesh to render: positions (n, 3) in metres, faces (m, 3), optional vertex attributes."""

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
    """A tree ready for meshing: render primitives (wood, twigs, leaves), welded wood surface, report.

    The last ``added_faces`` faces of the wood are in no primitive: they were added and are not drawn.
    """

    primitives: list[RenderPrimitive]
    wood_vertices_m: Floats
    wood_faces: Ints
    height_m: float
    species: str | None
    report: dict[str, Any]
    added_faces: int = 0

    def added_wood(self) -> RenderPrimitive | None:
        """The wood that was added and is not drawn, as a mesh; None if there is none."""
        return self._of_faces("added", self.wood_faces[-self.added_faces :]) if self.added_faces else None

    def drawn_wood(self) -> RenderPrimitive:
        """The welded wood without what was added, as a mesh; it may be empty."""
        return self._of_faces("drawn", self.wood_faces[: len(self.wood_faces) - self.added_faces])

    def _of_faces(self, name: str, chosen: Ints) -> RenderPrimitive:
        used, index = np.unique(chosen, return_inverse=True)
        return RenderPrimitive(
            name, "wood", self.wood_vertices_m[used], index.reshape(-1, 3).astype(np.int32)
        )
