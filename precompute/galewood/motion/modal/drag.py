"""Drag of the modal model: the pressure law at a few points of the crown, from the air's relative velocity.

Point j stands for many nodes. The wind there has the pressure P_j: that at the tree plus the gusts of the
places around. The air moves at the sheltered speed U_c(s P_j), the point at Ψ v. Its force
a (p(U_c − Ψ v) − s P_j) acts on all oscillators; the steady part a s P_j is in `load` and `place_load`. The
first oscillators (``drag_inputs``) determine Ψ v. What the motion of the nodes within a point adds is a
damping of each oscillator (docs/physics.md; `solid.fem.drag` is the same law at every node). In still air no
term drives the motion.
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
from galewood.motion.wind import pressure_per_speed, speed_of_pressure

TINY_PA = 1e-30
"""Keeps the direction of no wind finite."""


@numba.njit(cache=True, nogil=True)
def add_drag(point, inputs, outputs, rest, exponent, v, air, room, total):  # pragma: no cover  (compiled)
    """Add the drag at the velocities v (d, lanes) to total (d, lanes).

    ``air`` (2m, lanes) is the pressure of the wind at the points, Pa: along x at all of them, then along z.
    point (m, 2): area, m², and share s; inputs (3m, k) and outputs (d, 3m): Ψ, rows x of all points, then y,
    z; rest (d,) m²/kg; exponent: the streamlined one of the tree; room (3m + 2, lanes).
    """
    count = len(point)
    moved = room[: 3 * count]
    np.dot(inputs, v[: inputs.shape[1]], moved)
    mean, spare = room[3 * count], room[3 * count + 1]
    mean[:] = 0.0
    share_of = point[:, 0] / point[:, 0].sum()
    for j in range(count):
        x, y, z = moved[j], moved[count + j], moved[2 * count + j]
        own = (point[j, 0], point[j, 1], share_of[j], exponent)
        _write_point_force(own, air[j], air[count + j], x, y, z, mean, spare)
    for k in range(len(total)):
        for lane in range(len(mean)):
            total[k, lane] -= ISOTROPIC_DRAG * rest[k] * mean[lane] * v[k, lane]
    total += np.dot(outputs, moved)


@numba.njit(cache=True, nogil=True)
def _write_point_force(point, air_x, air_z, x, y, z, mean, spare):  # pragma: no cover  (compiled)
    """Replace the velocity (x, y, z) of a point by its force, and add its pressure per speed to ``mean``.

    ``point``: its area, its share of the pressure and of the area, and the streamlined exponent.
    Both laws are quadratic in weak wind. Without branches the compiler uses the SIMD lanes, so lanes of
    strong wind are counted first and corrected afterwards.
    """
    area, share, share_of, exponent = point
    strong = 0
    for lane in range(len(mean)):
        wind_pa = np.sqrt(air_x[lane] * air_x[lane] + air_z[lane] * air_z[lane])
        spare[lane] = np.sqrt(share / (HALF_AIR_DENSITY_KG_M3 * max(wind_pa, TINY_PA)))
        strong += share * wind_pa > STREAMLINING_PRESSURE_PA
    if strong:
        for lane in range(len(mean)):
            wind_pa = np.sqrt(air_x[lane] * air_x[lane] + air_z[lane] * air_z[lane])
            if share * wind_pa > STREAMLINING_PRESSURE_PA:
                spare[lane] = speed_of_pressure(share * wind_pa, exponent) / wind_pa
    strong = 0
    for lane in range(len(mean)):
        x[lane] = spare[lane] * air_x[lane] - x[lane]
        y[lane] = -y[lane]
        z[lane] = spare[lane] * air_z[lane] - z[lane]
        speed = np.sqrt(x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane])
        strong += speed > STREAMLINING_SPEED_M_S
        spare[lane] = HALF_AIR_DENSITY_KG_M3 * speed
    if strong:
        for lane in range(len(mean)):
            spare[lane] = pressure_per_speed(spare[lane] / HALF_AIR_DENSITY_KG_M3, exponent)[0]
    for lane in range(len(mean)):
        mean[lane] += share_of * spare[lane]
        x[lane] = area * (spare[lane] * x[lane] - share * air_x[lane])
        y[lane] = area * spare[lane] * y[lane]
        z[lane] = area * (spare[lane] * z[lane] - share * air_z[lane])


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
