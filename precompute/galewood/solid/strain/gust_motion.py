"""Motion of rods in gusts: natural modes about their pose in the mean wind, under drag by relative velocity.

The modes decide with which velocity and acceleration the points move, not how far the rods bend: the strain
follows from all forces of a moment, those of inertia among them (mode acceleration; Williams 1945, as in
Craig and Kurdila, Fundamentals of Structural Dynamics, 2006, chapter 11). So what is slow is exact, however
few the modes and however far the rods bend.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from galewood.solid.beams import BentRods, RodModes, rod_modes
from galewood.solid.fem import Drag, rayleigh
from galewood.solid.model import GRAVITY_M_S2
from galewood.solid.strain.tree_rods import WindRods
from galewood.util import Floats

MODE_COUNT = 32
DAMPED_RATIO = 3.0
"""Wood has its damping ratio at the first frequency and at this multiple, as in the finite elements."""
LAGGED_STEPS = 4
"""Steps for which the derivative of the drag by the velocity is kept; the drag is that of each step."""


class MovingLoad(NamedTuple):
    """Forces (n, 3), N, under which resting rods have the pose that they have at a time, s."""

    time_s: float
    force_n: Floats


class SwayingRods:
    """Rods that sway about their pose in a steady wind."""

    def __init__(self, rods: WindRods, load_n: Floats, pose: BentRods, mode_count: int = MODE_COUNT) -> None:
        """Find the modes about the pose under the load (n, 3) of a steady wind, N."""
        mass_kg = rods.rods.weight_n / GRAVITY_M_S2
        self.modes: RodModes = rod_modes(rods.rods, load_n, pose, mass_kg, mode_count)
        self._mean_n = load_n
        self._square = (2 * np.pi * self.modes.frequencies_hz) ** 2
        alpha, beta = rayleigh(rods.wood.damping_ratio, float(self.modes.frequencies_hz[0]), DAMPED_RATIO)
        self._damping = alpha + beta * self._square
        count = len(self._square)
        self._shapes = self.modes.shapes.reshape(count, -1)
        self._pushed = (self.modes.shapes * mass_kg[:, None]).reshape(count, -1)
        self._drag = Drag(
            rods.drag_area_m2, rods.exposed_area_m2, rods.wind_profile, rods.streamlined_exponent
        )
        self._exposed = np.flatnonzero(self._drag.exposed_m2 > 0)
        self._shapes_there = np.ascontiguousarray(self.modes.shapes[:, self._exposed].transpose(1, 2, 0))

    def loads(self, pressures_pa: Iterable[Floats], dt_s: float, every: int) -> Iterator[MovingLoad]:
        """From rest in the mean wind: the load after every so many steps in pressures (n, 2) or (2,), Pa.

        Newmark's method with constant average acceleration.
        """
        rate, place = np.zeros((2, len(self._square)))
        gain = np.zeros_like(rate)
        modal_drag = solver = np.zeros((len(rate), len(rate)))
        for step, pressure_pa in enumerate(pressures_pa):
            found = self._drag.at((rate @ self._shapes).reshape(-1, 3), pressure_pa)
            if step % LAGGED_STEPS == 0:
                modal_drag = self._modal(found.damping)
                own = np.eye(len(rate)) + dt_s / 2 * (np.diag(self._damping) + modal_drag)
                solver = np.linalg.inv(own + dt_s**2 / 4 * np.diag(self._square))
            push = self._shapes @ (found.force_n - self._mean_n).ravel() + modal_drag @ rate
            half = rate + dt_s / 2 * gain
            ahead = place + dt_s * rate + dt_s**2 / 4 * gain
            after = solver @ (push - self._damping * half - modal_drag @ half - self._square * ahead)
            place = ahead + dt_s**2 / 4 * after
            rate, gain = half + dt_s / 2 * after, after
            if (step + 1) % every == 0:
                yield MovingLoad((step + 1) * dt_s, self._resting_load(pressure_pa, rate, gain))

    def _modal(self, damping: Floats) -> Floats:
        """(k, k) drag of the modes, from blocks (n, 9) of the points."""
        count, shapes = len(self._square), self._shapes_there
        pushed = damping[self._exposed].reshape(-1, 3, 3) @ shapes
        return shapes.reshape(-1, count).T @ pushed.reshape(-1, count)

    def _resting_load(self, pressure_pa: Floats, rate: Floats, gain: Floats) -> Floats:
        """The wind on the moving points, less their inertia and the damping of the wood."""
        moving = (rate @ self._shapes).reshape(-1, 3)
        braked = (gain + self._damping * rate) @ self._pushed
        return self._drag.at(moving, pressure_pa).force_n - braked.reshape(-1, 3)
