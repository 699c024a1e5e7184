"""The oscillators of the modal model: the linear motion of a tree in few coordinates.

The natural modes of the finite-element model are many and closely spaced, while the wind loads only few
spatial fields. The responses of many natural modes to oscillating winds and to gusts at places of the crown
are therefore reduced by proper orthogonal decomposition (POD); the model is projected on the result and
diagonalised (Rayleigh–Ritz).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numba
import numpy as np

from galewood.pipeline.reduction.places import Places, no_places, places_of
from galewood.pipeline.sampling import (
    CROWN_FIELD_M,
    CROWN_SPEEDS_M_S,
    GOLDEN_RAD,
    NO_GUSTS,
    CrownGusts,
    noise,
)
from galewood.solid.fem import FemModel, FemSettings, natural_modes
from galewood.util import Floats
from galewood.wood import BARE_EXPONENT

NATURAL_MODES = 120
REDUCTION_PERIODS_S = (3.0, 2.5)
"""Periods of the winds whose linear responses select the oscillators."""
REDUCTION_DEPTH = 0.5
REDUCTION_S = 6.0
GUSTY_WINDS, GUSTY_S = 14, 10.0
"""Noise, which selects the modes beyond the first ones."""
GUSTY_MEAN, GUSTY_INTENSITY, GUSTY_TURN_RAD = 0.4, 0.5, 0.5
CROWN_WINDS, CROWN_INTENSITY_SHARE = 10, 0.45
"""Winds with gusts within the crown, which pass at speeds of CROWN_SPEEDS_M_S."""


@dataclass(frozen=True)
class Exposure:
    """Wind exposure of a body's vertices, as `galewood.solid.fem.Drag` uses it."""

    area_m2: Floats  # (n,) without shelter
    share: Floats  # (n,) drag area with shelter over that without
    profile: Floats  # (n,) wind speed over that at the top
    streamlined_exponent: float
    place_m: Floats = field(default_factory=lambda: np.zeros((0, 3)))  # (n, 3) at rest, m


NOT_EXPOSED = Exposure(np.zeros(0), np.ones(0), np.ones(0), BARE_EXPONENT)
"""Of a body whose wind load does not depend on its motion."""


@dataclass(frozen=True)
class CrownWind:
    """Pressure at the tree (T, 2), Pa, and what that at each place is in addition (T, 2, G)."""

    pressure_pa: Floats
    local_pa: Floats


@dataclass(frozen=True)
class Oscillators:
    """Mass-normalised modes of a body about its rest pose: ë + C ė + ω² e = load p, u = Σ e_k shape_k.

    The loads are the wind's force on the body at rest; ``exposure`` determines how they change with the
    motion.
    """

    omega: Floats  # (k,) 1/s
    damping: Floats  # (k, k) 1/s
    shapes: Floats  # (k, 3n) 1/√kg
    load: Floats  # (k, 2) modal force per Pa
    exposure: Exposure = NOT_EXPOSED
    places: Places = field(default_factory=lambda: no_places(0))
    leading: dict[tuple[FemSettings, int, int], Oscillators] = field(
        default_factory=dict[Any, "Oscillators"], init=False, repr=False, compare=False
    )
    """What `leading_oscillators` has found for this body: every table asks for it."""

    @cached_property
    def place_load(self) -> Floats:
        """(k, 2, G) modal force per Pa of the gust at each place."""
        if not self.places.count:
            return np.zeros((len(self.omega), 2, 0))
        area = (self.exposure.area_m2 * self.exposure.share)[:, None] * self.places.weight
        sideways = self.shapes.reshape(len(self.omega), -1, 3)[:, :, [0, 2]]
        return np.tensordot(sideways, area, axes=(1, 0))

    def force(self, wind: CrownWind) -> Floats:
        """(T, k) modal force of a wind on the body at rest."""
        frames, k = len(wind.pressure_pa), len(self.omega)
        places = wind.local_pa.reshape(frames, -1) @ self.place_load.reshape(k, -1).T
        return wind.pressure_pa @ self.load.T + places


def in_gusts(body: Oscillators) -> Oscillators:
    """The body with the places of its crown."""
    of = body.exposure
    return replace(body, places=places_of(of.area_m2 * of.share, of.place_m, body.shapes, body.omega))


