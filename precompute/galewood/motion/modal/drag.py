"""Drag of the modal model: the pressure law at a few points of the crown, from the air's relative velocity.

Point j stands for many nodes. The air there moves at the sheltered speed U_c(s P), the point at Ψ v. Its
force a (p(U_c − Ψ v) − s P) acts on all oscillators; the steady part a s P is in `load`. The first
oscillators (``drag_inputs``) determine Ψ v. What the motion of the nodes within a point adds is a damping of
each oscillator (docs/physics.md; `solid.fem.drag` is the same law at every node). In still air no term
drives the motion.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import numba
import numpy as np

from galewood.constants import (
    FEWEST_DRAG_INPUTS,
    HALF_AIR_DENSITY_KG_M3,
    ISOTROPIC_DRAG,
    STREAMLINING_PRESSURE_PA,
    STREAMLINING_SPEED_M_S,
)
from galewood.motion.wind import pressure_per_speed

TINY_PA = 1e-30
"""Keeps the direction of no wind finite."""


@numba.njit(cache=True, nogil=True)
def add_drag(
    point, inputs, outputs, rest, exponent, v, pressure, room, total
):  # pragma: no cover  (compiled)
    """Add the drag at the velocities v (d, lanes) in winds of pressure (2, lanes), Pa, to total (d, lanes).

    point (m, 2): area, m², and share s; inputs (3m, k) and outputs (d, 3m): Ψ, rows x of all points, then y,
    z; rest (d,) m²/kg; exponent: the streamlined one of the tree; room (3m + 6, lanes).
    """
    count = len(point)
    moved = room[: 3 * count]
    np.dot(inputs, v[: inputs.shape[1]], moved)
    air, sums = room[3 * count : 3 * count + 4], room[3 * count + 4 : 3 * count + 6]
    mean = sums[0]
    mean[:] = 0.0
    _write_air(pressure, point[:, 1].max(), exponent, air)
    share_of = point[:, 0] / point[:, 0].sum()
    for j in range(count):
        x, y, z = moved[j], moved[count + j], moved[2 * count + j]
        own = (point[j, 0], point[j, 1], share_of[j], exponent)
        _write_point_force(own, pressure, air, x, y, z, sums)
    for k in range(len(total)):
        for lane in range(len(mean)):
            total[k, lane] -= ISOTROPIC_DRAG * rest[k] * mean[lane] * v[k, lane]
    total += np.dot(outputs, moved)


@numba.njit(cache=True, nogil=True)
def _write_air(pressure, most, exponent, air):  # pragma: no cover  (compiled)
    """Of the wind's pressure: speed by the quadratic law, by the law of strong wind, and direction x, z.

    The second is only written if a share ``most`` of the pressure reaches strong wind in a lane.
    """
    strong = 0
    for lane in range(pressure.shape[1]):
        x, z = pressure[0, lane], pressure[1, lane]
        wind_pa = np.sqrt(x * x + z * z)
        back = 1.0 / max(wind_pa, TINY_PA)
        air[0, lane] = np.sqrt(wind_pa / HALF_AIR_DENSITY_KG_M3)
        air[1, lane] = wind_pa
        air[2, lane], air[3, lane] = back * x, back * z
        strong += most * wind_pa > STREAMLINING_PRESSURE_PA
    if strong:
        for lane in range(pressure.shape[1]):
            ratio = air[1, lane] / STREAMLINING_PRESSURE_PA
            air[1, lane] = STREAMLINING_SPEED_M_S * ratio ** (1.0 / exponent)


@numba.njit(cache=True, nogil=True)
def _write_point_force(point, pressure, air, x, y, z, sums):  # pragma: no cover  (compiled)
    """Replace the velocity (x, y, z) of a point by its force, and add its pressure per speed to ``sums[0]``.

    ``point``: its area, its share of the pressure and of the area, and the streamlined exponent.
    Both laws are quadratic in weak wind. Without branches the compiler uses the SIMD lanes, so lanes of
    strong wind are counted first and corrected afterwards.
    """
    area, share, share_of, exponent = point
    mean, spare = sums[0], sums[1]
    root, power = np.sqrt(share), share ** (1.0 / exponent)
    strong = 0
    for lane in range(len(mean)):
        spare[lane] = root * air[0, lane]
        strong += spare[lane] > STREAMLINING_SPEED_M_S
    if strong:
        for lane in range(len(mean)):
            if spare[lane] > STREAMLINING_SPEED_M_S:
                spare[lane] = power * air[1, lane]
    strong = 0
    for lane in range(len(mean)):
        x[lane] = spare[lane] * air[2, lane] - x[lane]
        y[lane] = -y[lane]
        z[lane] = spare[lane] * air[3, lane] - z[lane]
        speed = np.sqrt(x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane])
        strong += speed > STREAMLINING_SPEED_M_S
        spare[lane] = HALF_AIR_DENSITY_KG_M3 * speed
    if strong:
        for lane in range(len(mean)):
            spare[lane] = pressure_per_speed(spare[lane] / HALF_AIR_DENSITY_KG_M3, exponent)[0]
    for lane in range(len(mean)):
        mean[lane] += share_of * spare[lane]
        x[lane] = area * (spare[lane] * x[lane] - share * pressure[0, lane])
        y[lane] = area * spare[lane] * y[lane]
        z[lane] = area * (spare[lane] * z[lane] - share * pressure[1, lane])


def drag_inputs(oscillators: int) -> int:
    """Number of oscillators whose speed determines the velocity of the drag points: the first half."""
    return min(oscillators, max(FEWEST_DRAG_INPUTS, oscillators // 2))


def drag_tensors(drag_point, drag_shape, drag_rest, exponent):
    """The tensors (m, 2), (3, m, d), (d,) in float64, and the exponent, as ``add_drag`` uses them."""
    _, count, d = drag_shape.shape
    rows = np.asarray(drag_shape, np.float64).reshape(3 * count, d)
    inputs = np.ascontiguousarray(rows[:, : drag_inputs(d)])
    point, rest = (np.ascontiguousarray(tensor, np.float64) for tensor in (drag_point, drag_rest))
    return point, inputs, np.ascontiguousarray(rows.T), rest, float(exponent)
