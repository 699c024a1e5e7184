"""The cylinders of a scanned tree: one form for all file formats, and the checks that all must pass."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from galewood.options import MAX_HEIGHT_M, MIN_HEIGHT_M
from galewood.util import Floats, Int64s, MeshError

MAX_CYLINDERS = 20_000
NO_CYLINDER = -1
LOOSE_SHARE = 0.01
"""Largest share of the volume in cylinders that no parent connects with the tree; they are dropped."""
WIDEST_GAP = 0.2
"""Largest gap between a cylinder and its parent, relative to the height of the tree."""


@dataclass(frozen=True)
class Cylinders:
    """A quantitative structure model: n cylinders, z up, in metres.

    start_m and end_m (n, 3) are the ends of the axes, radius_m (n,) the radii. parent (n,) is the cylinder
    that each grows from, extension (n,) the one that continues it in the same branch; −1: none.
    """

    start_m: Floats
    end_m: Floats
    radius_m: Floats
    parent: Int64s
    extension: Int64s

    @property
    def length_m(self) -> Floats:
        """(n,) length of each cylinder, m."""
        return np.linalg.norm(self.end_m - self.start_m, axis=1)

    @property
    def volume_m3(self) -> Floats:
        """(n,) volume of each cylinder, m³."""
        return np.pi * self.radius_m**2 * self.length_m

    @property
    def height_m(self) -> float:
        """Height of the highest axis above the base of the lowest, m."""
        z = np.concatenate([self.start_m[:, 2], self.end_m[:, 2]])
        return float(np.ptp(z))

    def scaled(self, factor: float) -> Cylinders:
        """The same tree, larger by a factor, about the origin."""
        return replace(
            self,
            start_m=self.start_m * factor,
            end_m=self.end_m * factor,
            radius_m=self.radius_m * factor,
        )


def check_count(count: int) -> None:
    """Raise MeshError if a file has no cylinders, or more than a build can use."""
    if count == 0:
        raise MeshError(
            "no-cylinders", "unsuitable", "The file contains no cylinders.", "Export the whole model again."
        )
    if count > MAX_CYLINDERS:
        raise MeshError(
            "too-many-cylinders",
            "too-large",
            f"The model has {count} cylinders, more than the limit of {MAX_CYLINDERS}.",
            "Reconstruct the tree with longer cylinders, or leave out its twigs.",
        )


def checked_tree(raw: Cylinders) -> tuple[Cylinders, int]:
    """The cylinders that form one tree, and how many loose ones were dropped.

    The number of cylinders has been checked. Raises MeshError for impossible numbers, parents that do not
    exist, cycles, several trees, and cylinders far from their parents.
    """
    _check_numbers(raw)
    _check_parents(raw)
    base = _base_of(raw.parent)
    tree, loose = _largest_tree(replace(raw, extension=_extensions(raw)), base)
    _check_size(tree)
    _check_gaps(tree)
    return tree, loose


def _check_numbers(raw: Cylinders) -> None:
    finite = np.isfinite(np.column_stack([raw.start_m, raw.end_m, raw.radius_m])).all(axis=1)
    if not finite.all():
        raise MeshError(
            "cylinder-not-finite",
            "unsuitable",
            f"{int((~finite).sum())} cylinders have numbers that are missing or not finite "
            f"(the first is cylinder {int(np.argmin(finite)) + 1}).",
            "Remove them in the program that made the model and export it again.",
        )
    thin = raw.radius_m <= 0
    if thin.any():
        raise MeshError(
            "cylinder-radius",
            "unsuitable",
            f"{int(thin.sum())} cylinders have no positive radius "
            f"(the first is cylinder {int(np.argmax(thin)) + 1}).",
            "Remove or refit them and export the model again.",
        )


def _check_parents(raw: Cylinders) -> None:
    count = len(raw.parent)
    broken = (raw.parent < NO_CYLINDER) | (raw.parent >= count)
    if broken.any():
        raise MeshError(
            "cylinder-parent",
            "unsuitable",
            f"{int(broken.sum())} cylinders name a parent that does not exist "
            f"(the first is cylinder {int(np.argmax(broken)) + 1}).",
            "Export the whole model again, with all its cylinders.",
        )
    if not (raw.parent == NO_CYLINDER).any():
        raise _cycle(0)


def _extensions(raw: Cylinders) -> Int64s:
    """The extensions (n,) that grow from the cylinder that they continue; −1 for the others."""
    there = np.clip(raw.extension, 0, len(raw.parent) - 1)
    fits = (raw.extension == there) & (raw.parent[there] == np.arange(len(there)))
    return np.where(fits, there, NO_CYLINDER)


def _base_of(parent: Int64s) -> Int64s:
    """The cylinder without a parent (n,) from which each grows. Raises MeshError if there is a cycle."""
    base = np.where(parent == NO_CYLINDER, np.arange(len(parent)), parent)
    for _ in range(int(np.ceil(np.log2(max(len(parent), 2)))) + 1):
        base = base[base]
    endless = parent[base] != NO_CYLINDER
    if endless.any():
        raise _cycle(int(np.argmax(endless)))
    return base


def _cycle(first: int) -> MeshError:
    return MeshError(
        "cylinder-cycle",
        "unsuitable",
        f"The parents of the cylinders form a cycle (cylinder {first + 1} is in it or grows from it).",
        "Export the model again; every cylinder must lead to the base of the trunk.",
    )


def _largest_tree(raw: Cylinders, base: Int64s) -> tuple[Cylinders, int]:
    """The cylinders that grow from the largest base. A few loose ones are dropped, more are refused."""
    volume = np.bincount(base, raw.volume_m3, len(base))
    kept = base == int(np.argmax(volume))
    share = 1.0 - float(volume.max()) / max(float(volume.sum()), 1e-300)
    if share > LOOSE_SHARE:
        raise MeshError(
            "several-roots",
            "unsuitable",
            f"{len(np.unique(base))} cylinders have no parent, so the model is not one tree; "
            f"{share:.0%} of its volume is not connected with the largest trunk.",
            "Export each tree to a file of its own, or connect its parts.",
        )
    return subset(raw, kept), int((~kept).sum())


def subset(raw: Cylinders, kept: np.ndarray[Any, np.dtype[np.bool_]]) -> Cylinders:
    """The chosen cylinders (n,), renumbered; links to the others become −1."""
    number = np.where(kept, np.cumsum(kept) - 1, NO_CYLINDER)
    extended = np.append(number, NO_CYLINDER)  # −1 stays −1
    return Cylinders(
        raw.start_m[kept],
        raw.end_m[kept],
        raw.radius_m[kept],
        extended[raw.parent[kept]],
        extended[raw.extension[kept]],
    )


def _check_size(tree: Cylinders) -> None:
    if not MIN_HEIGHT_M <= tree.height_m <= MAX_HEIGHT_M:
        raise MeshError(
            "cylinder-unit",
            "unsuitable",
            f"The model is {tree.height_m:.4g} m high, which no tree is.",
            "Coordinates and radii must be in metres, with z pointing up. Export the model again, or give "
            "the height of the tree (--height-m): radii are then scaled with the coordinates.",
        )


def _check_gaps(tree: Cylinders) -> None:
    child = np.flatnonzero(tree.parent != NO_CYLINDER)
    own = tree.parent[child]
    foot = foot_on(tree.start_m[own], tree.end_m[own], tree.start_m[child])
    gap = np.linalg.norm(foot - tree.start_m[child], axis=1)
    far = gap > WIDEST_GAP * tree.height_m
    if far.any():
        raise MeshError(
            "cylinder-gap",
            "unsuitable",
            f"{int(far.sum())} cylinders are far from the one that they grow from (up to {gap.max():.3g} m).",
            "Their parents are wrong, or parts of the model are missing: export it again.",
        )


def foot_on(start: Floats, end: Floats, place: Floats) -> Floats:
    """The point (k, 3) of each line from start to end (k, 3) that is nearest to a place (k, 3)."""
    along = end - start
    squared = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    share = np.clip(np.einsum("ij,ij->i", place - start, along) / squared, 0.0, 1.0)
    return start + share[:, None] * along
