"""Time of the wind at a large forest, for each wind model."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from galewood.constants import TICK_HZ, WIND_MODELS
from galewood.motion.wind import Wind, WindField
from galewood.wood import LEAF_EXPONENT

FRAME_S = 1.0 / TICK_HZ


def bench_wind(trees: int = 10_000, frames: int = 60) -> dict[str, Any]:
    """Wall milliseconds per frame for the pressure at every tree: {model: {median_ms, worst_ms, prepare_ms}}.

    ``prepare_ms`` is the first frame, which prepares the model's texture (and compiles, unless cached).
    """
    return {"trees": trees, **{model: _bench_model(model, trees, frames) for model in WIND_MODELS}}


def _bench_model(model: str, trees: int, frames: int) -> dict[str, float]:
    x, z = np.random.default_rng(1).uniform(-300.0, 300.0, (2, trees))
    out = np.zeros((2, trees), np.float32)
    field = WindField(Wind(model=model))
    taken_ms: list[float] = []
    for frame in range(frames + 1):
        start = time.perf_counter()
        field.pressure(x, z, frame * FRAME_S, out[0], out[1], LEAF_EXPONENT)
        taken_ms.append(1e3 * (time.perf_counter() - start))
    prepare_ms, *rest = taken_ms
    return {"median_ms": float(np.median(rest)), "worst_ms": max(rest), "prepare_ms": prepare_ms}
