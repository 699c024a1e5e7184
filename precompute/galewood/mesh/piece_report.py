"""The pieces and trees of a file in the import report."""

from __future__ import annotations

from typing import Any

from galewood.mesh.classification import Classification

MOST_GROUPS = 200
"""Groups beyond this number are only counted; the largest are listed."""


def pieces_report(found: Classification, metres_per_unit: float) -> dict[str, Any]:
    """The entries "pieces", "trees" and "unsure_share" of the report (docs/design/0021-pieces.md)."""
    listed = sorted(found.groups, key=lambda group: -group.faces)[:MOST_GROUPS]
    listed = [group for group in found.groups if any(group is one for one in listed)]
    return {
        "pieces": [group.report() for group in listed],
        "pieces_unlisted": len(found.groups) - len(listed),
        "trees": [
            {
                "number": number,
                "height_m": round(float(tree.high[1] - tree.low[1]) * metres_per_unit, 3),
                "centre": [round(float(c), 4) for c in (tree.low + tree.high) / 2],
                "faces": tree.faces,
                "taken": number == found.tree,
            }
            for number, tree in enumerate(found.trees, 1)
        ],
        "unsure_share": round(found.unsure_share, 4),
    }
