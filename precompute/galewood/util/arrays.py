"""Array types for signatures throughout the library; docstrings give shapes and units."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Ints = npt.NDArray[np.integer[Any]]
Int32s = npt.NDArray[np.int32]
Int64s = npt.NDArray[np.int64]


def joined_array(parts: Sequence[object], name: str) -> Array:
    """One array of what several objects have under a name, end to end; theirs become views of it."""
    whole = np.concatenate([getattr(part, name) for part in parts])
    first = 0
    for part in parts:
        end = first + len(getattr(part, name))
        setattr(part, name, whole[first:end])
        first = end
    return whole