def oscillators_of(model: FemModel, count: int = NATURAL_MODES) -> Oscillators:
    """The first natural modes of a finite-element model and their damping (α, β on the element tangent)."""
    free = 3 * (len(model.nodes_m) - len(model.fixed))
    modes = natural_modes(model, min(count, free // 2))
    shapes = modes.shapes
    damping = model.alpha * np.eye(len(shapes)) + model.beta * _elastic(model, shapes)
    load = np.einsum("kni,n->ki", shapes[:, :, [0, 2]], model.drag_area_m2)
    of_vertices = shapes[:, : model.vertex_count].reshape(len(shapes), -1)
    drag, inside = model.drag(), slice(model.vertex_count)
    exposure = Exposure(
        drag.exposed_m2[inside], drag.share[inside], drag.profile[inside], model.streamlined_exponent,
        model.nodes_m[inside],
    )  # fmt: skip
    return in_gusts(Oscillators(2 * np.pi * modes.frequencies_hz, damping, of_vertices, load, exposure))


def first_of(body: Oscillators, count: int) -> Oscillators:
    """The same body with only its first ``count`` modes."""
    return replace(
        body,
        omega=body.omega[:count],
        damping=body.damping[:count, :count],
        shapes=body.shapes[:count],
        load=body.load[:count],
    )


def _elastic(model: FemModel, shapes: Floats) -> Floats:
    """(k, k) tangent of the elements at rest in the shapes (k, N, 3), without the contribution of gravity."""
    system = model.system()
    still, nothing = np.zeros_like(system.rest), np.zeros(len(model.nodes_m))
    system.assemble(still, still, 1.0, nothing, still.copy())
    inner = shapes[:, system.order[: system.free]].reshape(len(shapes), -1)
    return np.asarray(inner @ (system.solver.to_scipy(system.values) @ inner.T))


def propagators(omega: Floats, damping: Floats, settings: FemSettings) -> Floats:
    """(k, 6) one table step of each oscillator: r00, r01, r10, r11, s0, s1.

    It is exact, so that the fit does not reproduce the error of the FEM's steps. Backward Euler, whose error
    is large, keeps its own steps.
    """
    from scipy.linalg import expm  # slow to load

    eye = np.eye(2)
    rows = np.empty((len(omega), 6))
    for k, (w, c) in enumerate(zip(omega, damping, strict=True)):
        rate = np.array([[0.0, 1.0], [-w * w, -c]])
        if settings.scheme == "backward-euler":
            substeps = max(settings.substeps, 1)
            step = np.linalg.matrix_power(np.linalg.inv(eye - settings.dt_s / substeps * rate), substeps)
        else:
            step = expm(settings.dt_s * rate)
        rows[k] = *step.ravel(), *((step - eye) @ np.linalg.inv(rate) @ np.array([0.0, 1.0]))
    return rows


def response(step: Floats, force: Floats) -> Floats:
    """(T + 1, m) motion from rest of one oscillator (6,) under stepwise constant forces (T, m)."""
    moved = np.zeros((len(force) + 1, force.shape[1]))
    _respond(step, force, moved)
    return moved


@numba.njit(cache=True, nogil=True)
def _respond(step: Floats, force: Floats, moved: Floats) -> None:  # pragma: no cover  (compiled)
    for m in range(force.shape[1]):
        e, v = 0.0, 0.0
        for t in range(len(force)):
            push = force[t, m]
            e, v = step[0] * e + step[1] * v + step[4] * push, step[2] * e + step[3] * v + step[5] * push
            moved[t + 1, m] = e


def reduced(
    body: Oscillators, winds: Sequence[CrownWind], settings: FemSettings, dynamic: int
) -> Oscillators:
    """The ``dynamic`` Ritz oscillators that best represent the motion of the body under the winds.

    They are sorted by how far they move the tree, the largest first.
    """
    dynamic = min(dynamic, len(body.omega))
    step = propagators(body.omega, np.diag(body.damping), settings)
    motion = np.concatenate([_linear_motion(step, body.force(wind)) for wind in winds])
    root = np.linalg.cholesky(body.shapes @ body.shapes.T)
    _, vectors = np.linalg.eigh(root.T @ (motion.T @ motion) @ root)
    kept, _ = np.linalg.qr(np.linalg.solve(root.T, vectors[:, ::-1][:, :dynamic]))
    squared, turn = np.linalg.eigh(kept.T @ (body.omega[:, None] ** 2 * kept))
    mix = (kept @ turn).T
    far = np.sqrt(((mix @ body.shapes).reshape(dynamic, -1, 3) ** 2).sum(axis=2).max(axis=1))
    order = np.argsort(-far * np.sqrt(((motion @ mix.T) ** 2).mean(axis=0)), kind="stable")
    squared, mix = squared[order], mix[order]
    mix *= np.sign(mix[np.arange(dynamic), np.argmax(np.abs(mix), axis=1)])[:, None]
    mixed = (mix @ body.damping @ mix.T, mix @ body.shapes, mix @ body.load)
    return Oscillators(np.sqrt(squared), *mixed, body.exposure, body.places)


def leading_oscillators(body: Oscillators, settings: FemSettings, natural: int, dynamic: int) -> Oscillators:
    """The ``dynamic`` oscillators, combined from the first ``natural`` modes of a body, that best represent
    its linear motion in oscillating winds.
    """
    if found := body.leading.get((settings, natural, dynamic)):
        return found
    even = [(wind, NO_GUSTS) for wind in smooth_winds(settings.dt_s) + gusty_winds(settings.dt_s)]
    winds = [*even, *crown_winds(settings.dt_s)] if body.places.count else even
    felt = [felt_wind(wind, gusts, body.places.place_m, settings.dt_s) for wind, gusts in winds]
    found = reduced(first_of(body, natural), felt, settings, dynamic)
    body.leading[settings, natural, dynamic] = found
    return found


def felt_wind(pressure_pa: Floats, gusts: CrownGusts, place_m: Floats, dt_s: float) -> CrownWind:
    """A wind (T, 2), Pa, with its gusts at the places (G, 3), m."""
    return CrownWind(pressure_pa, gusts.local_pa(place_m, pressure_pa, dt_s))


def crown_winds(dt_s: float) -> list[tuple[Floats, CrownGusts]]:
    """Oscillating winds (T, 2) of about 1 Pa with gusts within the crown.

    They are the same for every tree: in such weak wind the streamlined exponent does not matter.
    """
    rng, time_s = np.random.default_rng(5), np.arange(round(GUSTY_S / dt_s)) * dt_s
    pressure = 1.0 - REDUCTION_DEPTH * np.cos(2 * np.pi * time_s / REDUCTION_PERIODS_S[0])
    winds: list[tuple[Floats, CrownGusts]] = []
    for k, speed_m_s in enumerate(np.linspace(*CROWN_SPEEDS_M_S, CROWN_WINDS).tolist()):
        heading = k * GOLDEN_RAD
        x_m, z_m = rng.uniform(0, CROWN_FIELD_M, 2).tolist()
        gusts = CrownGusts(k, x_m, z_m, heading, speed_m_s, CROWN_INTENSITY_SHARE, BARE_EXPONENT)
        winds.append((np.outer(pressure, (np.cos(heading), np.sin(heading))), gusts))
    return winds


def smooth_winds(dt_s: float) -> list[Floats]:
    """Winds (T, 2) along x and along z, of pressure about 1: a linear response needs no scale."""
    time_s = np.arange(round(REDUCTION_S / dt_s)) * dt_s
    series = [1.0 - REDUCTION_DEPTH * np.cos(2 * np.pi * time_s / s) for s in REDUCTION_PERIODS_S]
    return [np.outer(pressure, side) for pressure in series for side in np.eye(2)]


def gusty_winds(dt_s: float) -> list[Floats]:
    """Noise (T, 2) with varying headings, of the same unit; the same for every tree."""
    rng, frames = np.random.default_rng(3), round(GUSTY_S / dt_s)
    winds: list[Floats] = []
    for k in range(GUSTY_WINDS):
        pressure = GUSTY_MEAN * (1.0 + GUSTY_INTENSITY * noise(rng, frames, dt_s, 5 / 3))
        heading = k * GOLDEN_RAD + GUSTY_TURN_RAD * noise(rng, frames, dt_s, 2.0)
        winds.append(pressure[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1))
    return winds


def _linear_motion(step: Floats, force: Floats) -> Floats:
    """(T / 3, k) every third frame of the linear motion of oscillators under modal forces (T, k)."""
    return np.concatenate([response(row, force[:, k : k + 1])[::3] for k, row in enumerate(step)], axis=1)
