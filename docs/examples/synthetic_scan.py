"""Grows a tree of cylinders at random and writes it as the CSV file of a scan.

The tree is invented: thick limbs first, each with side branches, until there are enough cylinders. Try

    python docs/examples/synthetic_scan.py --height-m 14 --dbh-cm 26 --out tree.csv
    galewood build tree.csv --species oak --out tree.gwt
"""

from __future__ import annotations

import argparse
import heapq
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
BREAST_HEIGHT_M = 1.3
COLUMNS = "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,branchID"
GOLDEN_ANGLE_RAD = np.pi * (3 - np.sqrt(5))
LARGEST_CHILD = 0.6
"""Radius of a side branch relative to its parent limb, at most."""
LONGEST_CHILD = 0.5
"""Length of a side branch relative to its parent limb, at most."""
LIMB_SEGMENTS, TRUNK_SEGMENTS = 12, 30


@dataclass(frozen=True)
class Habit:
    """How a tree grows: height m, diameter cm, number of cylinders, and its shape.

    ``crown_base`` is the share of the height below the first branch, ``lean`` the sideways part of the
    direction of the trunk, ``fork`` the share of the height at which the trunk divides (0: never).
    """

    height_m: float = 14.0
    dbh_cm: float = 26.0
    cylinders: int = 3000
    crown_base: float = 0.25
    lean: float = 0.0
    fork: float = 0.0
    tip_mm: float = 2.0


@dataclass(frozen=True)
class Limb:
    """A branch that is still to grow: base (3,) m, unit direction (3,), length m, radius m, its order.

    ``parent`` is the number of the cylinder that it grows from (0: none).
    """

    base_m: Floats
    direction: Floats
    length_m: float
    radius_m: float
    order: int
    parent: int


def grown(habit: Habit, seed: int = 1) -> Floats:
    """The cylinders (n, 10) of a random tree, with the columns ``COLUMNS``, metres, z up."""
    random = np.random.default_rng(seed)
    taper = 1 - BREAST_HEIGHT_M / habit.height_m
    trunk = Limb(
        np.zeros(3),
        _unit(np.array([habit.lean, 0.0, 1.0])),
        habit.height_m * np.hypot(1.0, habit.lean),
        habit.dbh_cm / 200 / taper**0.8,
        0,
        0,
    )
    waiting: list[tuple[float, int, Limb]] = [(-trunk.radius_m, 0, trunk)]
    rows: list[Floats] = []
    limbs = 1
    while waiting and len(rows) < habit.cylinders:
        _, number, limb = heapq.heappop(waiting)
        place, radius = _axis(limb, habit, random)
        first = len(rows) + 1
        for k, size in enumerate(radius):
            own, parent = first + k, first + k - 1 if k else limb.parent
            rows.append(np.array([own, parent, *place[k], *place[k + 1], size, number + 1]))
        for child in _children(limb, place, radius, first, habit, random):
            heapq.heappush(waiting, (-child.radius_m, limbs, child))
            limbs += 1
    return np.array(rows)[: habit.cylinders]


def _axis(limb: Limb, habit: Habit, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Points (k + 1, 3) along a limb, which bends upwards a little, and the radii (k,) between them."""
    segments = LIMB_SEGMENTS if limb.order else TRUNK_SEGMENTS
    step = limb.length_m / segments
    place, direction = [limb.base_m], limb.direction
    for _ in range(segments):
        place.append(place[-1] + step * direction)
        wander = random.normal(size=3) * (0.12 if limb.order else 0.02)
        direction = _unit(direction + wander + np.array([0, 0, 0.06 if limb.order else 0.0]))
    share = (np.arange(segments) + 0.5) / segments
    return np.array(place), np.maximum(limb.radius_m * (1 - share) ** 0.8, habit.tip_mm / 1000)


def _children(
    limb: Limb, place: Floats, radius: Floats, first: int, habit: Habit, random: np.random.Generator
) -> list[Limb]:
    """The side branches of a limb."""
    found: list[Limb] = []
    start = habit.crown_base if limb.order == 0 else 0.2
    turn = random.uniform(0, 2 * np.pi)
    for k in range(int(np.ceil(start * len(radius))), len(radius) - 1):
        share = (k + 1) / len(radius)
        turn += GOLDEN_ANGLE_RAD
        along = _unit(place[k + 1] - place[k])
        forks = limb.order == 0 and 0 < habit.fork <= share < habit.fork + 1 / len(radius)
        size = radius[k] * (0.95 if forks else LARGEST_CHILD * random.uniform(0.5, 1.0))
        length = limb.length_m * (
            1 - share if forks else LONGEST_CHILD * (1.15 - share) * random.uniform(0.6, 1)
        )
        lean = np.radians(25 if forks else random.uniform(40, 70))
        way = np.cos(lean) * along + np.sin(lean) * _around(along, turn)
        found.append(Limb(place[k + 1], _unit(way), length, size, limb.order + 1, first + k))
    return found


def _around(along: Floats, turn: float) -> Floats:
    """A unit vector across the direction ``along`` (3,), turned about it."""
    side = _unit(np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))]).astype(np.float64))
    return np.cos(turn) * side + np.sin(turn) * np.cross(along, side)


def _unit(way: Floats) -> Floats:
    return way / np.linalg.norm(way)


def main() -> None:
    """Write the file that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--height-m", type=float, default=Habit.height_m)
    parser.add_argument("--dbh-cm", type=float, default=Habit.dbh_cm)
    parser.add_argument("--cylinders", type=int, default=Habit.cylinders)
    parser.add_argument("--crown-base", type=float, default=Habit.crown_base)
    parser.add_argument("--lean", type=float, default=Habit.lean)
    parser.add_argument("--fork", type=float, default=Habit.fork)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    given = vars(parser.parse_args())
    out, seed = given.pop("out"), given.pop("seed")
    np.savetxt(out, grown(Habit(**given), seed), fmt="%.6g", delimiter=",", header=COLUMNS, comments="")


if __name__ == "__main__":
    main()
