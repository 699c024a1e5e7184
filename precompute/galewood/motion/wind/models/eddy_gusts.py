"""Navier–Stokes eddies over the forest at any time.

A simulation cannot be entered in the middle, and a page that joins a forest after a day must not compute the
whole day. Therefore runs follow one another: each lasts EPOCH + OVERLAP steps from its own seeded start, and
during OVERLAP steps consecutive runs are cross-faded (the squared weights sum to one, which preserves the
variance). Any time is at most EPOCH + OVERLAP steps from a start, and everyone who shares seed and travel
sees the same eddies.
"""

from __future__ import annotations

import math

from galewood.constants import (
    EDDY_CELLS_PER_SCALE,
    EDDY_EPOCH,
    EDDY_GRID,
    EDDY_LATERAL_SHARE,
    EDDY_OVERLAP,
    EDDY_STEPS_PER_SCALE,
)
from galewood.motion.wind.document import Wind
from galewood.motion.wind.models.fourier import Floats
from galewood.motion.wind.models.frame import view_of
from galewood.motion.wind.models.hashing import hash32
from galewood.motion.wind.models.navier_stokes import Eddies
from galewood.motion.wind.models.texture import sample_texture


class _Run:
    """The run of one epoch: the velocity fields before and after the requested time."""

    def __init__(self, seed: int, epoch: int) -> None:
        self.epoch = epoch
        self._eddies = Eddies(hash32(seed, epoch))
        self._before: Floats = self._eddies.velocity.copy()

    def can_reach(self, step: int) -> bool:
        """Whether the run, which only goes forward, has not yet passed this step."""
        return self._eddies.steps <= step + 1

    def between(self, step: int, t: float) -> Floats:
        """(2, GRID²) velocity interpolated between a step and the next one at fraction t."""
        while self._eddies.steps <= step:
            self._before[:] = self._eddies.velocity
            self._eddies.step()
        return (1.0 - t) * self._before + t * self._eddies.velocity


class EddyGusts:
    """The gusts of one seed."""

    def __init__(self, seed: int) -> None:
        """No step is computed before the first evaluation."""
        self._seed = seed
        self._runs: list[_Run] = []

    def velocity(
        self, wind: Wind, travel: float, x_m: Floats, z_m: Floats, out_x: Floats, out_z: Floats
    ) -> None:
        """Write the velocity (m/s, world x and z) at each position (m)."""
        field = self._velocity_field(EDDY_STEPS_PER_SCALE * travel)
        view = view_of(
            wind,
            travel,
            EDDY_LATERAL_SHARE,
            cells_along=EDDY_CELLS_PER_SCALE,
            cells_across=EDDY_CELLS_PER_SCALE,
        )
        sample_texture(field, EDDY_GRID, EDDY_GRID, view, x_m, z_m, out_x, out_z)

    def _velocity_field(self, moment: float) -> Floats:
        """(2, GRID²) velocity field at a time measured in steps."""
        step = math.floor(moment)
        epoch = step // EDDY_EPOCH
        self._runs = [run for run in self._runs if run.epoch in (epoch - 1, epoch)]
        new = self._run(epoch, step).between(step - epoch * EDDY_EPOCH, moment - step)
        fade = (moment - epoch * EDDY_EPOCH) / EDDY_OVERLAP
        if epoch <= 0 or fade >= 1.0:  # the first run has no predecessor
            return new
        old = self._run(epoch - 1, step).between(step - (epoch - 1) * EDDY_EPOCH, moment - step)
        return math.sqrt(1.0 - fade) * old + math.sqrt(fade) * new

    def _run(self, epoch: int, step: int) -> _Run:
        for run in self._runs:
            if run.epoch == epoch:
                if run.can_reach(step - epoch * EDDY_EPOCH):
                    return run
                self._runs.remove(run)
                break
        run = _Run(self._seed, epoch)
        self._runs.append(run)
        return run
