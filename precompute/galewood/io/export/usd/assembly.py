"""`--to usd --assembly`: a tree with leaves that are instances of a few, for Unreal's Nanite assemblies.

The wood, and leaves that are unlike all others, are a skinned mesh, the base. The other leaves are parts,
each bound to the bones of the place where it grows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from galewood.io.export.errors import ExportError
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.looped import Loop
from galewood.io.export.skeletal.bones import Rig, rigged, skinned
from galewood.io.export.skeletal.clips import Clip, clip_of
from galewood.io.export.usd.alike import Copies, copies_of
from galewood.io.export.usd.library import usd_library
from galewood.solid.skinning import drawn_positions
from galewood.table import Table
from galewood.util import Floats, Ints

MEASURED_MOMENTS = 31
"""Of a loop: a prime number, so that moments between frames are among them."""


@dataclass(frozen=True)
class Parts:
    """The parts of one mesh of the file."""

    mesh: int
    copies: list[Copies]
    """Their vertices are numbered as those of the whole tree."""


@dataclass(frozen=True)
class Assembly:
    """A tree as parts on a skeleton."""

    rig: Rig
    clip: Clip
    parts: list[Parts]

    @property
    def instances(self) -> int:
        """How many parts there are."""
        return sum(len(copies.place_m) for part in self.parts for copies in part.copies)

    def about(self) -> dict[str, int]:
        """For the description."""
        shapes = sum(len(part.copies) for part in self.parts)
        return {"shapes": shapes, "instances": self.instances}

    def in_parts(self, vertices: int) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """(v,) whether a vertex belongs to a part."""
        found = np.zeros(vertices, np.bool_)
        for part in self.parts:
            for copies in part.copies:
                found[copies.vertices] = True
        return found


def assembly_of(table: Table, file: GltfFile, loop: Loop, name: str, bones: int) -> Assembly:
    """Parts and a skeleton of at most ``bones`` bones. Raises ExportError for a tree without leaves alike."""
    rest_m = file.rest_m()
    rig = rigged(table, rest_m, [loop], bones)
    joint, parts, start = table.vertex_joint.astype(np.int64), list[Parts](), 0
    primitives = table.metadata["primitives"]
    meshes = zip(file.counts, file.faces(), file.texture_coordinates(), primitives, strict=True)
    for mesh, (count, faces, uv, primitive) in enumerate(meshes):
        mine = slice(start, start + count)
        if primitive["kind"] == "leaves" and table.foliage != "bare":
            alike = copies_of(rest_m[mine], faces, uv)
            copies = [_on_one_joint(each, joint[mine], start) for each in alike]
            parts.append(Parts(mesh, [each for each in copies if len(each.place_m)]))
        start += count
    found = Assembly(rig, clip_of(table, rig.skeleton, f"{name}_sway", loop), parts)
    if not found.instances:
        raise ExportError("an assembly needs leaves of the same shape, and this tree has none: leave it out")
    return found


def _on_one_joint(copies: Copies, joint: Ints, start: int) -> Copies:
    """Those copies whose vertices, of a mesh that begins at ``start``, all hang on one joint of the table."""
    of_vertex = joint[copies.vertices]
    one = (of_vertex == of_vertex[:, :1]).all(axis=1)
    kept = (copies.vertices[one] + start, copies.place_m[one], copies.turn[one], copies.scale[one])
    return Copies(copies.shape_m, copies.faces, *kept)


def assembly_error_percent(stage: Any, root: str, table: Table, rest_m: Floats, assembly: Assembly) -> float:
    """Largest distance of a vertex from where the table draws it, in % of the height, parts as in the stage.

    All vertices of a part have its bones, so that blending moves them as the part.
    """
    placed, worst, loop = _placed(stage, root, rest_m, assembly), 0.0, assembly.clip.loop
    for frame in np.linspace(0.0, loop.frames, MEASURED_MOMENTS, endpoint=False):
        exact = drawn_positions(table, rest_m, loop.q_at(frame * loop.seconds / loop.frames))
        found = skinned(assembly.rig, assembly.clip.motion, placed, float(frame))
        worst = max(worst, float(np.linalg.norm(found - exact, axis=1).max()))
    return 100 * worst / float(table.metadata["height_m"])


def _placed(stage: Any, root: str, rest_m: Floats, assembly: Assembly) -> Floats:
    """(v, 3) the vertices at rest, those of parts where the instancers of the stage have them."""
    pxr, found = usd_library(), rest_m.copy()
    for number, part in enumerate(assembly.parts):
        if not part.copies:
            continue
        instancer = pxr.UsdGeom.PointInstancer(stage.GetPrimAtPath(f"{root}/parts_{number}"))
        moves = np.array(instancer.ComputeInstanceTransformsAtTime(0, 0))
        start = 0
        for copies in part.copies:
            own, start = moves[start : start + len(copies.place_m)], start + len(copies.place_m)
            found[copies.vertices] = copies.shape_m @ own[:, :3, :3] + own[:, 3:, :3].reshape(-1, 1, 3)
    return found
