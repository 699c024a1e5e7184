"""Sampled winds and the FEM trajectories recorded under them, from which the table is made.

Six cosine winds in six directions, 180 frames each (paper, Sec. 6); in addition, to let a tree come to rest,
a gust followed by still air in each direction and one run in still air.
"""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from galewood.motion.wind import dynamic_pressure
from galewood.pipeline.sampling.crown_gusts import NO_GUSTS, CrownGusts
from galewood.util import Array, Floats, write_arrays
from galewood.versions import SAMPLING_VERSION

DIRECTIONS_DEG = (0.0, 60.0, 120.0, 180.0, 240.0, 300.0)
COSINE_WINDS = (
    # Never nearly calm: records of low pressure while a tree swings back would match in light winds.
    # peak speed / design speed, depth (U = peak (1 + depth cos) / (1 + depth)), period s, phase turns
    (0.22, 0.30, 4.0, 0.50),
    (0.36, 0.50, 3.0, 0.50),
    (0.50, 0.25, 6.0, 0.60),
    (0.66, 0.50, 2.5, 0.45),
    (0.83, 0.30, 5.0, 0.55),
    (1.00, 0.50, 3.5, 0.50),
)
COSINE_PREFIX = "cosine-"
ALL_COSINES = len(COSINE_WINDS) * len(DIRECTIONS_DEG)
GUST_PEAK = 0.6
GUST_S = 1.5
STILL_S = 4.5
FADE_S = 3.5
STILL_FRAMES = 8


@dataclass(frozen=True)
class SampleWind:
    """A wind to sample: the pressure vector (x, z), Pa, in the tree's frame at each frame."""

    name: str
    direction_deg: float
    pressure_pa: Floats  # (T, 2)
    fade_frames: int = 0
    """Number of final frames over which the motion is faded to exact rest; see ``fade``."""
    recorded: bool = True
    """Whether internal states are recorded for the paper's search; otherwise only the motion."""
    gusts: CrownGusts = NO_GUSTS
    """What the wind at each place of the crown differs from the pressure."""


@dataclass(frozen=True)
class Trajectory:
    """T records of one run and the displacements between them, float32."""

    displacement_m: Array  # (T + 1, n, 3) from the gravity rest pose
    pressure_pa: Array  # (T, 2) at the tree, acting in record i
    gusts: Array  # (7,) the gusts within the crown, ``CrownGusts.array``
    velocity: Array  # (T, q, 3) before record i
    force: Array  # (T, q, 3) internal force
    stiffness: Array  # (T, q, 6) xx yy zz xy xz yz of the diagonal blocks


class SampledRun(Protocol):
    """A trajectory in memory or on disk, with the fields of ``Trajectory``."""

    @property
    def displacement_m(self) -> Array: ...
    @property
    def pressure_pa(self) -> Array: ...
    @property
    def gusts(self) -> Array: ...
    @property
    def velocity(self) -> Array: ...
    @property
    def force(self) -> Array: ...
    @property
    def stiffness(self) -> Array: ...


class Body(Protocol):
    """The simulated system: the finite-element simulator, or a small exact system in tests."""

    def reset(self) -> None: ...

    def step(self, pressure_pa: Array) -> None: ...  # (2,), or (N, 2) of each node

    @property
    def place_m(self) -> Array: ...  # (N, 3) nodes at rest

    @property
    def u(self) -> Array: ...  # (n, 3)

    @property
    def v(self) -> Array: ...  # (n, 3)

    def recorded_force(self, vertices: Array) -> Array: ...  # (q, 3) at the state before the step

    def recorded_stiffness(self, vertices: Array) -> Array: ...  # (q, 3, 3) at the state before the step


def sample_winds(
    design_speed_m_s: float, dt_s: float, exponent: float, frames: int = 180
) -> list[SampleWind]:
    """The winds of a table: still air, 6 cosine × 6 directions, 6 gusts that die down.

    ``exponent`` is the streamlined exponent of the tree.
    Still air comes first: a tree that starts in no wind uses the lowest record of still air.
    """
    time_s = np.arange(frames, dtype=np.float64) * dt_s

    def pressure_of(share: Floats) -> Floats:
        return dynamic_pressure(design_speed_m_s * share, exponent)

    winds = [
        _wind(f"cosine-{k}", direction, pressure_of(_cosine(wind, time_s)))
        for k, wind in enumerate(COSINE_WINDS)
        for direction in DIRECTIONS_DEG
    ]
    gust, fade_frames = _gust(dt_s), round(FADE_S / dt_s)
    winds += [_wind("gust", d, pressure_of(gust), fade_frames) for d in DIRECTIONS_DEG]
    return [_wind("still", 0.0, np.zeros(STILL_FRAMES)), *winds]


def _cosine(wind: tuple[float, float, float, float], time_s: Floats) -> Floats:
    peak, depth, period_s, turns = wind
    return peak * (1.0 + depth * np.cos(2.0 * np.pi * (time_s / period_s + turns))) / (1.0 + depth)


def _gust(dt_s: float) -> Floats:
    """A gust that stops abruptly; a smooth one would record low pressure while the tree is still swinging."""
    return np.concatenate([np.full(round(GUST_S / dt_s), GUST_PEAK), np.zeros(round(STILL_S / dt_s))])


