"""A capsule around the trunk, for collisions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from galewood.io.export.skeletal.radii import node_radii
from galewood.io.export.skeletal.skeleton import main_children, parents_of
from galewood.table import Table
from galewood.util import Floats

if TYPE_CHECKING:
    from galewood.io.export.gltf_file import GltfFile

THINNEST_SHARE = 0.5
"""The capsule ends where the stem is thinner than this share of its foot."""


@dataclass(frozen=True)
class Capsule:
    """All points within a radius of a segment."""

    foot_m: Floats
    top_m: Floats
    radius_m: float

    def about(self) -> dict[str, Any]:
        """For the extras of a node whose y axis is the capsule's, and the description of an export.

        ``height_m`` includes the round ends, as engines count it.
        """
        length_m = float(np.linalg.norm(self.top_m - self.foot_m))
        return {"shape": "capsule", "radius_m": self.radius_m, "height_m": length_m + 2 * self.radius_m}


def trunk_capsule(table: Table, rest_m: Floats) -> Capsule:
    """The capsule from the foot up along the stem, as far as the stem is straight and not yet thin.

    It ends at the last node of the stem up to which every node is within a radius of the segment, and the
    wood at least THINNEST_SHARE as thick as at the foot. Its radius is the mean of the stem's, by length.

    Args:
        table: The table.
        rest_m: (v, 3) the drawn vertices.
    """
    parent, place = parents_of(table), table.node_rest_m.astype(np.float64)
    following, stem = main_children(parent), [int(np.flatnonzero(parent < 0)[0])]
    while following[stem[-1]] >= 0:
        stem.append(int(following[stem[-1]]))
    at, radius = place[stem], node_radii(table, rest_m)[stem]
    radius_m, last = float(radius[min(1, len(stem) - 1)]), min(1, len(stem) - 1)
    thinnest_m = THINNEST_SHARE * radius_m
    for end in range(1, len(stem)):
        lengths = np.linalg.norm(np.diff(at[: end + 1], axis=0), axis=1)
        mean_m = float(np.average(radius[1 : end + 1], weights=np.maximum(lengths, 1e-9)))
        if radius[end] < thinnest_m or _farthest_m(at[: end + 1]) > mean_m:
            break
        radius_m, last = mean_m, end
    return Capsule(at[0], at[last], radius_m)


def _farthest_m(points: Floats) -> float:
    """Largest distance of a point from the line through the first and the last."""
    along = points[-1] - points[0]
    along = along / max(float(np.linalg.norm(along)), 1e-12)
    arm = points - points[0]
    return float(np.linalg.norm(arm - (arm @ along)[:, None] * along, axis=1).max())


def add_capsule(file: GltfFile, capsule: Capsule, name: str) -> None:
    """Add a node without a mesh, NAME_trunk_capsule, in the capsule's middle with its y axis along it."""
    import pygltflib

    up = capsule.top_m - capsule.foot_m
    up = up / max(float(np.linalg.norm(up)), 1e-12)
    turn = np.array([up[2], 0.0, -up[0], 1.0 + up[1]])  # from (0, 1, 0) to up, which is not downwards
    node = pygltflib.Node(
        name=f"{name}_trunk_capsule",
        translation=(0.5 * (capsule.foot_m + capsule.top_m)).tolist(),
        rotation=(turn / np.linalg.norm(turn)).tolist(),
        extras={"galewood_collision": capsule.about()},
    )
    file.gltf.nodes.append(node)
    scene = file.gltf.scenes[file.gltf.scene or 0]
    scene.nodes = [*(scene.nodes or []), len(file.gltf.nodes) - 1]
