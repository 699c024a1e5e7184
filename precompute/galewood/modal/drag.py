"""Drag of the modal model: the pressure law at a few points of the crown, from the air's relative velocity.

Point j stands for many nodes. The air there moves at the sheltered speed U_c(s P), the point at Ψ v. Its
force a (p(U_c − Ψ v) − s P) acts on all oscillators; the steady part a s P is in `load`. The first
oscillators (``drag_inputs``) determine Ψ v. What the motion of the nodes within a point adds is a damping of
each oscillator (docs/physics.md; `galewood.fem.drag` is the same law at every node). In still air no term
drives the motion.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import numba
import numpy as np

from galewood.wind import (
    HALF_AIR_DENSITY_KG_M3,
    STREAMLINING_SPEED_M_S,
    pressure_per_speed,
    speed_of_pressure,
)

FEWEST_INPUTS = 8
ISOTROPIC = 4.0 / 3.0
"""Mean over all directions of the derivative of a quadratic drag, over pressure per speed."""
TINY_PA = 1e-30
"""Keeps the direction of no wind finite."""


@numba.njit(cache=True, nogil=True)
def add_drag(point, inputs, outputs, rest, v, pressure, room, total):  # pragma: no cover  (compiled)
    """Add the drag at the velocities v (d, lanes) in winds of pressure (2, lanes), Pa, to total (d, lanes).

    point (m, 2): area, m², and share s; inputs (3m, k) and outputs (d, 3m): Ψ, rows x of all points, then y,
    z; rest (d,) m²/kg; room (3m + 3, lanes).
    """
    count, lanes = len(point), v.shape[1]
    moved = room[: 3 * count]
    np.dot(inputs, v[: inputs.shape[1]], moved)
    wind, mean, spare = room[3 * count], room[3 * count + 1], room[3 * count + 2]
    mean[:] = 0.0
    whole = 0.0
    for j in range(count):
        whole += point[j, 0]
    for lane in range(lanes):
        wind[lane] = np.sqrt(pressure[0, lane] * pressure[0, lane] + pressure[1, lane] * pressure[1, lane])
    for j in range(count):
        area, share = point[j, 0], point[j, 1]
        x, y, z = moved[j], moved[count + j], moved[2 * count + j]
        # Both laws are quadratic in weak wind; without branches the compiler uses the SIMD lanes.
        fastest = 0.0
        for lane in range(lanes):
            sheltered = np.sqrt(share * wind[lane] / HALF_AIR_DENSITY_KG_M3)
            fastest = max(fastest, sheltered)
            spare[lane] = sheltered
        if fastest > STREAMLINING_SPEED_M_S:
            for lane in range(lanes):
                spare[lane] = speed_of_pressure(share * wind[lane])
        fastest = 0.0
        for lane in range(lanes):
            air = spare[lane] / max(wind[lane], TINY_PA)
            x[lane] = air * pressure[0, lane] - x[lane]
            y[lane] = -y[lane]
            z[lane] = air * pressure[1, lane] - z[lane]
            speed = np.sqrt(x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane])
            fastest = max(fastest, speed)
            spare[lane] = HALF_AIR_DENSITY_KG_M3 * speed
        if fastest > STREAMLINING_SPEED_M_S:
            for lane in range(lanes):
                spare[lane] = pressure_per_speed(spare[lane] / HALF_AIR_DENSITY_KG_M3)[0]
        for lane in range(lanes):
            mean[lane] += area / whole * spare[lane]
            x[lane] = area * (spare[lane] * x[lane] - share * pressure[0, lane])
            y[lane] = area * spare[lane] * y[lane]
            z[lane] = area * (spare[lane] * z[lane] - share * pressure[1, lane])
    for k in range(len(total)):
        for lane in range(lanes):
            total[k, lane] -= ISOTROPIC * rest[k] * mean[lane] * v[k, lane]
    total += np.dot(outputs, moved)


def drag_inputs(oscillators: int) -> int:
    """Number of oscillators whose speed determines the velocity of the drag points: the first half."""
    return min(oscillators, max(FEWEST_INPUTS, oscillators // 2))


def drag_tensors(drag_point, drag_shape, drag_rest):
    """The tensors (m, 2), (3, m, d), (d,) in float64, as ``add_drag`` uses them."""
    _, count, d = drag_shape.shape
    rows = np.asarray(drag_shape, np.float64).reshape(3 * count, d)
    inputs = np.ascontiguousarray(rows[:, : drag_inputs(d)])
    point, rest = (np.ascontiguousarray(tensor, np.float64) for tensor in (drag_point, drag_rest))
    return point, inputs, np.ascontiguousarray(rows.T), rest
