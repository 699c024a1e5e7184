"""Pull and release: a tree is bent by a rope, let go, and its free decay measured, as on real trees."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from galewood.check.field.decay import Decay, fitted_decay
from galewood.check.sway import SwayMode, main_sway_mode
from galewood.solid.fem import FemModel, Simulator, solve_static
from galewood.util import Floats

ROPE_HEIGHT = 2 / 3
"""Height of the rope over that of the tree."""
ROPE_BAND_HEIGHT_SHARE = 0.04
"""Half the height of the band of wood that the rope holds, over the height of the tree."""
TOP_DEPTH_HEIGHT_SHARE = 0.05
"""Depth of the top below the highest point, over the height."""
FINEST_STEP = 0.15
"""Angular frequency times time step, above which steps are divided: their own damping is then negligible."""
SWAY_TOLERANCE = 1e-3
"""Relative accuracy of the sway from which the tree is released."""


class PullError(ArithmeticError):
    """The tree cannot be pulled to the sway."""


@dataclass(frozen=True)
class Release:
    """A simulated pull and release; sway is the displacement of the main mode at its top over the height."""

    mode: SwayMode
    force_n: float
    time_s: Floats
    """(T,)"""
    sway: Floats
    """(T,) share of the height."""
    decay: Decay

    def figures(self) -> dict[str, Any]:
        """Frequency, damping ratio (also by amplitude), force and mode; JSON-able."""
        amplitude, ratio = self.decay.by_cycle
        return {
            "frequency_hz": self.decay.frequency_hz,
            "damping_ratio": self.decay.ratio,
            "damping_ratio_at_release": self.decay.ratio_at(self.decay.start),
            "damping_ratio_small": self.decay.ratio_at(0.0),
            "force_n": self.force_n,
            "mode": self.mode.number,
            "mode_hz": self.mode.frequency_hz,
            "mode_mass_share": self.mode.mass_share,
            "by_cycle": {"sway": amplitude.tolist(), "damping_ratio": ratio.tolist()},
        }


def pull_and_release(
    model: FemModel,
    *,
    sway: float = 0.03,
    cycles: float = 12.0,
    on_progress: Callable[[float], None] = lambda share: None,
) -> Release:
    """Pull a tree at two thirds of its height in the direction of its main mode, release it in still air.

    The rope holds the wood within 4 % of the height, in proportion to its mass. `sway` is the main mode's
    part of the displacement of the top, over the height: other modes do not disturb its decay. `on_progress`
    receives the share done; what it raises ends the simulation. Raises PullError if no force reaches the
    sway, ValueError if the decay has too few cycles, and FloatingPointError if the simulation diverges.
    """
    if not 0 < sway <= 0.3:
        raise ValueError("sway must lie above 0 and at most at 0.3 of the height")
    mode = main_sway_mode(model)
    height = float(np.ptp(model.nodes_m[:, 1]))
    part = _main_part(model, mode)
    force, u = _pulled(model, _rope(model, mode), part, sway * height)
    steps = int(np.ceil(2 * np.pi * mode.frequency_hz * model.settings.dt_s / FINEST_STEP))
    substeps = min(max(steps, model.settings.substeps, 1), 64)
    simulator = Simulator(replace(model, settings=replace(model.settings, substeps=substeps)))
    simulator.displace(u)
    frames = int(np.ceil(cycles / mode.frequency_hz / model.settings.dt_s))
    found = np.empty(frames + 1)
    for k in range(frames + 1):
        found[k] = np.vdot(part, simulator.u) / height
        if k < frames:
            simulator.step(np.zeros(2))
            on_progress((k + 1) / frames)
    time_s = model.settings.dt_s * np.arange(frames + 1, dtype=np.float64)
    return Release(mode, force, time_s, found, fitted_decay(time_s, found))


def _rope(model: FemModel, mode: SwayMode) -> Floats:
    """(N,3) force of 1 N on the wood around the rope, in the direction of the mode."""
    y = model.nodes_m[:, 1] - model.nodes_m[:, 1].min()
    height, band = float(y.max()), ROPE_BAND_HEIGHT_SHARE
    while True:
        held = np.abs(y - ROPE_HEIGHT * height) <= band * height
        if held.any():
            break
        band *= 2
    share = np.where(held, model.mass_kg, 0.0)
    x, z = mode.direction
    return (share / share.sum())[:, None] * np.array([x, 0.0, z])


def _main_part(model: FemModel, mode: SwayMode) -> Floats:
    """(n,3) weights whose product with a displacement is the main mode's part of it at the top, m.

    The top is the highest twentieth of the tree, averaged by mass, in the direction of the mode.
    """
    y = model.nodes_m[: model.vertex_count, 1]
    share = np.where(
        y >= y.max() - TOP_DEPTH_HEIGHT_SHARE * np.ptp(y), model.mass_kg[: model.vertex_count], 0.0
    )
    moved = mode.shape[: model.vertex_count, [0, 2]] @ np.array(mode.direction)
    top = float(share @ moved / share.sum())
    weight = model.mass_kg[:, None] * mode.shape
    return weight[: model.vertex_count] * top


def _pulled(model: FemModel, pull: Floats, part: Floats, distance_m: float) -> tuple[float, Floats]:
    """Force, N, that sways the main mode by a distance, and the displacement (N,3) from the rest pose."""
    system = model.system()

    def reached(force: float) -> tuple[float, Floats]:
        u, _, converged = solve_static(system, model.gravity_n + force * pull)
        if not converged:
            raise PullError(f"no equilibrium was found under a pull of {force:.0f} N; choose a smaller sway")
        return float(np.vdot(part, u[: model.vertex_count])), u

    slight = 1e-3 * float(np.abs(model.gravity_n).sum()) or 1.0
    moved, u = reached(slight)
    force = slight * distance_m / moved
    for _ in range(12):
        moved, u = reached(force)
        if abs(moved / distance_m - 1) <= SWAY_TOLERANCE:
            return force, u
        force *= distance_m / moved
    raise PullError(f"a pull of {force:.0f} N sways the tree by {moved:.3g} m instead of {distance_m:.3g} m")
