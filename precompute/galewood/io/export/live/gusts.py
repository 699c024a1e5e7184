"""The wind that a live tree begins with: the cosine wind of the document's numbers, at the tree's height."""

from __future__ import annotations

import math
from dataclasses import dataclass

from galewood.constants import COSINE_HEADING_HZ, COSINE_HEADING_PHASE
from galewood.motion.wind import Wind, height_factor, phase_turns


@dataclass(frozen=True)
class LiveGusts:
    """A mean wind and its gusts (spec/formats/wind.md, cosine, at the origin)."""

    wind_m_s: tuple[float, float]
    """Mean wind along x and z at the tree's height."""
    gustiness: float
    waves: tuple[tuple[float, float, float], ...]
    """Frequency (Hz), share, and phase (turns) of each wave of the speed."""
    swing: tuple[float, float, float]
    """The same of the heading, with its amplitude in radians at a gustiness of 1."""

    def at(self, time_s: float) -> tuple[float, float]:
        """The wind along x and z at a time, m/s."""
        ripple = sum(share * math.cos(math.tau * (hz * time_s + turns)) for hz, share, turns in self.waves)
        factor = max(0.0, 1.0 + self.gustiness * ripple)
        hz, most_rad, turns = self.swing
        angle = self.gustiness * most_rad * math.cos(math.tau * (hz * time_s + turns))
        c, s, (x, z) = math.cos(angle), math.sin(angle), self.wind_m_s
        return factor * (c * x - s * z), factor * (s * x + c * z)


def live_gusts(wind: Wind, height_m: float) -> LiveGusts:
    """Gusts of a document's waves and seed, whichever its model is."""
    factor = float(height_factor(height_m, wind.height_exponent, wind.reference_height_m))
    speed, heading = wind.mean_speed_m_s * factor, math.radians(wind.direction_deg)
    waves = tuple(
        (
            one.frequency_hz,
            one.share,
            phase_turns(wind.seed, k) if one.phase_turns < 0.0 else one.phase_turns,
        )
        for k, one in enumerate(wind.waves)
    )
    swing = math.radians(wind.heading_swing_deg), phase_turns(wind.seed, COSINE_HEADING_PHASE)
    return LiveGusts(
        (speed * math.cos(heading), speed * math.sin(heading)),
        wind.gustiness,
        waves,
        (COSINE_HEADING_HZ, *swing),
    )
