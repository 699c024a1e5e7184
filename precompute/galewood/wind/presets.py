"""Named winds: the paper's six, and four presets for the forest page."""

from __future__ import annotations

from galewood.wind.document import Wave, Wind

PAPER_WAVES = (
    # peak speed / design speed, depth (U = peak (1 + depth cos) / (1 + depth)), period s, phase turns
    (0.30, 0.5, 4.0, 0.50),
    (0.45, 0.9, 3.0, 0.50),
    (0.60, 0.3, 6.0, 0.60),
    (0.75, 0.7, 2.5, 0.45),
    (0.90, 0.3, 5.0, 0.55),
    (1.00, 0.8, 3.5, 0.50),
)
"""The paper shows its six cosine winds only in a figure without numbers; these span the same range."""


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


PRESETS: dict[str, Wind] = {
    "still": Wind(mean_speed_m_s=0.0, gustiness=0.5, convection_speed_m_s=4.0),
    "breeze": Wind(
        mean_speed_m_s=4.0, gustiness=0.4, convection_speed_m_s=4.0, model="perlin", length_scale_m=18.0
    ),
    "autumn-gusts": Wind(
        mean_speed_m_s=9.0, gustiness=0.75, convection_speed_m_s=10.0, model="spectral", length_scale_m=28.0
    ),
    "storm-front": Wind(
        mean_speed_m_s=20.0,
        gustiness=0.9,
        convection_speed_m_s=16.0,
        model="navier-stokes",
        length_scale_m=34.0,
    ),
}
