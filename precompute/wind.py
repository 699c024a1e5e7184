"""The wind field: a speed and a heading at a place and a time, from a small document and a seed.

docs/formats/wind.md is the specification; web/src/wind.ts is the same arithmetic in TypeScript and golden
vectors hold the two together. Gusts travel with the wind, so neighbours move alike but not in unison.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

AIR_DENSITY_KG_M3 = 1.2
STREAMLINING_SPEED_M_S = 5.0
"""Beyond this speed a crown bends out of the wind and its drag grows more slowly than U²."""
STREAMLINED_EXPONENT = 1.3
"""2 + Vogel exponent (−0.7): the middle of what wind-tunnel tests of broad-leaved crowns report."""

COMPONENT_HZ = np.array([0.05, 0.087, 0.152, 0.264, 0.46, 0.8])
COMPONENT_SHARE = np.array([0.262, 0.218, 0.181, 0.15, 0.105, 0.084])
"""Amplitudes fall roughly as f^(−1/3), as the −5/3 law of velocity power asks; they sum to one."""
CROSSWIND_SHARE = np.array([0.6, -0.45, 0.75, -0.6, 0.5, -0.7])
"""Wavenumber across the wind over wavenumber along it; the signs make gusts cross one another."""
HEADING_HZ = 0.03
HEADING_SWING_RAD = math.radians(12.0)

_RANGES: dict[str, tuple[float, float]] = {
    "mean_speed_m_s": (0.0, 60.0),
    "direction_deg": (-360.0, 360.0),
    "gustiness": (0.0, 1.0),
    "convection_speed_m_s": (0.5, 60.0),
    "seed": (0.0, 4294967295.0),
}


class WindError(ValueError):
    """A wind document that cannot be read; the message names the field and the range."""


@dataclass(frozen=True)
class Wind:
    """A wind document, version 1, model "cosine"."""

    mean_speed_m_s: float = 8.0
    direction_deg: float = 30.0
    gustiness: float = 0.5
    convection_speed_m_s: float = 8.0
    seed: int = 1

    def document(self) -> dict[str, object]:
        """The JSON object that ``parse_wind`` reads back."""
        return {"version": 1, "model": "cosine", **{name: getattr(self, name) for name in _RANGES}}


def parse_wind(document: object) -> Wind:
    """Read a wind document; WindError names the offending field and its range."""
    if not isinstance(document, Mapping):
        raise WindError("wind: expected an object")
    _refuse_unknown(document)
    if document.get("version") != 1 or isinstance(document.get("version"), bool):
        raise WindError(f"wind.version: this reader knows version 1, not {document.get('version')!r:.40}")
    if document.get("model") != "cosine":
        raise WindError(f'wind.model: expected "cosine", not {document.get("model")!r:.40}')
    numbers = {name: _number(document, name) for name in _RANGES}
    if numbers["seed"] != int(numbers["seed"]):
        raise WindError("wind.seed: expected a whole number in 0..4294967295")
    return Wind(
        numbers["mean_speed_m_s"],
        numbers["direction_deg"],
        numbers["gustiness"],
        numbers["convection_speed_m_s"],
        int(numbers["seed"]),
    )


def _refuse_unknown(document: Mapping[object, object]) -> None:
    for name in document:
        if name not in _RANGES and name not in ("version", "model"):
            raise WindError(f"wind.{name!s:.40}: unknown field")


def _number(document: Mapping[object, object], name: str) -> float:
    low, high = _RANGES[name]
    expected = f"expected a number in {low:g}..{high:.10g}"
    if name not in document:
        raise WindError(f"wind.{name}: missing, {expected}")
    value = document[name]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise WindError(f"wind.{name}: {expected}")
    if not low <= value <= high:  # also refuses NaN
        raise WindError(f"wind.{name}: {expected}, not {value!r:.40}")
    return float(value)


def phase_rad(seed: int, component: int) -> float:
    """Phase of a component from a 32-bit hash (Mueller's integer finaliser) of (seed, component)."""
    h = (seed + 0x9E3779B9 * (component + 1)) & 0xFFFFFFFF
    for _ in range(2):
        h = ((h ^ (h >> 16)) * 0x45D9F3B) & 0xFFFFFFFF
    return (h ^ (h >> 16)) * (2.0 * math.pi / 4294967296.0)


def _travelling(wind: Wind, x_m: Floats, z_m: Floats, time_s: float) -> tuple[Floats, Floats]:
    """Age of the air at each place (s) and its place across the wind (in seconds of travel)."""
    heading = math.radians(wind.direction_deg)
    c, s = math.cos(heading), math.sin(heading)
    age_s = time_s - (c * x_m + s * z_m) / wind.convection_speed_m_s
    across_s = (c * z_m - s * x_m) / wind.convection_speed_m_s
    return age_s, across_s


def wind_speed(wind: Wind, x_m: npt.ArrayLike, z_m: npt.ArrayLike, time_s: float) -> tuple[Floats, Floats]:
    """Speed (m/s, ≥ 0) and heading (rad, the direction blown towards) at each place."""
    x, z = np.asarray(x_m, np.float64), np.asarray(z_m, np.float64)
    age_s, across_s = _travelling(wind, x, z, time_s)
    ripple = np.zeros(np.broadcast(x, z).shape)
    for k in range(6):
        omega = 2.0 * math.pi * COMPONENT_HZ[k]
        angle = omega * (age_s + CROSSWIND_SHARE[k] * across_s) + phase_rad(wind.seed, k)
        ripple = ripple + COMPONENT_SHARE[k] * np.cos(angle)
    speed = wind.mean_speed_m_s * np.maximum(0.0, 1.0 + wind.gustiness * ripple)
    swing = np.cos(2.0 * math.pi * HEADING_HZ * (age_s + 0.5 * across_s) + phase_rad(wind.seed, 6))
    heading = math.radians(wind.direction_deg) + wind.gustiness * HEADING_SWING_RAD * swing
    return speed, heading


def dynamic_pressure(speed_m_s: npt.ArrayLike) -> Floats:
    """Effective dynamic pressure (Pa): ½ρU² up to 5 m/s, growing as U^1.3 beyond (streamlining)."""
    speed = np.asarray(speed_m_s, np.float64)
    start = 0.5 * AIR_DENSITY_KG_M3 * STREAMLINING_SPEED_M_S**2
    streamlined = start * (speed / STREAMLINING_SPEED_M_S) ** STREAMLINED_EXPONENT
    return np.where(speed <= STREAMLINING_SPEED_M_S, 0.5 * AIR_DENSITY_KG_M3 * speed * speed, streamlined)


def wind_pressure(
    wind: Wind,
    x_m: npt.ArrayLike,
    z_m: npt.ArrayLike,
    time_s: float,
    out_x_pa: npt.NDArray[np.float32],
    out_z_pa: npt.NDArray[np.float32],
) -> None:
    """Write the pressure vector (Pa, world x and z) at each place; exactly 0 where the wind is still."""
    speed, heading = wind_speed(wind, x_m, z_m, time_s)
    pressure = dynamic_pressure(speed)
    out_x_pa[:] = pressure * np.cos(heading)
    out_z_pa[:] = pressure * np.sin(heading)
