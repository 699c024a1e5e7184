"""A measured wind inside a wind document: fluctuations at equal intervals, repeated endlessly."""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from galewood.constants import (
    FEWEST_RECORDING_SAMPLES,
    MOST_RECORDING_SAMPLES,
    RECORDING_FIELDS,
    STILL_RECORDING,
)
from galewood.motion.wind.fields import Field, WindError, number_at, object_at, refuse_unknown
from galewood.util import Floats

LARGEST_COUNT = 32_767
RECORDING_RULES = {name: Field(**field) for name, field in RECORDING_FIELDS.items()}
PAIRS_EXPECTED = (
    f"expected {FEWEST_RECORDING_SAMPLES}..{MOST_RECORDING_SAMPLES} pairs of 16-bit integers, little-endian, "
    "in base64"
)
_BASE64 = re.compile(r"[A-Za-z0-9+/]+={0,2}")


@dataclass(frozen=True)
class Recording:
    """Fluctuations of a measured wind, quantised to 16 bits; specified in spec/formats/wind.md."""

    interval_s: float
    unit: float
    """The fluctuation that one count stands for."""
    pairs: str
    """Fluctuations along and across the wind, in counts: int16, little-endian, base64."""

    def document(self) -> dict[str, object]:
        """The JSON object that ``recording_at`` accepts."""
        return {"interval_s": self.interval_s, "unit": self.unit, "pairs": self.pairs}

    def fluctuations(self) -> Floats:
        """(count, 2) fluctuations along and across the wind, in standard deviations at this gustiness."""
        counts = np.frombuffer(base64.b64decode(self.pairs), "<i2").reshape(-1, 2)
        return counts.astype(np.float64) * self.unit


EMPTY_RECORDING = Recording(**STILL_RECORDING)


def quantised(fluctuations: npt.ArrayLike, interval_s: float) -> Recording:
    """A recording of (count, 2) fluctuations, whose largest takes the largest count."""
    values = np.asarray(fluctuations, np.float64)
    unit = float(np.abs(values).max(initial=0.0)) / LARGEST_COUNT
    counts = np.floor(values / unit + 0.5) if unit > 0.0 else np.zeros_like(values)
    return Recording(interval_s, unit, base64.b64encode(counts.astype("<i2").tobytes()).decode())


def recording_at(value: object, path: str) -> Recording:
    """Parse the field ``recording``. Raises WindError with the invalid field."""
    if value is None:
        raise WindError(path, "missing, expected an object")
    fields = object_at(value, path)
    refuse_unknown(fields, [*RECORDING_RULES, "pairs"], path, "not a field of a recording")
    numbers = {name: number_at(fields, name, rule, path) for name, rule in RECORDING_RULES.items()}
    pairs = fields.get("pairs")
    if not isinstance(pairs, str) or not _is_pairs(pairs):
        raise WindError(f"{path}.pairs", PAIRS_EXPECTED)
    return Recording(pairs=pairs, **numbers)


def _is_pairs(text: str) -> bool:
    if len(text) % 4 or len(text) > 8 * MOST_RECORDING_SAMPLES or not _BASE64.fullmatch(text):
        return False
    count, rest = divmod(len(base64.b64decode(text)), 4)
    return rest == 0 and FEWEST_RECORDING_SAMPLES <= count <= MOST_RECORDING_SAMPLES
