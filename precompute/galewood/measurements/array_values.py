"""Times and numbers that a program passes as arrays."""

from __future__ import annotations

from typing import cast

import numpy as np
import numpy.typing as npt

from galewood.measurements.errors import MeasurementError
from galewood.util import Floats


def seconds_of(time_s: npt.ArrayLike) -> Floats:
    """(n,) times in s, from the first sample where they are dates."""
    given = np.asarray(time_s)
    if given.dtype.kind == "M":
        dates = given.astype("datetime64[ns]").reshape(-1)
        since = (dates - dates[:1]) / np.timedelta64(1, "s")
        return cast(Floats, np.where(np.isnat(dates), np.nan, since))
    return numbers_of("time_s", given, given.size)


def numbers_of(name: str, values: npt.ArrayLike, count: int) -> Floats:
    """(count,) numbers, infinite ones as NaN. MeasurementError if the array has another length or is none."""
    try:
        given = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        raise MeasurementError(f"{name}: expected an array of numbers") from None
    if given.shape not in ((), (count,)):
        raise MeasurementError(f"{name}: expected {count} numbers, as many as time_s has, not {given.shape}")
    return np.where(np.isfinite(given), given, np.nan) * np.ones(count)
