"""A scanned tree from the bytes of a cylinder model: tubes of wood, leaf cards, and a report."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from galewood.formats.qsm.branches import (
    TRUNK_PARENT,
    Branch,
    Line,
    branch_lines,
    chained,
    diameter_at_breast_height,
    smoothed_radii,
)
from galewood.formats.qsm.cylinders import Cylinders, checked_tree
from galewood.formats.qsm.leaves import leaf_cards, leafy_end
from galewood.formats.qsm.tables import read_table
from galewood.formats.qsm.treeqsm import read_treeqsm
from galewood.formats.qsm.trunk import check_trunk, trunk_warnings
from galewood.formats.qsm.tubes import tube, tube_faces
from galewood.formats.types import Material, RawPart
from galewood.options import Axis, ImportRequest
from galewood.util import Floats, MeshError

Z_UP: dict[Axis, tuple[list[int], list[float]]] = {
    "x": ([1, 2, 0], [1, 1, 1]), "y": ([2, 0, 1], [1, 1, 1]), "z": ([0, 1, 2], [1, 1, 1]),
    "-x": ([1, 2, 0], [1, -1, -1]), "-y": ([2, 0, 1], [1, -1, -1]), "-z": ([0, 1, 2], [1, -1, -1]),
}  # fmt: skip
"""Order of the coordinates, and their signs, with which the given axis becomes +Z, without mirroring."""
QsmFormat = Literal["treeqsm", "csv"]
MIN_RADIUS_MM = 10.0
MOST_BRANCHES = 200
"""Branches up to which thin ones are kept; more are not resolved by the mesher at its usual size."""
MOST_FACES = 60_000
MANY_BRANCHES = 300
"""More than these cannot be meshed without being thickened (docs/how-to/scanned-trees.md)."""
SPACINGS = (1.5, 2.0, 3.0, 4.5, 7.0, 10.0, 15.0, 25.0)
"""Distances of the rings of a tube, relative to its radius: the first with few enough faces."""
BARK_MATERIAL = Material(
    {
        "name": "bark",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.14, 0.115, 0.095, 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.95,
        },
    }
)


@dataclass(frozen=True)
class ScannedTree:
    """Parts of a scanned tree (wood first) in the axes of the file, in metres; what was found and assumed."""

    parts: list[RawPart]
    report: dict[str, Any]
    warnings: list[str]


def read_qsm(data: bytes, file_format: QsmFormat, options: ImportRequest) -> ScannedTree:
    """The tree of a cylinder model. Raises MeshError if it is damaged or is not one tree."""
    raw, models = read_treeqsm(data) if file_format == "treeqsm" else (read_table(data), 1)
    order, signs = Z_UP[options.up_axis or "z"]
    raw = replace(raw, start_m=raw.start_m[:, order] * signs, end_m=raw.end_m[:, order] * signs)
    if options.height_m is not None and raw.height_m > 0:
        raw = raw.scaled(options.height_m / raw.height_m)
    tree, loose = checked_tree(raw)
    branches = chained(tree)
    tree, dbh_m = _fitted(tree, branches[0], options.dbh_cm)
    check_trunk(tree, branches[0])
    least_mm, kept = _thick_enough(tree, branches, options.min_radius_mm)
    lines = _lines(tree, [branches[number] for number in kept], kept)
    parts = [_wood(lines)]
    if options.add_leaves is not False:
        parts.append(_leaves(tree, branches, kept, lines, dbh_m))
    report = {
        "cylinders": len(tree.radius_m),
        "branches": len(branches),
        "height_m": tree.height_m,
        "dbh_cm": None if dbh_m is None else 100 * dbh_m,
        "wood_volume_m3": float(tree.volume_m3.sum()),
        "min_radius_mm": least_mm,
        "dropped": _dropped(tree, branches, kept, loose),
    }
    warnings = _warnings(report, models, options) + trunk_warnings(tree, branches[0])
    return ScannedTree([_in_axes_of_file(part, order, signs) for part in parts], report, warnings)


def _in_axes_of_file(part: RawPart, order: list[int], signs: list[float]) -> RawPart:
    """The part with its coordinates in the order of the file."""
    back = np.argsort(order)
    normals = None if part.normals is None else (part.normals * signs)[:, back]
    return replace(part, positions=(part.positions * signs)[:, back], normals=normals)


def _fitted(tree: Cylinders, trunk: Branch, dbh_cm: float | None) -> tuple[Cylinders, float | None]:
    """The tree with its radii scaled to the given diameter at breast height, and that diameter, m."""
    dbh_m = diameter_at_breast_height(tree, trunk)
    if dbh_cm is None:
        return tree, dbh_m
    if dbh_m is None:
        raise MeshError(
            "no-breast-height",
            "unsuitable",
            "The trunk does not reach breast height (1.3 m), so its diameter there cannot be fitted.",
            "Omit the diameter at breast height.",
        )
    return replace(tree, radius_m=tree.radius_m * (dbh_cm / 100 / dbh_m)), dbh_cm / 100


def _thick_enough(
    tree: Cylinders, branches: list[Branch], min_radius_mm: float | None
) -> tuple[float, list[int]]:
    """The smallest radius, mm, and the numbers of the branches that are kept.

    A branch is kept if it is as thick, or has such a branch on it. If no radius is given, it is 10 mm, or as
    much larger as leaves few enough branches.
    """
    thickest = np.array([smoothed_radii(tree, branch.cylinders)[0] for branch in branches])
    for number in range(len(branches) - 1, 0, -1):
        parent = branches[number].parent
        thickest[parent] = max(thickest[parent], thickest[number])
    least = _chosen_mm(thickest, min_radius_mm) / 1000
    kept = np.flatnonzero(thickest >= least)
    if not len(kept):
        raise MeshError(
            "all-thin",
            "unsuitable",
            f"Every branch is thinner than the smallest radius, {1000 * least:g} mm.",
            "Choose a smaller one (--min-radius-mm), and check that the model is in metres.",
        )
    return 1000 * least, kept.tolist()


def _chosen_mm(thickest_m: Floats, min_radius_mm: float | None) -> float:
    """The smallest radius, mm, for branches of at most these radii (n,), m."""
    if min_radius_mm is not None:
        return min_radius_mm
    if len(thickest_m) <= MOST_BRANCHES:
        return MIN_RADIUS_MM
    limit = 1000 * float(np.sort(thickest_m)[-MOST_BRANCHES - 1])
    return max(MIN_RADIUS_MM, float(np.ceil(2 * limit) / 2))


def _lines(tree: Cylinders, branches: list[Branch], kept: list[int]) -> list[Line]:
    """Lines of the kept branches, with so few points that their tubes stay within the number of faces."""
    number = {old: new for new, old in enumerate(kept)} | {TRUNK_PARENT: TRUNK_PARENT}
    renumbered = [replace(branch, parent=number[branch.parent]) for branch in branches]
    lines: list[Line] = []
    for spacing in SPACINGS:
        lines = branch_lines(tree, renumbered, spacing)
        if sum(tube_faces(line) for line in lines) <= MOST_FACES:
            break
    return lines


def _wood(lines: list[Line]) -> RawPart:
    tubes = [tube(line) for line in lines]
    offsets = np.cumsum([0, *(len(vertices) for vertices, _ in tubes[:-1])])
    faces = [own + offset for (_, own), offset in zip(tubes, offsets, strict=True)]
    return RawPart(
        labels=("wood",),
        positions=np.concatenate([vertices for vertices, _ in tubes]),
        faces=np.concatenate(faces).astype(np.int32),
        material=BARK_MATERIAL,
    )


def _leaves(
    tree: Cylinders, branches: list[Branch], kept: list[int], lines: list[Line], dbh_m: float | None
) -> RawPart:
    """Leaves along the thin ends of the kept branches, and where a dropped one leaves them."""
    there = set(kept)
    twigs = [
        branch.cylinders[0]
        for number, branch in enumerate(branches)
        if number not in there and branch.parent in there
    ]
    ends = [leafy_end(line, tree.height_m) for line in lines]
    places = np.vstack([*(place for place, _ in ends), tree.start_m[twigs]])
    way = np.vstack([*(way for _, way in ends), (tree.end_m - tree.start_m)[twigs]])
    direction = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
    return leaf_cards(places, direction, dbh_m or 2 * float(lines[0].radius_m[0]), tree.height_m)


def _dropped(tree: Cylinders, branches: list[Branch], kept: list[int], loose: int) -> dict[str, Any]:
    there = set(kept)
    thin = [branch.cylinders for number, branch in enumerate(branches) if number not in there]
    own = np.concatenate([np.zeros(0, np.int64), *thin])
    return {
        "loose_cylinders": loose,
        "thin_branches": len(thin),
        "thin_cylinders": len(own),
        "thin_volume_m3": float(tree.volume_m3[own].sum()),
    }


def _warnings(report: dict[str, Any], models: int, options: ImportRequest) -> list[str]:
    found: list[str] = []
    dropped = report["dropped"]
    if models > 1:
        found.append(f"The file has {models} models of the tree; the first is used.")
    if dropped["loose_cylinders"]:
        found.append(
            f"{dropped['loose_cylinders']} cylinders have no connection with the trunk and were dropped."
        )
    if dropped["thin_branches"]:
        found.append(
            f"{dropped['thin_branches']} branches thinner than the smallest radius "
            f"({report['min_radius_mm']:g} mm) were dropped "
            f"({dropped['thin_volume_m3'] / report['wood_volume_m3']:.1%} of the volume); they weigh on "
            "their limbs, with a mass estimated from the trunk."
        )
    if report["branches"] - dropped["thin_branches"] > MANY_BRANCHES:
        found.append(
            "With so many branches, thin ones are simulated thicker and heavier than they are, and the tree "
            "sways too slowly. Without --min-radius-mm, only as many are kept as can be simulated."
        )
    if options.add_leaves is not False:
        found.append("A scan has no leaves: they were added, with an assumed area.")
    return found
