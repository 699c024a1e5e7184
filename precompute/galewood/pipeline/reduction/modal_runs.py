"""Training runs in modal coordinates, and the ranges and weights that follow from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from galewood.pipeline.reduction.oscillators import CrownWind, Oscillators, felt_wind
from galewood.pipeline.reduction.pod import Subspace
from galewood.pipeline.sampling import CrownGusts
from galewood.util import Array, Floats

LIGHT_SHARE = 0.05
"""Lower bound of a run's sway in its weight, over the largest sway of all runs."""

GUSTY_WEIGHT = 0.35
"""Weight of a run with gusts within the crown: its relative error remains about three times as large."""


class RunLike(Protocol):
    """A training run from rest: displacement (T + 1, n, 3), m, under the pressure (T, 2), Pa.

    ``gusts`` (7,) are those within the crown, as in ``Trajectory``.

    Runs are read one after the other, each array once, so that they need not all be in memory.
    """

    @property
    def pressure_pa(self) -> Array: ...
    @property
    def gusts(self) -> Array: ...
    @property
    def displacement_m(self) -> Array: ...


@dataclass(frozen=True)
class ModalRun:
    """A run in modal coordinates: its wind, e, v (T + 1, d), and output modes q (T + 1, r)."""

    wind: CrownWind
    e: Floats
    v: Floats
    q: Floats

    def felt_pa(self, mean_gust: Floats) -> Floats:
        """(T, 2) mean pressure over the crown, Pa, with the weights (G,) of the places."""
        return self.wind.pressure_pa + self.wind.local_pa @ mean_gust

    def air_pa(self, drag_place: Array) -> Floats:
        """(T, 2m) pressure at the drag points, Pa, as ``add_drag`` takes it; ``drag_place`` (m, G)."""
        air = self.wind.pressure_pa[:, :, None] + self.wind.local_pa @ np.asarray(drag_place, np.float64).T
        return air.reshape(len(air), -1)


def modal_run(run: RunLike, ritz: Oscillators, mass_kg: Floats, subspace: Subspace, dt_s: float) -> ModalRun:
    """Project a run on the oscillators, mass-weighted; velocities by central differences."""
    u = np.asarray(run.displacement_m, np.float64)
    u = u.reshape(len(u), -1)
    weighted = ritz.shapes * np.repeat(mass_kg, 3)
    e: Floats = np.linalg.solve(weighted @ ritz.shapes.T, weighted @ u.T).T.astype(np.float64)
    v: Floats = np.zeros(e.shape)
    v[1:-1] = (e[2:] - e[:-2]) / (2 * dt_s)
    v[-1] = (e[-1] - e[-2]) / dt_s
    pressure_pa, gusts = np.asarray(run.pressure_pa, np.float64), CrownGusts.of_array(run.gusts)
    wind = felt_wind(pressure_pa, gusts, ritz.places.place_m, dt_s)
    return ModalRun(wind, e, v, u @ subspace.dual.T)


def sway_coordinates(ritz: Oscillators, runs: Sequence[ModalRun]) -> Floats:
    """(2, d) the two directions of largest motion, m, scaled to 1 at the largest sampled sway."""
    reach = np.sqrt((ritz.shapes.reshape(len(ritz.omega), -1, 3) ** 2).sum(axis=2).max(axis=1))
    motion = np.concatenate([run.e for run in runs])
    _, vectors = np.linalg.eigh((motion * reach).T @ (motion * reach))
    sway = (vectors[:, ::-1][:, :2] * reach[:, None]).T
    largest = np.sqrt(((motion @ sway.T) ** 2).sum(axis=1).max())
    return sway / max(largest, 1e-12)


def sampled_range(sway: Floats, runs: Sequence[ModalRun], coupled: int) -> Floats:
    """(3 + 2c,) largest sway, sway speed, pressure, coupled coordinates and their speeds; never zero."""
    e = np.concatenate([run.e for run in runs])
    v = np.concatenate([run.v for run in runs])
    pressure = np.concatenate([run.wind.pressure_pa for run in runs])
    sizes = [np.linalg.norm(rows, axis=1).max() for rows in (e @ sway.T, v @ sway.T, pressure)]
    beside = slice(2, 2 + coupled)
    return np.maximum([*sizes, *np.abs(e[:, beside]).max(axis=0), *np.abs(v[:, beside]).max(axis=0)], 1e-9)


def run_weights(sway: Floats, runs: Sequence[ModalRun]) -> Floats:
    """(R,) weight of the error of each run: 1 / (largest sway), mean 1, so that relative errors count.

    Less for runs with gusts within the crown, a part of which no place feels.
    """
    gusty = np.array([bool(run.wind.local_pa.any()) for run in runs])
    farthest = [np.linalg.norm(run.e @ sway.T, axis=1).max() for run in runs]
    weights = np.where(gusty, GUSTY_WEIGHT, 1.0) / np.maximum(farthest, LIGHT_SHARE)
    return weights / weights.mean()


def typical_speed(runs: Sequence[ModalRun]) -> Floats:
    """(d,) root mean square of the speed of each oscillator."""
    return np.sqrt(np.mean(np.concatenate([run.v for run in runs]) ** 2, axis=0))
