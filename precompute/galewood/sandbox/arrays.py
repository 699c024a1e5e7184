"""What is passed to a child and back: arrays by name, which may hold bytes or JSON."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]


def to_bytes_array(content: bytes) -> NDArray[np.uint8]:
    """Bytes as an array that can be stored in .npz."""
    return np.frombuffer(content, dtype=np.uint8)


def to_json_array(value: Any) -> NDArray[np.uint8]:
    """A value as JSON in an array that can be stored in .npz."""
    return to_bytes_array(json.dumps(value).encode())


def from_json_array(array: NDArray[Any]) -> Any:
    """Inverse of to_json_array."""
    return json.loads(array.tobytes())
