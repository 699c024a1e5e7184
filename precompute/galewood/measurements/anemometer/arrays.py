"""A measured wind from arrays, as a program has read it from its own files."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from galewood.measurements.anemometer.columns import Columns
from galewood.measurements.anemometer.reading import Measurement, measurement_of
from galewood.measurements.anemometer.samples import FASTEST_M_S, MOST_ROWS, Samples
from galewood.measurements.array_values import numbers_of, seconds_of
from galewood.measurements.errors import MeasurementError

ARRAY_COLUMNS = Columns(
    ("time_s", "speed_m_s", "direction_deg"), 0, speed=1, direction=2, speed_unit="m/s", time_unit="s"
)


def measured_wind(
    time_s: npt.ArrayLike,
    speed_m_s: npt.ArrayLike,
    direction_deg: npt.ArrayLike | None = None,
    *,
    start_s: float = 0.0,
) -> Measurement:
    """The wind of n measured samples, as ``read_measurement`` makes it of a file.

    Args:
        time_s: (n,) times in s, or datetime64 (a pandas index, a coordinate of xarray).
        speed_m_s: (n,) wind speed; NaN where it is missing.
        direction_deg: (n,) or one number: degrees clockwise from north from which the wind blows; by default
            from the west (270).
        start_s: Leave out the samples before this time after the first. At most ten minutes at 10 Hz
            are used.

    Raises:
        MeasurementError: The arrays are no series of samples: what is wrong and what is expected.
    """
    times = seconds_of(time_s)
    count = len(times)
    speed = numbers_of("speed_m_s", speed_m_s, count)
    from_deg = numbers_of("direction_deg", 270.0 if direction_deg is None else direction_deg, count)
    if count > MOST_ROWS:
        raise MeasurementError(f"more than {MOST_ROWS} samples; pass a part of them")
    if bool(np.any(speed < 0.0)):
        raise MeasurementError("speed_m_s: a wind speed cannot be negative")
    fastest = speed > FASTEST_M_S
    speed = np.where(fastest, np.nan, speed)
    angle = np.radians(np.where(speed == 0.0, 0.0, from_deg))  # vanes have no direction in still air
    east, north = -speed * np.sin(angle), -speed * np.cos(angle)
    samples = Samples(ARRAY_COLUMNS, times.tolist(), east.tolist(), north.tolist(), int(fastest.sum()))
    return measurement_of(samples, start_s)
