"""What the names of parts add to the evidence: first a hint, then a weight that depends on other evidence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from galewood.formats import RawPart
from galewood.tree.pieces.detection.pieces import Pieces
from galewood.tree.pieces.evidence import Evidence, Mask
from galewood.tree.pieces.names import named_kind
from galewood.util import Floats

CONSISTENT_NAME_WEIGHT = 8.0  # weight of a name that the evidence does not contradict
CONTRADICTED_NAME_WEIGHT = 0.75  # weight of a name that it does contradict
CONTRADICTION_SCORE = 3.0  # score of a piece that contradicts its name
CONTRADICTS_MIXED = 1.4  # the same, if other pieces of that name strongly agree with it, or all have it
CONTRADICTION_AREA_SHARE = 0.4  # of the area that must contradict a name
SWAPPED_SCORE = 0.7  # mean score from which the names of wood and leaves are taken for swapped
COMMON_NAME_SHARE = 0.97  # of the area from which a name is that of the whole tree
COMMON_CONTRADICTION_SHARE = 0.02  # of the area that must contradict a name of the whole tree


def name_hints(parts: list[RawPart], pieces: Pieces) -> Floats:
    """A small weight for the pieces of parts that a name calls wood or leaves."""
    weights = {"wood": 1.5, "twigs": 1.5, "leaves": -1.5, None: 0.0}
    of_part = [weights[next((k for k in map(named_kind, p.labels) if k), None)] for p in parts]
    return np.array(of_part)[pieces.part]


def follow_names(evidence: Evidence, parts: list[RawPart], pieces: Pieces) -> Mask:
    """Add the names; returns which pieces are named as twigs."""
    twigs = np.zeros(len(pieces), dtype=bool)
    said = [next(((label, k) for label in p.labels if (k := named_kind(label))), None) for p in parts]
    score = evidence.score
    names = dict.fromkeys(one for one in said if one)
    swapped = _swapped(evidence.score, said, pieces)
    for name in names:
        label, kind = name
        rows = np.isin(pieces.part, [n for n, one in enumerate(said) if one == name])
        sign = -1.0 if kind == "leaves" else 1.0
        area, agrees = pieces.shapes.area, sign * score
        mixed = bool((agrees[rows] > 2 * CONTRADICTS_MIXED).any())
        common = float(area[rows].sum()) > COMMON_NAME_SHARE * float(area.sum())
        limit = CONTRADICTS_MIXED if mixed or common else CONTRADICTION_SCORE
        share = COMMON_CONTRADICTION_SHARE if common else CONTRADICTION_AREA_SHARE
        against = float(area[rows & (agrees < -limit)].sum()) > share * float(area[rows].sum())
        against = against or swapped
        evidence.add(
            rows,
            sign * (CONTRADICTED_NAME_WEIGHT if against else CONSISTENT_NAME_WEIGHT),
            f"its name {label!r}",
        )
        if kind == "twigs" and not against:
            twigs |= rows
    return twigs


def _swapped(score: Floats, said: Sequence[tuple[str, str] | None], pieces: Pieces) -> bool:
    """Whether what is called wood looks like leaves on the whole, and the other way round."""
    means: dict[bool, float] = {}
    for leafy in (True, False):
        numbers = [n for n, one in enumerate(said) if one and (one[1] == "leaves") == leafy]
        rows = np.isin(pieces.part, numbers)
        if not rows.any():
            return False
        means[leafy] = float(np.average(np.clip(score[rows], -4, 4), weights=pieces.shapes.area[rows]))
    return means[True] > SWAPPED_SCORE and means[False] < -SWAPPED_SCORE