def _wind(name: str, direction_deg: float, pressure_pa: Floats, fade_frames: int = 0) -> SampleWind:
    heading = np.radians(direction_deg)
    along = np.array([np.cos(heading), np.sin(heading)])
    return SampleWind(
        f"{name}-{direction_deg:03.0f}", direction_deg, pressure_pa[:, None] * along, fade_frames
    )


def sample_trajectory(
    body: Body,
    wind: SampleWind,
    points: Array,
    dt_s: float,
    on_progress: Callable[[float], None] = lambda fraction: None,
) -> Trajectory:
    """Simulate a body from gravity rest under a wind and record S_i at the given vertices (q,).

    ``on_progress`` receives the completed fraction before every frame and may raise to cancel.
    """
    frames = len(wind.pressure_pa)
    body.reset()
    u, v = np.zeros((frames + 1, *body.u.shape), np.float32), np.zeros((frames, len(points), 3), np.float32)
    force, stiffness = np.zeros_like(v), np.zeros((frames, len(points), 6), np.float32)
    places = body.place_m if wind.gusts.intensity else body.place_m[:0]
    local_pa = wind.gusts.local_pa(places, wind.pressure_pa, dt_s)
    for i, pressure in enumerate(wind.pressure_pa):
        on_progress(i / frames)
        if len(points):
            v[i] = body.v[points]
        body.step(pressure + local_pa[i].T if len(places) else pressure)
        if len(points):
            force[i] = body.recorded_force(points)
            stiffness[i] = symmetric(body.recorded_stiffness(points))
        u[i + 1] = body.u
    recorded = Trajectory(u, wind.pressure_pa.astype(np.float32), wind.gusts.array, v, force, stiffness)
    return fade(recorded, wind.fade_frames, u[:-1, points], dt_s)


def symmetric(blocks: Array) -> Array:
    """xx yy zz xy xz yz of symmetric blocks (q, 3, 3)."""
    return blocks[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def fade(run: Trajectory, frames: int, points_m: Array, dt_s: float) -> Trajectory:
    """Fade the last frames of a run to exact rest, as leaf drag would in still air.

    Material damping alone lets the tree oscillate for half a minute and never reaches rest. The displacement
    is multiplied by a smooth window s that decreases from 1 to 0, the velocity becomes its derivative, and
    force and stiffness approach their values at rest (record 0) with the same s. points_m (T, q, 3) are the
    displacements of the sampled points. The last two records are exactly at rest.
    """
    if not frames:
        return run
    total = len(run.velocity)
    x = np.clip((np.arange(total + 1) - (total - 2 - frames)) / frames, 0.0, 1.0)
    s = ((1.0 - x) ** 3 * (1.0 + 3.0 * x + 6.0 * x * x)).astype(np.float32)[:, None, None]
    before = np.concatenate([s[:1], s[:-2]])
    slope = (s[:-1] - before) / np.float32(dt_s)
    return Trajectory(
        run.displacement_m * s,
        run.pressure_pa,
        run.gusts,
        run.velocity * before + points_m * slope,
        run.force[:1] + (run.force - run.force[:1]) * s[:-1],
        run.stiffness[:1] + (run.stiffness - run.stiffness[:1]) * s[:-1],
    )


def trajectory_key(model_hash: str, wind: SampleWind, points: Array) -> str:
    """Content hash of all inputs of a trajectory."""
    digest = hashlib.sha256(f"{SAMPLING_VERSION} {model_hash} {wind.fade_frames}".encode())
    digest.update(np.ascontiguousarray(wind.pressure_pa, np.float64).tobytes() + wind.gusts.array.tobytes())
    digest.update(np.ascontiguousarray(points, np.int64).tobytes())
    return digest.hexdigest()


def write_trajectory(path: Path, trajectory: Trajectory) -> None:
    """Write a trajectory atomically."""
    write_arrays(path, **vars(trajectory))


def is_whole(path: Path) -> bool:
    """Whether a trajectory file is complete: the index of its arrays is at the end."""
    try:
        with zipfile.ZipFile(path) as archive:
            return len(archive.namelist()) == len(Trajectory.__dataclass_fields__)
    except (OSError, zipfile.BadZipFile):
        return False


def read_trajectory(path: Path) -> Trajectory:
    """Read a trajectory written by ``write_trajectory``."""
    with np.load(path, allow_pickle=False) as arrays:
        return Trajectory(**{name: arrays[name] for name in Trajectory.__dataclass_fields__})


@dataclass(frozen=True)
class StoredRun:
    """A trajectory on disk; each array is read on access and not cached.

    All runs of a table are about 250 MB, and code that processes them one by one needs only one at a time.
    """

    path: Path

    @property
    def displacement_m(self) -> Array:
        return self._read("displacement_m")

    @property
    def pressure_pa(self) -> Array:
        return self._read("pressure_pa")

    @property
    def gusts(self) -> Array:
        return self._read("gusts")

    @property
    def velocity(self) -> Array:
        return self._read("velocity")

    @property
    def force(self) -> Array:
        return self._read("force")

    @property
    def stiffness(self) -> Array:
        return self._read("stiffness")

    def _read(self, name: str) -> Array:
        with np.load(self.path, allow_pickle=False) as arrays:
            return arrays[name]
