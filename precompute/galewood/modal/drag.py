"""Drag of the modal model: the pressure law at a few points of the crown, from the air's relative velocity.

Point j stands for many nodes. The air there moves at the sheltered speed U_c(s P), the point at Ψ v. Its
force a (p(U_c − Ψ v) − s P) acts on all oscillators; the steady part a s P is in `load`. The first
DRAG_INPUTS oscillators determine Ψ v. What the motion of the nodes within a point adds is a damping of each
oscillator (docs/physics.md; `galewood.fem.drag` is the same law at every node). In still air no term drives
the motion.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import numba
import numpy as np

from galewood.wind import pressure_per_speed, speed_of_pressure

DRAG_INPUTS = 8
"""Oscillators, at most, whose speed determines the velocity of the points."""
ISOTROPIC = 4.0 / 3.0
"""Mean over all directions of the derivative of a quadratic drag, over pressure per speed."""
QUADRATIC_SPEED_M_S = 5.0
QUADRATIC_PA_S2_M2 = 0.6


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
        for lane in range(lanes):
            # The speed of the sheltered wind over its pressure; both laws are quadratic in weak wind.
            sheltered = share * wind[lane]
            spare[lane] = np.sqrt(sheltered / QUADRATIC_PA_S2_M2)
            if spare[lane] > QUADRATIC_SPEED_M_S:
                spare[lane] = speed_of_pressure(sheltered)
            spare[lane] = spare[lane] / wind[lane] if wind[lane] > 0.0 else 0.0
        for lane in range(lanes):
            wx = spare[lane] * pressure[0, lane] - x[lane]
            wy = -y[lane]
            wz = spare[lane] * pressure[1, lane] - z[lane]
            speed = np.sqrt(wx * wx + wy * wy + wz * wz)
            per_speed = QUADRATIC_PA_S2_M2 * speed
            if speed > QUADRATIC_SPEED_M_S:
                per_speed = pressure_per_speed(speed)[0]
            mean[lane] += area * per_speed / whole
            x[lane] = area * (per_speed * wx - share * pressure[0, lane])
            y[lane] = area * per_speed * wy
            z[lane] = area * (per_speed * wz - share * pressure[1, lane])
    for k in range(len(total)):
        for lane in range(lanes):
            total[k, lane] -= ISOTROPIC * rest[k] * mean[lane] * v[k, lane]
    total += np.dot(outputs, moved)


def drag_tensors(drag_point, drag_shape, drag_rest):
    """The tensors (m, 2), (3, m, d), (d,) in float64, as ``add_drag`` uses them."""
    _, count, d = drag_shape.shape
    rows = np.asarray(drag_shape, np.float64).reshape(3 * count, d)
    inputs = np.ascontiguousarray(rows[:, : min(DRAG_INPUTS, d)])
    point, rest = (np.ascontiguousarray(tensor, np.float64) for tensor in (drag_point, drag_rest))
    return point, inputs, np.ascontiguousarray(rows.T), rest
