"""Hourly (or ten-minute) winds of weeks or a year as classes of speed and direction."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from galewood.measurements import MeasurementError, measured_velocities

SPEED_STEP_M_S = 2.5
DIRECTION_COUNT = 8
CALM_M_S = 2.5
"""Weaker winds move no tree far; they are counted as calm."""


@dataclass(frozen=True)
class WindClass:
    """The upper end of a class of mean winds, the direction they blow towards, and how many there were."""

    speed_m_s: float
    direction_deg: float
    sample_count: int


def wind_classes(file: Path | str | bytes) -> tuple[WindClass, ...]:
    """The classes of a table of times, speeds and directions, the most frequent first; calms are left out.

    Raises MeasurementError, also if there is no wind beyond calms.
    """
    data = file if isinstance(file, bytes) else Path(file).read_bytes()
    velocity = measured_velocities(data)
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    towards = np.degrees(np.arctan2(-velocity[:, 1], velocity[:, 0]))  # from x (east) to z (south)
    windy = speed > CALM_M_S
    steps = np.ceil(speed[windy] / SPEED_STEP_M_S).astype(int)
    sectors = np.round(towards[windy] / (360 / DIRECTION_COUNT)).astype(int) % DIRECTION_COUNT
    counted = Counter(zip(steps.tolist(), sectors.tolist(), strict=True))
    if not counted:
        raise MeasurementError(f"no sample has a wind of more than {CALM_M_S:g} m/s")
    return tuple(
        WindClass(SPEED_STEP_M_S * step, 360.0 / DIRECTION_COUNT * sector, count)
        for (step, sector), count in counted.most_common()
    )
