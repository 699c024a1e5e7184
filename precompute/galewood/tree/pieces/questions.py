"""What to ask before a tree is used: what was left out, and pieces whose kind is uncertain."""

from __future__ import annotations

from dataclasses import dataclass

from galewood.tree.pieces.groups import Group

UNSURE_SHARE = 0.1
"""Share of the faces of uncertain kind from which to ask."""
LEFT_OUT_SHARE = 0.05
"""Share of the faces from which to ask whether they are left out rightly."""
LOST_HEIGHT_SHARE = 1 / 3
"""Share of the height that is lost with them, from which to ask."""


@dataclass(frozen=True)
class Doubts:
    """Warnings, questions, and the share of the tree's faces that are uncertain."""

    warnings: list[str]
    questions: list[str]
    unsure_share: float


def doubts_of(groups: list[Group], trees: int, number: int) -> Doubts:
    """The doubts about tree `number` of a file with `trees`. What the user has chosen is certain."""
    warnings: list[str] = []
    if trees > 1:
        warnings.append(
            f"The file contains {trees} trees; tree {number} is imported. "
            "Choose another with --tree N or in the dialog."
        )
    kept = [g for g in groups if g.kind != "other"]
    left = [g for g in groups if g.kind == "other" and not g.chosen and g.tree == 0]
    if left:
        warnings.append(
            f"Left out, because it is not the tree: {_words(left)}. To keep it, choose wood or leaves for it."
        )
    unsure = sum(g.unsure_faces for g in kept) / max(sum(g.faces for g in kept), 1)
    questions = _left_out(kept, left)
    if kept and not any(g.kind == "wood" for g in kept) and not any(g.chosen for g in kept):
        questions.append("No wood was found: if any of the pieces is a trunk, choose it as wood.")
    if unsure > UNSURE_SHARE:
        questions.append(
            f"Unsure about {unsure:.0%} of the faces: check which pieces are wood and which are leaves."
        )
    return Doubts(warnings, questions, unsure)


def _left_out(kept: list[Group], left: list[Group]) -> list[str]:
    """The question about what is left out, if it is much or uncertain."""
    faces, total = sum(g.faces for g in left), sum(g.faces for g in [*kept, *left])
    if not left or not kept:
        return []
    foot = min(float(g.low[1]) for g in kept)
    top = max(float(g.high[1]) for g in kept)
    lost_height = max(float(g.high[1]) for g in left) - top
    unsure = [g for g in left if not g.sure]
    height = top - foot + lost_height
    if faces > LEFT_OUT_SHARE * total:
        why = f"{faces:,} of {total:,} faces are"
    elif lost_height > LOST_HEIGHT_SHARE * height:
        why = f"{lost_height / height:.0%} of the height is"
    elif unsure:
        why, left = "Something uncertain is", unsure
    else:
        return []
    return [
        f"{why} left out, because it seems to be no part of the tree: {_words(left)}. Check it, and choose "
        "wood or leaves for what belongs to the tree."
    ]


def _words(groups: list[Group]) -> str:
    counts: dict[str, int] = {}
    for group in groups:
        counts[group.what] = counts.get(group.what, 0) + group.faces
    return ", ".join(f"{what} ({count:,} faces)" for what, count in counts.items())
