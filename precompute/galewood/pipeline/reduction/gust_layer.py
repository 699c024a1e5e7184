"""The gust layer of a table: oscillators for gusts that differ within a crown (docs/design/0020-gusts.md).

The crown is divided into places, each of which feels its own gust. The response of the natural modes to
independent noise at all places is reduced by POD to a few oscillators, as the modal model is from winds that
are the same everywhere (``galewood.pipeline.reduction.oscillators``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from galewood.motion.modal import GustTensors, advance_gusts, no_gusts
from galewood.motion.wind import crown_field, speed_of_pressure, write_gusts
from galewood.pipeline.reduction.drag_points import clusters
from galewood.pipeline.reduction.oscillators import Exposure, Oscillators, propagators, reduced
from galewood.pipeline.sampling import noise
from galewood.solid.fem import FemSettings
from galewood.util import Array, Floats

PLACE_COUNT, OSCILLATOR_COUNT = 16, 12
WIND_COUNT, FRAME_COUNT = 4, 300
SPECTRUM_SLOPE = 1.0
"""Exponent of the noise's spectrum: flatter than the 5/3 of free air, as leaves break up the large eddies."""
NOISE_SEED = 4
DRAG_FACTOR = 1.85
"""Damping of motion in a gusty wind over pressure per speed and area: calibrated on six trees (FEM).

4/3 would be the mean over all directions in a steady wind, 1.65 that over the horizontal ones at 1.3.
"""
DIRECTION_COUNT = 200
"""Positions and headings of the field over which the mean gust of a place is averaged."""
GUST_INTENSITY = 0.3
"""Relative strength of the gusts that the range of the motion is computed from."""
RANGE_S = 60.0


@dataclass(frozen=True)
class GustModes:
    """A gust layer and the shapes (L, 3n) of its output modes, 1 m at the farthest vertex."""

    tensors: GustTensors
    shapes: Floats


def gust_modes(body: Oscillators, settings: FemSettings) -> GustModes:
    """The gust layer of a body; without one if the wind's force does not depend on the body's vertices."""
    exposure, wide = body.exposure, body.shapes.shape[1]
    nodes = np.flatnonzero(exposure.area_m2 > 0)
    if not len(nodes) or not len(exposure.place_m):
        return GustModes(no_gusts(exposure.streamlined_exponent), np.zeros((0, wide)))
    places = min(PLACE_COUNT, len(nodes))
    cluster = clusters(exposure.place_m[nodes], exposure.area_m2[nodes], places)
    members = [nodes[cluster == g] for g in range(int(cluster.max()) + 1)]
    area = exposure.area_m2 * exposure.share
    centres = np.array([_centre(exposure.place_m[m], area[m]) for m in members])
    loads = np.concatenate([_load(body, m, area) for m in members], axis=1)
    own = reduced(replace(body, load=loads), _noise(len(members), settings.dt_s), settings, OSCILLATOR_COUNT)
    step = propagators(own.omega, np.diag(own.damping), settings)
    step[:, [0, 3]] -= 1.0
    motion = own.shapes.reshape(len(own.omega), -1, 3)
    far = np.sqrt(np.square(motion).sum(axis=2).max(axis=1))
    tensors = (centres, step, own.load * far[:, None], _drag(motion, exposure))
    singles = (np.ascontiguousarray(tensor, np.float32) for tensor in tensors)
    layer = GustTensors(*singles, streamlined_exponent=exposure.streamlined_exponent)
    return GustModes(layer, own.shapes / far[:, None])


def gust_range(layer: GustModes, strengths_pa: Sequence[float], dt_s: float) -> list[Floats]:
    """Motion (T, L) of the layer's modes, m, in gusts on steady winds of these pressures along x."""
    frames = round(RANGE_S / dt_s)
    return [_motion(layer.tensors, pressure, dt_s, frames) for pressure in strengths_pa]


def _centre(places_m: Floats, weight: Floats) -> Floats:
    return np.average(places_m, axis=0, weights=weight)


def _load(body: Oscillators, members: Array, area: Floats) -> Floats:
    """(k, 2) modal force per Pa of the gust at the centre of a place, along x and z.

    The mean gust over a place is smaller than that at a point.
    """
    shapes = body.shapes.reshape(len(body.omega), -1, 3)[:, members]
    share = _mean_gust(body.exposure.place_m[members], area[members], body.exposure.streamlined_exponent)
    return share * np.einsum("n,kni->ki", area[members], shapes[:, :, [0, 2]])


def _mean_gust(places_m: Floats, weight: Floats, exponent: float) -> float:
    """Root mean square of the gust averaged over places, over that at a point."""
    rng = np.random.default_rng(NOISE_SEED)
    field, out = crown_field(0), np.zeros((1, 2 * len(places_m)))
    one, still = np.ones(1), np.array([[1.0, 0.0]])
    squares = np.zeros(2)
    for _ in range(DIRECTION_COUNT):
        heading, x, z = rng.uniform(0, (2 * np.pi, 48.0, 48.0))
        c, s = np.cos(heading), np.sin(heading)
        # so weak that no gust is limited, and in a wind along the heading
        carried = (c, s, 0.0, 1e-3)
        stand, pressure = (one * x, one * z), (one * c, one * s)
        write_gusts(field, carried, places_m, stand, still, one, pressure, exponent, out)
        gusts = out.reshape(-1, 2)
        squares += np.square(weight @ gusts / weight.sum()).sum(), np.square(gusts).sum(axis=1).mean()
    return float(np.sqrt(squares[0] / squares[1]))


def _noise(places: int, dt_s: float) -> list[Floats]:
    """Independent noise (T, 2G) along both axes at every place; a linear response needs no scale."""
    rng = np.random.default_rng(NOISE_SEED)
    return [
        np.stack([noise(rng, FRAME_COUNT, dt_s, SPECTRUM_SLOPE) for _ in range(2 * places)], axis=1)
        for _ in range(WIND_COUNT)
    ]


def _drag(motion: Floats, exposure: Exposure) -> Floats:
    """(L,) damping of each oscillator, 1/s, per Pa·s/m of the wind's pressure over its speed."""
    area = exposure.area_m2
    shelter = np.sqrt(np.average(exposure.share, weights=area))
    return DRAG_FACTOR * shelter * np.einsum("n,kni->k", area, np.square(motion / exposure.profile[:, None]))


def _motion(tensors: GustTensors, pressure_pa: float, dt_s: float, frames: int) -> Floats:
    place, *widened = (
        np.ascontiguousarray(tensor, np.float64)
        for tensor in (tensors.place, tensors.step, tensors.load, tensors.drag)
    )
    count, exponent = tensors.oscillators, tensors.streamlined_exponent
    state = tuple(np.zeros((1, count)) for _ in range(4))
    q = np.zeros((1, count), np.float32)
    one, nothing, turn = np.ones(1), np.zeros(1), np.array([[1.0, 0.0]])
    speed_m_s, pressure = float(speed_of_pressure(pressure_pa, exponent)), (pressure_pa * one, nothing)
    track, gusts, field = np.zeros((frames, count)), np.zeros((1, 2 * len(place))), crown_field(0)
    for frame in range(frames):
        carried = (1.0, 0.0, max(speed_m_s, 1.0) * frame * dt_s, GUST_INTENSITY)
        write_gusts(field, carried, place, (nothing, nothing), turn, one, pressure, exponent, gusts)
        advance_gusts((*widened, exponent), one, turn, nothing, pressure, gusts, state, q)
        track[frame] = state[0][0]
    return track
