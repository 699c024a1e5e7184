"""Linear motion of a tree's parts under gusts that differ from place to place in its crown.

The modal model is driven by one pressure per tree. What the wind at ``places`` in the crown differs from it
drives oscillators of their own: Ritz vectors of the finite-element model, stepped exactly, in metres of their
output mode. Drag damps them.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from galewood.constants import GUST_LAYER_REST, MAX_STEPS_PER_ADVANCE
from galewood.motion.wind import speed_of_pressure
from galewood.util import Singles


@dataclass(frozen=True)
class GustTensors:
    """Tensors of the gust layer: G places, L oscillators."""

    place: Singles  # (G, 3) m, tree frame
    step: Singles  # (L, 6) as in ModalTensors
    load: Singles  # (L, 2G) m/s² per Pa of the pressure along x and z at each place, beyond that of the tree
    drag: Singles  # (L,) damping, 1/s, per Pa·s/m of pressure over wind speed
    streamlined_exponent: float  # of the pressure over the wind speed, above 5 m/s

    @property
    def oscillators(self) -> int:
        """L."""
        return len(self.step)


def no_gusts(exponent: float) -> GustTensors:
    """The tensors of a table without a gust layer, of a tree with this streamlined exponent."""
    shapes = ((0, 3), (0, 6), (0, 0), (0,))
    return GustTensors(*(np.zeros(shape, np.float32) for shape in shapes), streamlined_exponent=exponent)


@numba.njit(cache=True, nogil=True)
def advance_gusts(tensors, rate, turn, phase, pressure, gusts, state, q):  # pragma: no cover  (compiled)
    """Advance the gust layer of all trees by ``rate`` steps each and write the interpolated poses to q.

    ``tensors`` are step, load, drag (float64) and exponent of ``GustTensors``. ``pressure`` is that at the
    trees along world x and z, (count,) Pa. gusts (count, 2G) are the relative gusts at each place, along and
    across that pressure; q (count, L) m. ``phase`` (count,) is that before the step of the modal model, and
    is not changed. ``state`` (count, L) is updated: coordinates, speeds, and the poses of the last two steps.
    """
    step, load, drag, exponent = tensors
    pressure_x, pressure_z = pressure
    e, v, now, before = state
    oscillators, places = len(step), load.shape[1] // 2
    local = np.empty(2 * places)
    for i in range(len(phase)):
        x = turn[i, 0] * pressure_x[i] - turn[i, 1] * pressure_z[i]
        z = turn[i, 1] * pressure_x[i] + turn[i, 0] * pressure_z[i]
        strength = math.sqrt(x * x + z * z)
        for g in range(places):
            a, b = gusts[i, 2 * g], gusts[i, 2 * g + 1]
            local[2 * g], local[2 * g + 1] = a * x - b * z, a * z + b * x
        per_speed = strength / speed_of_pressure(strength, exponent) if strength > 0.0 else 0.0
        passed = phase[i] + rate[i]
        for _ in range(min(int(passed), MAX_STEPS_PER_ADVANCE)):
            largest = fastest = 0.0
            for k in range(oscillators):
                force = 0.0
                for g in range(2 * places):
                    force += load[k, g] * local[g]
                a, b, c, d, s0, s1 = step[k]
                x0, v0 = e[i, k], v[i, k]
                # implicit in the damping, so that any wind is stable
                mean = v0 + 0.5 * (c * x0 + d * v0 + s1 * force)
                damping = drag[k] * per_speed
                force -= damping * mean / (1.0 + 0.5 * damping * s1)
                e[i, k] = x0 + (a * x0 + b * v0 + s0 * force)
                v[i, k] = v0 + (c * x0 + d * v0 + s1 * force)
                largest, fastest = max(largest, abs(e[i, k])), max(fastest, abs(v[i, k]))
            if strength == 0.0 and largest < GUST_LAYER_REST and fastest < GUST_LAYER_REST:
                e[i, :] = 0.0
                v[i, :] = 0.0
            for k in range(oscillators):
                before[i, k] = now[i, k]
                now[i, k] = e[i, k]
        part = passed - math.floor(passed)
        for k in range(oscillators):
            q[i, k] = before[i, k] + (now[i, k] - before[i, k]) * part
