"""Whether the numbers of a record fit the units that its file states: a wrong unit is off by factors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from galewood.measurements.motion_record.columns import UNITS, Quantity
from galewood.measurements.motion_record.gravity import GRAVITY_UNITS, levelled
from galewood.util import Floats

PLAUSIBLE_DEVIATIONS: dict[Quantity, tuple[float, float]] = {
    "strain": (1e-7, 2e-2),
    "tilt": (1e-3, 45.0),
    "acceleration": (1e-3, 50.0),
    "sway": (5e-4, 10.0),
}
"""Standard deviations that sensors resolve and trees survive, in the first unit of each quantity. Green wood
breaks at strains of about a hundredth."""


def unit_doubts(names: Sequence[str], units: Sequence[str], quantity: Quantity, values: Floats) -> list[str]:
    """A sentence for each column whose numbers make no sense in its stated unit, and in which they would.

    Args:
        names: Of the columns of motion (a).
        units: Stated unit of each; empty: none.
        quantity: What they measure.
        values: (n, a) the numbers of the file, NaN where one is missing.
    """
    return [
        doubt
        for name, unit, column in zip(names, units, values.T, strict=True)
        if unit and (doubt := _doubt(name, unit, quantity, column))
    ]


def gravity_doubt(units: Sequence[str], values: Floats) -> str | None:
    """A sentence if accelerations (n, 2 or 3) have gravity, but in another than their one stated unit."""
    if len(set(units)) != 1 or not units[0]:
        return None
    others = [unit for unit in GRAVITY_UNITS if unit != units[0]]
    found = levelled(values, others)
    if found is None or levelled(values, units) is not None:
        return None
    size = float(np.linalg.norm(np.nanmean(values, axis=0)))
    return (
        f"The mean acceleration is {size:.3g} {units[0]}, as the "
        f"file has it, which is no gravity; in {found.unit} it would be. Is the unit right?"
    )


def _doubt(name: str, unit: str, quantity: Quantity, column: Floats) -> str | None:
    known = column[np.isfinite(column)]
    deviation = float(known.std()) if len(known) else 0.0
    if quantity not in PLAUSIBLE_DEVIATIONS or deviation == 0:  # a dead sensor has no unit
        return None
    least, most = PLAUSIBLE_DEVIATIONS[quantity]
    scales = {one: scale for one, (scale, _) in UNITS[quantity].items()}
    if least <= deviation * scales[unit] <= most:
        return None
    limits = f"{least / scales[unit]:.3g} to {most / scales[unit]:.3g} {unit}"
    others = [one for one, scale in scales.items() if least <= deviation * scale <= most]
    advice = f"; in {' or '.join(others)} it would be" if others else ""
    return (
        f"The {quantity} in {name!r} has a standard deviation of {deviation:.3g} {unit}, as the file has it, "
        f"which is not plausible ({limits} is){advice}. Is the unit right?"
    )
