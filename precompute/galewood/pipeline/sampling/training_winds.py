"""Training winds of the modal model: noise, resonant and crossed gusts, each as strong as its sway requires,
the same everywhere in the crown or with gusts within it.

Cosine winds alone excite too little of the motion: every operator fitted to them diverged under other winds
(docs/design/0013-training-runs.md).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from galewood.motion.wind import dynamic_pressure
from galewood.options import TRAINING_SEED
from galewood.pipeline.sampling.crown_gusts import CROWN_FIELD_M, CROWN_SPEEDS_M_S, NO_GUSTS, CrownGusts
from galewood.pipeline.sampling.recording import SampleWind
from galewood.util import Floats

WIND_COUNT, FRAMES_PER_WIND = 15, 200
GUST_WIND_COUNT, FRAMES_PER_GUST_WIND = 24, 300
"""Winds with gusts within the crown."""
SWAY_SHARES = (0.2, 0.05, 0.2, 0.1, 0.2, 0.03, 0.15)
"""Largest sway of the winds, in turn, over the height. Seven, as the kinds of wind repeat after five."""
GUST_SWAY_SHARES = (
    (0.3, 0.45), (0.1, 0.1), (0.2, 0.2), (0.05, 0.05), (0.26, 0.38), (0.15, 0.15), (0.22, 0.3),
)  # fmt: skip
"""The same of the winds with gusts within the crown, and what a wind with the gusts of a storm may cause."""
STORM_GUST_M_S = 30.0
"""Speed of the strongest gusts of a storm with a mean of 18 m/s."""
STRONGEST_M_S = 60.0
"""Limit of the speed, for trees too stiff to sway so far in any wind."""
TRAINING_GUSTINESS, WHITE_GUSTINESS = 0.45, 0.6
"""Standard deviation of the speed over its mean."""
GUSTINESSES, WANDERS_RAD = (0.12, 0.4), (0.1, 0.5)
"""Ranges of that and of the standard deviation of the heading in winds with gusts within the crown.

