"""Result of the mesh import: a tree in metres with wood and foliage separated.

Frame: y up, origin at the centre of the trunk's base, right-handed as in glTF.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from galewood.formats import Material
from galewood.util import Floats, Ints

Kind = Literal["wood", "twigs", "leaves"]
"""Wood is meshed. Twigs are wood too thin to be meshed: they are drawn, and hang on it with their mass."""
KINDS: tuple[Kind, ...] = ("wood", "twigs", "leaves")  # in the order of the primitives


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
