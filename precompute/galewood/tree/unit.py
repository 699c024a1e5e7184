"""Unit of files that do not define it: the one in which the height is that of a tree."""

from __future__ import annotations

from dataclasses import replace

from galewood.options import MIN_HEIGHT_M, ImportRequest
from galewood.tree.axis import Choice

# plausible tree heights in each unit; the ranges do not overlap
UNIT_BANDS: tuple[tuple[str, float, float, float], ...] = (
    ("m", 1.5, 40.0, 1.0),
    ("cm", 150.0, 4_000.0, 0.01),
    ("mm", 4_000.0, 60_000.0, 0.001),
)
SPECIES_HEIGHT_M = {"poplar": 12.0, "maple": 10.0, "apricot": 5.0}
DEFAULT_HEIGHT_M = 10.0
HABITS_M = {"bonsai": (0.1, 1.2, 0.5), "pot plant": (0.15, 3.0, 1.0), "bush": (0.3, 5.0, 1.5)}
"""Plausible heights of small plants from and to, and the height of one whose unit is unknown, m."""
METRES_PER_UNIT = (("m", 1.0), ("cm", 0.01), ("mm", 0.001))


def choose_scale(
    raw_height: float,
    species: str | None,
    options: ImportRequest,
    habit: str | None = None,
    named: bool = True,
) -> tuple[float, Choice]:
    """Metres per file unit, and the reason for the choice. `habit` is a kind of small plant in HABITS_M.

    One that is not `named`, but guessed from its shape, is asked about, unless a tree would have that height.
    """
    if options.height_m is not None:
        return options.height_m / raw_height, Choice(
            "given", f"scaled to the given {options.height_m:g} m", False
        )
    if habit and (small := _small(raw_height, *HABITS_M[habit][:2], habit)):
        scale, choice = small
        sure = named or raw_height * scale >= UNIT_BANDS[0][1]
        return scale, choice if sure else replace(choice, unsure=True)
    if habit == "bonsai":
        return _scaled(raw_height, HABITS_M[habit][2], habit, unsure=True)
    for unit, low, high, metres in UNIT_BANDS:
        if low <= raw_height <= high:
            reason = f"a height of {raw_height:.4g} is plausible for a tree in {unit}"
            return metres, Choice(unit, reason, assumed=True)
    if habit:
        return _scaled(raw_height, HABITS_M[habit][2], habit, unsure=True)
    height_m = SPECIES_HEIGHT_M.get(species or "", DEFAULT_HEIGHT_M)
    return _scaled(raw_height, height_m, species or "unknown species", unsure=False)


def _small(raw_height: float, low_m: float, high_m: float, habit: str) -> tuple[float, Choice] | None:
    """The scale in the first unit in which a height is plausible for a small plant; asked unless it is m."""
    for unit, metres in METRES_PER_UNIT:
        if max(low_m, MIN_HEIGHT_M) <= raw_height * metres <= high_m:
            reason = f"a height of {raw_height:.4g} is plausible for a {habit} in {unit}"
            return metres, Choice(unit, reason, assumed=True, unsure=unit != "m")
    return None


def _scaled(raw_height: float, height_m: float, kind: str, unsure: bool) -> tuple[float, Choice]:
    reason = f"a height of {raw_height:.4g} is not plausible in any unit; scaled to {height_m:g} m ({kind})"
    return height_m / raw_height, Choice("unknown", reason, assumed=True, unsure=unsure)
