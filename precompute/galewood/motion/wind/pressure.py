"""Wind pressure on a tree as a function of speed, and how much of it the table covers."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math

import numba
import numpy as np
import numpy.typing as npt

from galewood.constants import (
    HALF_AIR_DENSITY_KG_M3,
    PRESSURE_COMPRESSION,
    STREAMLINING_PRESSURE_PA,
    STREAMLINING_SPEED_M_S,
)
from galewood.util import Array, Floats


def dynamic_pressure(speed_m_s: npt.ArrayLike, exponent: float | Floats) -> Floats:
    """Effective dynamic pressure (Pa): ½ρU² up to 5 m/s, proportional to U^exponent above (streamlining).

    Here and below ``exponent`` is the tree's streamlined exponent, 1 … 2; at 2 the law is one parabola.
    """
    speed = np.asarray(speed_m_s, np.float64)
    streamlined = STREAMLINING_PRESSURE_PA * (speed / STREAMLINING_SPEED_M_S) ** exponent
    return np.where(speed <= STREAMLINING_SPEED_M_S, HALF_AIR_DENSITY_KG_M3 * speed * speed, streamlined)


@numba.njit(cache=True, nogil=True)
def pressure_per_speed(speed_m_s, exponent):  # pragma: no cover  (compiled)
    """Dynamic pressure over speed, Pa·s/m, and the exponent with which the pressure grows at that speed."""
    if speed_m_s <= STREAMLINING_SPEED_M_S:
        return HALF_AIR_DENSITY_KG_M3 * speed_m_s, 2.0
    start = HALF_AIR_DENSITY_KG_M3 * STREAMLINING_SPEED_M_S
    ratio = speed_m_s / STREAMLINING_SPEED_M_S
    return start * ratio ** (exponent - 1.0), exponent


@numba.njit(cache=True, nogil=True)
def speed_of_pressure(pressure_pa, exponent):  # pragma: no cover  (compiled)
    """Inverse of ``dynamic_pressure``: the speed, m/s, of a dynamic pressure of at least 0 Pa."""
    if pressure_pa <= STREAMLINING_PRESSURE_PA:
        return math.sqrt(pressure_pa / HALF_AIR_DENSITY_KG_M3)
    return STREAMLINING_SPEED_M_S * (pressure_pa / STREAMLINING_PRESSURE_PA) ** (1.0 / exponent)


@numba.njit(cache=True, nogil=True)
def pressure_of_velocity(velocity_x, velocity_z, factor, exponent):  # pragma: no cover  (compiled)
    """Convert velocities (m/s) to pressure vectors (Pa) in place, with factor and exponent of each tree.

    A factor is that of the height, by which the velocity is scaled.
    """
    for i in range(len(velocity_x)):
        vx, vz = velocity_x[i] * factor[i], velocity_z[i] * factor[i]
        # multiplying by pressure over speed keeps the direction of the velocity
        per_speed = pressure_per_speed(math.sqrt(vx * vx + vz * vz), exponent[i])[0]
        velocity_x[i] = per_speed * vx
        velocity_z[i] = per_speed * vz


def height_factor(height_m: npt.ArrayLike, exponent: float, reference_height_m: float) -> Floats:
    """Ratio of the speed at a height (m) to that at the reference height: power-law profile over a canopy."""
    return (np.asarray(height_m, np.float64) / reference_height_m) ** exponent


def to_tree_frame(pressure_x: Floats, pressure_z: Floats, yaw_rad: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Rotate world pressure (Pa) into the frames of trees with the given yaw (three.js rotation.y, rad)."""
    c, s = np.cos(np.asarray(yaw_rad, np.float64)), np.sin(np.asarray(yaw_rad, np.float64))
    return c * pressure_x - s * pressure_z, s * pressure_x + c * pressure_z


@numba.njit(cache=True, nogil=True)
def compressed(ratio):  # pragma: no cover  (compiled)
    """Pressure over the strongest sampled one, compressed where it is above 1: it grows with the logarithm.

    Value and slope are continuous, and stronger wind always moves a tree farther.
    """
    if ratio <= 1.0:
        return ratio
    return 1.0 + PRESSURE_COMPRESSION * math.log(1.0 + (ratio - 1.0) / PRESSURE_COMPRESSION)


@numba.njit(cache=True, nogil=True)
def compress_pressure(
    pressure_x: Array, pressure_z: Array, peak: Floats, most_pa: Floats, ratio: Array
) -> None:  # pragma: no cover  (compiled)
    """Compress pressures in place to the range of tables whose strongest sampled pressure is most_pa (n,).

    A wind whose gusts exceed the range is scaled as a whole, by what its strongest gust, ``peak`` (n,) Pa,
    requires: if only the gusts were compressed, a storm would sway trees less than a breeze. What exceeds
    even that gust is compressed in turn. Writes the pressure before over most_pa to ``ratio`` (n,).
    """
    for i in range(len(pressure_x)):
        strength = math.sqrt(float(pressure_x[i]) ** 2 + float(pressure_z[i]) ** 2) / most_pa[i]
        ratio[i] = strength
        strongest = max(peak[i] / most_pa[i], 1.0)
        most = compressed(strongest)
        scale = most / strongest
        if strength > strongest:
            scale = most * compressed(strength / strongest) / strength
        if scale != 1.0:
            pressure_x[i] *= scale
            pressure_z[i] *= scale


@numba.njit(cache=True, nogil=True)
def limit_pressure(
    pressure_x: Array, pressure_z: Array, peak_pa: float
) -> None:  # pragma: no cover  (compiled)
    """Clamp pressures in place to the magnitude of the strongest one in the table, keeping their direction.

    Above it every record would be an equally poor match, and trees would no longer respond to the direction.
    """
    for i in range(len(pressure_x)):
        strength = math.sqrt(float(pressure_x[i]) ** 2 + float(pressure_z[i]) ** 2)
        if strength > peak_pa:
            pressure_x[i] *= peak_pa / strength
            pressure_z[i] *= peak_pa / strength


def coverage(pressure_x: Floats, pressure_z: Floats, peak_pa: float) -> float:
    """Share (0 … 1) of the given pressures that do not exceed the strongest pressure in the table."""
    if len(pressure_x) == 0:
        return 1.0
    return float(np.mean(pressure_x * pressure_x + pressure_z * pressure_z <= peak_pa * peak_pa))
