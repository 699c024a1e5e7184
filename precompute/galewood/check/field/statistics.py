"""Predicted against measured values: R², median ratio, logarithmic error; regressions on size alone."""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.util import Floats

CONIFERS = (0.0639, 3.247)
"""f = a + b DBH / H², Hz, cm, m: 609 conifers of Jackson and others and Moore and Maguire 2004, refitted."""
BROADLEAVES: dict[str, tuple[float, float, float]] = {
    "forest": (0.131, -0.542, -0.017),
    "open": (2.442, -1.526, 0.244),
}
"""ln f = a + b ln H + c ln DBH (Hz, m, cm): 111 forest-grown and 88 open-grown broadleaves, same data sets
(natural frequencies of Jackson and others; tree motion data synthesis 2021, 10.5194/bg-18-4059-2021)."""


def agreement(predicted: Floats, measured: Floats) -> dict[str, Any]:
    """Statistics of predictions (n,) of positive measurements (n,); None where n is too small."""
    ratio = predicted / measured
    return {
        "trees": len(measured),
        "r2": determination(predicted, measured),
        "r2_log": determination(np.log(predicted), np.log(measured)),
        "correlation_squared": _correlation_squared(predicted, measured),
        "median_ratio": float(np.median(ratio)) if len(ratio) else None,
        "rms_log_error": float(np.sqrt(np.mean(np.log(ratio) ** 2))) if len(ratio) else None,
    }


DEFINITIONS = {
    "r2": "1 - sum (measured - predicted)^2 / sum (measured - mean measured)^2: share of the variance of the "
    "measured frequencies explained by the predictions themselves, without any fitted line; may be negative",
    "r2_log": "the same of the logarithms",
    "correlation_squared": "squared correlation: R^2 of a line fitted to the predictions",
    "median_ratio": "median of predicted over measured",
    "rms_log_error": "root mean square of ln(predicted / measured)",
}


def determination(predicted: Floats, measured: Floats) -> float | None:
    """1 − Σ (y − p)² / Σ (y − ȳ)²; None if the measured values do not vary."""
    spread = float(((measured - measured.mean()) ** 2).sum()) if len(measured) > 1 else 0.0
    return 1 - float(((measured - predicted) ** 2).sum()) / spread if spread > 0 else None


def _correlation_squared(predicted: Floats, measured: Floats) -> float | None:
    if len(measured) < 3 or np.ptp(predicted) == 0 or np.ptp(measured) == 0:
        return None
    return float(np.corrcoef(predicted, measured)[0, 1] ** 2)


def conifer_hz(height_m: Floats, dbh_cm: Floats) -> Floats:
    """First frequency of conifers of these sizes, Hz."""
    return CONIFERS[0] + CONIFERS[1] * dbh_cm / height_m**2


def broadleaf_hz(setting: str, height_m: Floats, dbh_cm: Floats) -> Floats:
    """First frequency of forest-grown or open-grown broadleaves of these sizes, Hz."""
    a, b, c = BROADLEAVES[setting]
    return np.exp(a + b * np.log(height_m) + c * np.log(dbh_cm))


def left_out(height_m: Floats, dbh_cm: Floats, measured: Floats) -> Floats | None:
    """Each tree's value by the power law ln f = a + b ln H + c ln DBH fitted to all others.

    None for fewer than five trees, or if their sizes do not determine the law.
    """
    if len(measured) < 5:
        return None
    columns = np.column_stack([np.ones(len(height_m)), np.log(height_m), np.log(dbh_cm)])
    found = np.empty(len(measured))
    for k in range(len(found)):
        others = np.arange(len(found)) != k
        law, _, rank, _ = np.linalg.lstsq(columns[others], np.log(measured[others]))
        if rank < 3:
            return None
        found[k] = columns[k] @ law
    return np.exp(found)
