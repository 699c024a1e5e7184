"""Unit of files that do not define it: the one in which the height is that of a tree."""

from __future__ import annotations

from galewood.options import ImportRequest
from galewood.tree.axis import Choice

# plausible tree heights in each unit; the ranges do not overlap
UNIT_BANDS: tuple[tuple[str, float, float, float], ...] = (
    ("m", 1.5, 40.0, 1.0),
    ("cm", 150.0, 4_000.0, 0.01),
    ("mm", 4_000.0, 60_000.0, 0.001),
)
SPECIES_HEIGHT_M = {"poplar": 12.0, "maple": 10.0, "apricot": 5.0}
DEFAULT_HEIGHT_M = 10.0


def choose_scale(raw_height: float, species: str | None, options: ImportRequest) -> tuple[float, Choice]:
    """Metres per file unit, and the reason for the choice."""
    if options.height_m is not None:
        return options.height_m / raw_height, Choice(
            "given", f"scaled to the given {options.height_m:g} m", False
        )
    for unit, low, high, metres in UNIT_BANDS:
        if low <= raw_height <= high:
            return metres, Choice(
                unit, f"a height of {raw_height:.4g} is plausible for a tree in {unit}", assumed=True
            )
    height_m = SPECIES_HEIGHT_M.get(species or "", DEFAULT_HEIGHT_M)
    kind = species or "unknown species"
    reason = f"a height of {raw_height:.4g} is not plausible in any unit; scaled to {height_m:g} m ({kind})"
    return height_m / raw_height, Choice("unknown", reason, assumed=True)
