"""Deviation of the fast model from the reference: first frequencies and one trajectory."""

from typing import Any

import numpy as np

from galewood.solid.fem import FemModel, Simulator, solve_static
from galewood.util import Floats

SWAY_HEIGHT_SHARE = 0.04
"""Largest static displacement, relative to the height, under the gusts of the comparison.

They oscillate near the first frequency, so a slender tree reaches five times as much, a fifth of its height.
"""


def compare(fast: FemModel, reference: FemModel, frames: int) -> dict[str, Any]:
    """Ratios of the first ten frequencies; largest vertex error relative to the largest displacement."""
    ratio = np.array(fast.report["frequencies_hz"]) / np.array(reference.report["frequencies_hz"])
    pressure = gusty_pressure(fast, frames)
    return {
        "frequencies_hz": reference.report["frequencies_hz"],
        "frequency_ratio": [float(r) for r in ratio],
        "frequency_error": float(np.abs(ratio - 1).max()),
        "frames": frames,
        "trajectory_error": trajectory_difference(fast, reference, pressure),
    }


def gusty_pressure(model: FemModel, frames: int) -> Floats:
    """(frames,2) Pa: a wind that increases for a second, then rotates and oscillates near the first
    frequency.
    """
    time = np.arange(frames) * model.settings.dt_s
    first_hz = float(model.report["frequencies_hz"][0])
    swell = np.minimum(time, 1.0)
    pulse = swell * (0.6 + 0.4 * np.sin(2 * np.pi * first_hz * time))
    heading = 0.5 * np.sin(2 * np.pi * 0.3 * first_hz * time)
    return static_pressure(model, SWAY_HEIGHT_SHARE) * np.column_stack(
        [pulse * np.cos(heading), pulse * np.sin(heading)]
    )


def static_pressure(model: FemModel, sway: float) -> float:
    """Pressure, Pa, whose linear static displacement is this fraction of the height (wind along x)."""
    unit = np.zeros_like(model.nodes_m)
    unit[:, 0] = model.drag_area_m2 if model.drag_area_m2.any() else model.mass_kg
    height_m = float(np.ptp(model.nodes_m[:, 1]))
    weight = float(np.abs(model.gravity_n).sum()) or 1.0
    small = 1e-4 * weight / float(unit.sum())
    u, _, _ = solve_static(model.system(), small * unit)
    return sway * height_m / float(np.abs(u).max()) * small


def trajectory_difference(first: FemModel, second: FemModel, pressure_pa: Floats) -> float:
    """Largest vertex distance between the two models, relative to the second one's largest displacement."""
    one, other = Simulator(first), Simulator(second)
    apart = largest = 0.0
    for pressure in pressure_pa:
        one.step(pressure)
        other.step(pressure)
        apart = max(apart, float(np.linalg.norm(one.u - other.u, axis=1).max()))
        largest = max(largest, float(np.linalg.norm(other.u, axis=1).max()))
    return apart / largest if largest else 0.0
