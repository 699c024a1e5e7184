"""Checks of the trunk of a scanned tree: does it stand, and has it the unit of the coordinates?"""

from __future__ import annotations

import numpy as np

from galewood.formats.qsm.branches import Branch
from galewood.formats.qsm.cylinders import NO_CYLINDER, Cylinders
from galewood.util import MeshError

WIDEST_TRUNK = 0.5
"""Largest median diameter of a trunk, relative to the height of the tree."""
HIGHEST_BASE = 0.5
"""Largest height of the base of a trunk above the lowest cylinder, relative to the height of the tree."""
MIN_RISE_SHARE = 0.3
"""A trunk that rises less than this share of the distance between its ends is suspicious."""
MAX_RADIUS_GROWTH = 3.0
"""Largest radius of a cylinder, relative to that of its parent, that is not suspicious."""


def check_trunk(tree: Cylinders, trunk: Branch) -> None:
    """Raise MeshError if the trunk is impossibly thick, or hangs from the top of the tree."""
    own = trunk.cylinders
    wide_m = 2 * float(np.median(tree.radius_m[own]))
    if wide_m > WIDEST_TRUNK * tree.height_m:
        raise MeshError(
            "cylinder-thick",
            "unsuitable",
            f"The trunk is {wide_m:.3g} m thick, but the tree only {tree.height_m:.3g} m high.",
            "Radii must be in metres, like the coordinates: export the model again, or give the diameter of "
            "the trunk (--dbh-cm).",
        )
    lowest = float(min(tree.start_m[:, 2].min(), tree.end_m[:, 2].min()))
    if tree.start_m[own[0], 2] - lowest > HIGHEST_BASE * tree.height_m:
        raise MeshError(
            "upside-down",
            "unsuitable",
            "The trunk begins in the upper half of the tree.",
            "The axis z must point up: choose another one (--up-axis), or export the model again.",
        )


def trunk_warnings(tree: Cylinders, trunk: Branch) -> list[str]:
    """What is possible, but unusual."""
    found: list[str] = []
    way = tree.end_m[trunk.cylinders[-1]] - tree.start_m[trunk.cylinders[0]]
    if way[2] < MIN_RISE_SHARE * float(np.linalg.norm(way)):
        found.append("The trunk barely rises: check that the axis z points up (--up-axis).")
    child = np.flatnonzero(tree.parent != NO_CYLINDER)
    swollen = child[tree.radius_m[child] > MAX_RADIUS_GROWTH * tree.radius_m[tree.parent[child]]]
    if len(swollen):
        thickest_mm = 1000 * float(tree.radius_m[swollen].max())
        found.append(
            f"{len(swollen)} cylinders are more than {MAX_RADIUS_GROWTH:g} times as thick as the one they "
            f"grow from (the thickest has a radius of {thickest_mm:.0f} mm): check their radii."
        )
    return found
