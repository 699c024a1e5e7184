"""Write the golden reach of trees in gusts: ``python -m tests.golden.make_reach``.

It covers the whole way from a wind to the largest reach of drawn vertices: the sway envelope of Python is
that of the trees that the page plays.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from galewood.check.envelope import WindClass, sway_envelope
from galewood.check.envelope.reach import (
    LOOK_INTERVAL_S,
    SETTLING_S,
    gusts_in_class,
    places_in_class,
)
from galewood.table import decode

from tests.golden import GOLDEN_FOLDER

GUSTS, SEED, COUNT, SECONDS = WindClass(6.0, 40.0, 1), 7, 3, 20.0


def reach_vectors() -> dict[str, Any]:
    """The reach of trees of the pole's table, with vertices at random about its axis."""
    table = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    frame_s = float(table.metadata["dt_s"])
    size = (len(table.vertex_joint), 3)
    rest_m = np.random.default_rng(31).uniform((-0.5, 0.0, -0.5), (0.5, 4.0, 0.5), size)
    found = sway_envelope(table, rest_m, [GUSTS], sample_count=COUNT, seconds=SECONDS, seed=SEED)
    return {
        "table": "pole.safetensors",
        "wind": gusts_in_class(GUSTS, SEED).document(),
        "trees": places_in_class(GUSTS, COUNT).tolist(),
        "frame_s": frame_s,
        "first_frame": round(SETTLING_S / frame_s) + 1,
        "last_frame": round((SETTLING_S + SECONDS) / frame_s),
        "every": max(1, round(LOOK_INTERVAL_S / frame_s)),
        "rest_m": rest_m.tolist(),
        "height_m": found.height_m.tolist(),
        "direction_deg": found.direction_deg.tolist(),
        "reach_at_rest_m": found.rest_m.tolist(),
        "reach_m": found.reach_m.tolist(),
    }


if __name__ == "__main__":
    text = json.dumps(reach_vectors(), separators=(",", ":"))
    (GOLDEN_FOLDER / "reach.json").write_text(text + "\n")
