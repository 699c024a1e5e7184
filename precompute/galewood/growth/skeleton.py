"""The generator's own skeleton of a tree (assets/species/README.md)."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from galewood.util import Floats, Int64s


@dataclass(frozen=True)
class GrownSkeleton:
    """Axes of all branches: points_m (n, 3), radius_m (n,), parent (n,), −1 at the root, before its children.

    ``branch`` (n,) numbers the branches, the stem being 0; ``level`` (n,) is 0 for it, 1 for boughs, 2 for
    limbs.
    """

    points_m: Floats
    radius_m: Floats
    parent: Int64s
    branch: Int64s
    level: Int64s


def read_skeleton(document: bytes) -> GrownSkeleton:
    """The skeleton in a document that the generator wrote. Raises ValueError for another one."""
    try:
        columns = json.loads(document)
        points, radius = (np.asarray(columns[name], np.float64) for name in ("points_m", "radius_m"))
        parent, branch, level = (
            np.asarray(columns[name], np.int64) for name in ("parent", "branch", "level")
        )
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"not the skeleton of a grown tree: {error}") from None
    if not len(points) == len(radius) == len(parent) == len(branch) == len(level):
        raise ValueError("not the skeleton of a grown tree: its columns differ in length")
    return GrownSkeleton(points, radius, parent, branch, level)
