"""Named winds: the paper's six, and four presets for the forest page."""

from __future__ import annotations

from galewood.constants import PAPER_WAVES, WIND_PRESETS
from galewood.motion.wind.document import Wave, Wind, parse_wind


def paper_wind(k: int, design_speed_m_s: float, direction_deg: float = 60.0) -> Wind:
    """The paper's wind k (0 … 5): a single cosine wave with a constant direction (degrees)."""
    peak, depth, period_s, turns = PAPER_WAVES[k]
    return Wind(
        mean_speed_m_s=design_speed_m_s * peak / (1.0 + depth),
        direction_deg=direction_deg,
        gustiness=depth,
        heading_swing_deg=0.0,
        waves=(Wave(1.0 / period_s, 1.0, 0.0, turns),),
    )


PRESETS: dict[str, Wind] = {name: parse_wind(wind) for name, wind in WIND_PRESETS.items()}
