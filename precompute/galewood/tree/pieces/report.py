"""The pieces and trees of a file in the import report."""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.tree.pieces.classification import Classification
from galewood.tree.pieces.classified_part import ClassifiedPart
from galewood.tree.types import KINDS
from galewood.util import Ints

MOST_GROUPS = 200
"""Of more groups than this, the largest are listed."""
MOST_RUNS = 4000


def pieces_report(
    found: Classification, parts: list[ClassifiedPart], metres_per_unit: float
) -> dict[str, Any]:
    """The entries "pieces", "trees", "unsure_share" and "vertex_pieces" of the report.

    docs/design/0021-pieces.md describes them. `parts` are those that are drawn.
    """
    order = sorted(range(len(found.groups)), key=lambda k: -found.groups[k].faces)[:MOST_GROUPS]
    listed = sorted(order)
    row = np.full(len(found.groups) + 1, -1, dtype=np.int32)  # the last is for vertices without a group
    row[listed] = np.arange(len(listed))
    names = tree_names(found)
    return {
        "pieces": [found.groups[k].report() for k in listed],
        "pieces_unlisted": len(found.groups) - len(listed),
        "vertex_pieces": _vertex_pieces(parts, row),
        "trees": [
            {
                "number": number,
                "name": names[number - 1],
                "height_m": round(float(tree.high[1] - tree.low[1]) * metres_per_unit, 3),
                "centre": [round(float(c), 4) for c in (tree.low + tree.high) / 2],
                "faces": tree.faces,
                "taken": number == found.tree,
            }
            for number, tree in enumerate(found.trees, 1)
        ],
        "unsure_share": round(found.unsure_share, 4),
    }


def tree_names(found: Classification) -> list[str]:
    """A name for each tree: of the names that no other tree has, that of most faces; "" if there is none."""
    faces: dict[str, dict[int, int]] = {}
    for group in found.groups:
        for label in set(group.labels) if group.tree else ():
            of_tree = faces.setdefault(label, {})
            of_tree[group.tree] = of_tree.get(group.tree, 0) + group.faces
    own = {label: of_tree for label, of_tree in faces.items() if len(of_tree) == 1}
    names: list[str] = []
    for number in range(1, len(found.trees) + 1):
        mine = [label for label, of_tree in own.items() if number in of_tree]
        names.append(max(mine, key=lambda label: own[label][number], default=""))
    return names


def _vertex_pieces(parts: list[ClassifiedPart], row: Ints) -> list[list[int]]:
    """For each drawn primitive, runs of vertices: entry of "pieces", number, entry, number, …

    Empty if that would be long: clicks on a preview then choose nothing.
    """
    runs: list[list[int]] = []
    for kind in KINDS:
        for part in (p for p in parts if p.kind == kind):
            entry = row[part.vertex_groups]
            starts = np.concatenate([[0], np.flatnonzero(np.diff(entry)) + 1])
            lengths = np.diff(np.append(starts, len(entry)))
            runs.append(np.column_stack([entry[starts], lengths]).reshape(-1).tolist())
    return runs if sum(map(len, runs)) <= 2 * MOST_RUNS else []
