"""Statistics of a comparison: the model and regressions on size, each against the measured frequencies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from galewood.check.field.bending import bending_statistics
from galewood.check.field.statistics import (
    BROADLEAVES,
    DEFINITIONS,
    agreement,
    broadleaf_hz,
    conifer_hz,
    left_out,
)
from galewood.util import Floats

NAMES = {
    "model": "finite elements, main sway mode",
    "model_lowest": "finite elements, lowest mode",
    "conifers": "regression on size: conifers",
    "forest": "regression on size: forest-grown broadleaves",
    "open": "regression on size: open-grown broadleaves",
    "by_setting": "regression on size by the tree's setting",
    "own_power_law": "power law of these trees' sizes, each tree left out in turn",
}
Trees = list[dict[str, Any]]


def summarised(trees: Trees) -> dict[str, Any]:
    """Statistics of frequency (by method), damping and bending, with definitions.

    Predictions by size go into the trees.
    """
    for tree in trees:
        tree["size"] = size_of(tree)
    bending = bending_statistics(trees)
    trees = [tree for tree in trees if tree["frequency_hz"] is not None]
    for tree in trees:
        tree["predicted_hz"] = {"model": tree["model_frequency_hz"], "model_lowest": tree["model_lowest_hz"]}
    _add_regressions([tree for tree in trees if tree["size"] is not None])
    frequency = {
        method: {
            "name": name,
            **_agreement(trees, lambda tree, method=method: tree["predicted_hz"].get(method)),
        }
        for method, name in NAMES.items()
    }
    return {
        "frequency": {method: found for method, found in frequency.items() if found["trees"]},
        "damping": _damping(trees),
        "bending": bending,
        "definitions": DEFINITIONS,
    }


def size_of(tree: dict[str, Any]) -> tuple[float, float] | None:
    """Height, m, and DBH, cm: measured, or else those of the model; None if there is no DBH."""
    dbh = tree["dbh_cm"] or tree["model_dbh_cm"]
    return None if dbh is None else (tree["height_m"] or tree["model_height_m"], dbh)


def _add_regressions(trees: Trees) -> None:
    if not trees:
        return
    height, dbh = np.array([size_of(tree) for tree in trees], float).T
    measured = np.array([tree["frequency_hz"] for tree in trees], float)
    found: dict[str, Floats | None] = {"conifers": conifer_hz(height, dbh)}
    found |= {setting: broadleaf_hz(setting, height, dbh) for setting in BROADLEAVES}
    found["own_power_law"] = left_out(height, dbh, measured)
    for method, values in found.items():
        for tree, value in zip(trees, [] if values is None else values, strict=values is not None):
            tree["predicted_hz"][method] = float(value)
    for tree in trees:
        setting = {"conifer": "conifers"}.get(tree["setting"], tree["setting"])
        if setting:
            tree["predicted_hz"]["by_setting"] = tree["predicted_hz"][setting]


def _agreement(
    trees: Trees, predicted: Callable[[dict[str, Any]], float | None], measured: str = "frequency_hz"
) -> dict[str, Any]:
    pairs = [(predicted(tree), tree[measured]) for tree in trees]
    both = np.array([pair for pair in pairs if None not in pair], float).reshape(-1, 2)
    return agreement(both[:, 0], both[:, 1])


def _damping(trees: Trees) -> dict[str, Any]:
    return _agreement(trees, lambda tree: tree.get("model_damping_ratio"), "damping_ratio")