Small ones too, so that the tree stays bent for long.
"""
HEADING_TURNS = 0.5
"""Turns of the heading during a wind, in addition to its variation."""
CROWN_INTENSITIES = (0.25, 0.6)
"""Ranges of the gusts within the crown: standard deviation over the speed, and how fast they pass."""
CALM_FRAMES = 60
"""Still air at the end of some winds: a free decay after an abrupt stop."""
GOLDEN_RAD = np.pi * (3.0 - np.sqrt(5.0))
"""Between the headings at which successive winds start, so that any few of them differ."""


@dataclass(frozen=True)
class WindShape:
    """A training wind up to its strength: velocity (T, 2) over its peak, and the sway it shall cause.

    ``exponent`` is the streamlined exponent of the tree.
    """

    name: str
    velocity: Floats
    sway_share: float
    storm_sway_share: float
    """At least ``sway_share``."""
    exponent: float
    gusts: CrownGusts = NO_GUSTS

    def most_sway_share(self, peak_m_s: float) -> float:
        """The sway that it may cause at a peak speed: slender trees also learn what storms do to them."""
        return self.storm_sway_share if peak_m_s <= STORM_GUST_M_S else self.sway_share

    def pressure_pa(self, peak_m_s: float) -> Floats:
        """Pressure vectors (T, 2), Pa, at a peak speed."""
        speed = np.linalg.norm(self.velocity, axis=1)
        along = self.velocity / np.maximum(speed, 1e-12)[:, None]
        return dynamic_pressure(peak_m_s * speed, self.exponent)[:, None] * along

    def at(self, peak_m_s: float) -> SampleWind:
        """The wind at a peak speed."""
        x, z = self.velocity[0]
        return SampleWind(
            self.name, float(np.degrees(np.arctan2(z, x))), self.pressure_pa(peak_m_s),
            recorded=False, gusts=self.gusts,
        )  # fmt: skip


@dataclass(frozen=True)
class _Setting:
    """What a wind is drawn from; ``turn_rad`` (T,) is the steady turn of its heading."""

    rng: np.random.Generator
    dt_s: float
    first_hz: float
    start_rad: float
    turn_rad: Floats

    @property
    def time_s(self) -> Floats:
        return np.arange(len(self.turn_rad), dtype=np.float64) * self.dt_s

    def noise(self, beta: float) -> Floats:
        return noise(self.rng, len(self.turn_rad), self.dt_s, beta)


def training_shapes(
    first_hz: float, dt_s: float, exponent: float, *, seed: int = TRAINING_SEED, count: int = WIND_COUNT
) -> list[WindShape]:
    """The first training winds of a tree with this first natural frequency and streamlined exponent.

    In groups of five: two of noise with a −5/3 spectrum, square waves near the first frequency, white noise,
    and two crossed waves near that frequency (sine or square). Some end with a stop.
    """
    rng = np.random.default_rng((seed, 2))
    first_rad = rng.uniform(0, 2 * np.pi)
    turn_rad = HEADING_TURNS * np.linspace(0, 2 * np.pi, FRAMES_PER_WIND)
    shapes: list[WindShape] = []
    for k in range(count):
        side = 1.0 if k % 3 else -1.0
        setting = _Setting(rng, dt_s, first_hz, first_rad + k * GOLDEN_RAD, side * turn_rad)
        velocity = _KINDS[k % len(_KINDS)](setting)
        if k % 10 in (1, 4, 6):
            velocity[-CALM_FRAMES:] = 0.0
        velocity /= np.linalg.norm(velocity, axis=1).max()
        share = SWAY_SHARES[k % len(SWAY_SHARES)]
        shapes.append(WindShape(f"training-{k:02d}", velocity, share, share, exponent))
    return shapes


def gust_shapes(
    dt_s: float, exponent: float, *, seed: int = TRAINING_SEED, count: int = GUST_WIND_COUNT
) -> list[WindShape]:
    """Training winds of noise with gusts within the crown, each with its own field, heading and speed."""
    rng = np.random.default_rng((seed, 3))
    first_rad, steady = rng.uniform(0, 2 * np.pi), np.zeros(FRAMES_PER_GUST_WIND)
    shapes: list[WindShape] = []
    for k in range(count):
        heading_rad = first_rad + k * GOLDEN_RAD
        of = _Setting(rng, dt_s, 0.0, heading_rad, steady)
        speed = np.clip(1.0 + rng.uniform(*GUSTINESSES) * of.noise(5 / 3), 0.0, 1.8)
        velocity = _along(speed, heading_rad + rng.uniform(*WANDERS_RAD) * of.noise(2.0))
        velocity /= np.linalg.norm(velocity, axis=1).max()
        x_m, z_m = rng.uniform(0, CROWN_FIELD_M, 2).tolist()
        speed_m_s, intensity = rng.uniform(*CROWN_SPEEDS_M_S), rng.uniform(*CROWN_INTENSITIES)
        gusts = CrownGusts(int(rng.integers(2**31)), x_m, z_m, heading_rad, speed_m_s, intensity, exponent)
        shares = GUST_SWAY_SHARES[k % len(GUST_SWAY_SHARES)]
        shapes.append(WindShape(f"training-gusts-{k:02d}", velocity, *shares, exponent, gusts))
    return shapes


def _gusts(of: _Setting) -> Floats:
    speed = np.clip(1.0 + TRAINING_GUSTINESS * of.noise(5 / 3), 0.0, 1.6)
    wander = of.rng.uniform(0.3, 0.7) * of.noise(2.0)
    return _along(speed, of.start_rad + of.turn_rad + wander)


def _white(of: _Setting) -> Floats:
    speed = np.clip(1.0 + WHITE_GUSTINESS * of.noise(0.0), 0.0, 2.0)
    return _along(speed, of.start_rad + of.turn_rad + of.rng.uniform(0.3, 1.0) * of.noise(1.0))


def _resonant_square(of: _Setting) -> Floats:
    """Between a lull and full speed, within a fifth of the first frequency."""
    frequency, phase = of.first_hz * of.rng.uniform(0.8, 1.2), of.rng.uniform(0, 2 * np.pi)
    lull = of.rng.uniform(0.0, 0.3)
    speed = np.where(np.sin(2 * np.pi * frequency * of.time_s + phase) > 0, 1.0, lull)
    return _along(speed, of.start_rad + of.rng.uniform(0, 0.6) * of.turn_rad)


def _crossed(of: _Setting) -> Floats:
    """Waves along and across a heading, near the first frequency; every second time square ones."""
    hz = of.first_hz * of.rng.uniform(0.85, 1.15, 2)
    along, across = np.sin(2 * np.pi * hz[:, None] * of.time_s + [[0.0], [of.rng.uniform(0, 2 * np.pi)]])
    mean = of.rng.uniform(0.0, 0.5)
    if of.rng.random() < 0.5:
        along, across = np.sign(along), np.sign(across)
    waves = np.stack([mean + (1 - mean) * along, (1 - mean) * across], axis=1)
    c, s = np.cos(of.start_rad), np.sin(of.start_rad)
    return waves @ np.array([[c, s], [-s, c]])


_KINDS: tuple[Callable[[_Setting], Floats], ...] = (_gusts, _gusts, _resonant_square, _white, _crossed)


def noise(rng: np.random.Generator, frames: int, dt_s: float, beta: float) -> Floats:
    """(frames,) random series of unit variance with power ∝ f^−beta between 0.03 and 3 Hz."""
    frequency = np.fft.rfftfreq(2 * frames, dt_s)
    inside = (frequency >= 0.03) & (frequency <= 3.0)
    amplitude = np.where(inside, np.maximum(frequency, 0.03) ** (-beta / 2), 0.0)
    turned = amplitude * np.exp(2j * np.pi * rng.random(len(frequency)))
    series = np.fft.irfft(turned, 2 * frames)[:frames]
    return (series - series.mean()) / series.std()


def _along(speed: Floats, heading_rad: Floats) -> Floats:
    return speed[:, None] * np.stack([np.cos(heading_rad), np.sin(heading_rad)], axis=1)
