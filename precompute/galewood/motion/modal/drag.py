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
from galewood.motion.modal.lanes import add_product, of_lane, write_product
from galewood.motion.wind import pressure_per_speed, speed_of_pressure
from galewood.util import Array, Floats

TINY_PA = 1e-30
"""Keeps the direction of no wind finite."""


@numba.njit(cache=True, nogil=True)
def add_drag(point, inputs, outputs, rest, exponent, v, air, room, total):  # pragma: no cover  (compiled)
    """Add the drag at the velocities v (d, lanes) to total (d, lanes).

    ``air`` (2m, lanes) is the pressure of the wind at the points, Pa: along x at all of them, then along z.
    point (m, 3): area, m², share s, and share of the whole area; inputs (3m, k) and outputs (d, 3m): Ψ, rows
    x of all points, then y, z; rest (d,) m²/kg; exponent: the streamlined one of the tree; room
    (3m + 2, lanes). These tensors may have lanes, too.
    """
    count = len(point)
    moved = room[: 3 * count]
    write_product(inputs, v[: inputs.shape[1]], moved)
    mean, spare = room[3 * count], room[3 * count + 1]
    mean[:] = 0.0
    for j in range(count):
        x, y, z = moved[j], moved[count + j], moved[2 * count + j]
        own = (point[j, 0], point[j, 1], point[j, 2], exponent)
        _write_point_force(own, air[j], air[count + j], x, y, z, mean, spare)
    for k in range(len(total)):
        own_rest = rest[k]
        for lane in range(len(mean)):
            total[k, lane] -= ISOTROPIC_DRAG * of_lane(own_rest, lane) * mean[lane] * v[k, lane]
    add_product(outputs, moved, total)


@numba.njit(cache=True, nogil=True)
def _write_point_force(point, air_x, air_z, x, y, z, mean, spare):  # pragma: no cover  (compiled)
    """Replace the velocity (x, y, z) of a point by its force, and add its pressure per speed to ``mean``.

    ``point``: its area, its share of the pressure and of the area, and the streamlined exponent.
    Both laws are quadratic in weak wind. Without branches the compiler uses the SIMD lanes, so lanes of
    strong wind are counted first and corrected afterwards.
    """
    areas, shares, shares_of, exponents = point
    strong = 0
    for lane in range(len(mean)):
        wind_pa = np.sqrt(air_x[lane] * air_x[lane] + air_z[lane] * air_z[lane])
        share = of_lane(shares, lane)
        spare[lane] = np.sqrt(share / (HALF_AIR_DENSITY_KG_M3 * max(wind_pa, TINY_PA)))
        strong += share * wind_pa > STREAMLINING_PRESSURE_PA
    if strong:
        for lane in range(len(mean)):
            wind_pa = np.sqrt(air_x[lane] * air_x[lane] + air_z[lane] * air_z[lane])
            share = of_lane(shares, lane)
            if share * wind_pa > STREAMLINING_PRESSURE_PA:
                spare[lane] = speed_of_pressure(share * wind_pa, of_lane(exponents, lane)) / wind_pa
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
            speed = spare[lane] / HALF_AIR_DENSITY_KG_M3
            spare[lane] = pressure_per_speed(speed, of_lane(exponents, lane))[0]
    for lane in range(len(mean)):
        area, share = of_lane(areas, lane), of_lane(shares, lane)
        mean[lane] += of_lane(shares_of, lane) * spare[lane]
        x[lane] = area * (spare[lane] * x[lane] - share * air_x[lane])
        y[lane] = area * spare[lane] * y[lane]
        z[lane] = area * (spare[lane] * z[lane] - share * air_z[lane])


def drag_inputs(oscillators: int) -> int:
    """Number of oscillators whose speed determines the velocity of the drag points: the first half."""
    return min(oscillators, max(FEWEST_DRAG_INPUTS, oscillators // 2))


def drag_tensors(drag_point, drag_shape, drag_rest, exponent):
    """The tensors of the drag in float64, and the exponent, as ``add_drag`` uses them."""
    _, count, d = drag_shape.shape
    rows = np.asarray(drag_shape, np.float64).reshape(3 * count, d)
    inputs = np.ascontiguousarray(rows[:, : drag_inputs(d)])
    rest = np.ascontiguousarray(drag_rest, np.float64)
    return with_shares(drag_point), inputs, np.ascontiguousarray(rows.T), rest, float(exponent)


def with_shares(drag_point: Array) -> Floats:
    """(m, 3) area, m², and share of the wind of drag points (m, 2), and their shares in the whole area."""
    point = np.asarray(drag_point, np.float64)
    return np.column_stack([point, point[:, 0] / max(float(point[:, 0].sum()), 1e-30)])
