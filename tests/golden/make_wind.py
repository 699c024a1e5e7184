"""Write the golden winds: ``python -m tests.golden.make_wind``.

They hold velocities of every model at some of 10,000 frames, a wind that changes over time, exact values of
the eddies, and invalid documents with the path and text of their errors.
"""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
from galewood.motion.wind import with_front
from galewood.motion.wind.evaluation import PRESETS, Wave, Wind, WindError, WindField, paper_wind, parse_wind
from galewood.motion.wind.models.navier_stokes import Eddies
from galewood.motion.wind.recording import quantised
from galewood.motion.wind.schema import wind_schema

from tests.golden import GOLDEN_FOLDER

SCHEMA = GOLDEN_FOLDER.parent / "formats" / "wind.schema.json"
FRAME_S = 1.0 / 30.0
FRAMES = (0, 1, 2, 29, 400, 1999, 2000, 4321, 5760, 7001, 9000, 9998, 9999)
GUSTY: dict[str, Any] = {
    "mean_speed_m_s": 13.5,
    "direction_deg": -140.0,
    "gustiness": 0.9,
    "convection_speed_m_s": 11.0,
}
RECORDED = Wind(
    **GUSTY,
    seed=3,
    model="recorded",
    recording=quantised(np.random.default_rng(5).normal(size=(37, 2)), 0.4),
)
WINDS = (
    *PRESETS.values(),
    paper_wind(1, 12.0),
    paper_wind(5, 9.0, 275.0),
    Wind(**GUSTY, seed=4294967295, waves=(Wave(0.2, 0.5, 0.3), Wave(0.7, 0.5, -1.5, 0.25))),
    Wind(**GUSTY, seed=7, model="perlin", length_scale_m=35.0),
    Wind(**GUSTY, seed=4294967295, model="perlin", length_scale_m=5.0),
    Wind(**GUSTY, seed=7, model="spectral", length_scale_m=35.0, beta=0.0),
    Wind(**GUSTY, seed=8, model="spectral", length_scale_m=15.0, beta=2.0),
    Wind(**GUSTY, seed=2, model="navier-stokes", length_scale_m=12.0),
    RECORDED,
)
CHANGES = (
    (0.5, Wind(**GUSTY, seed=5, model="perlin", length_scale_m=35.0)),
    (0.9, Wind(9.0, 170.0, 0.4, 20.0, 5, "perlin", 60.0)),
    (2.0, Wind(9.0, -170.0, 0.4, 2.0, 5, "spectral", 60.0)),
    (2.2, Wind(3.0, 0.0, 0.4, 2.0, 5, "navier-stokes", 30.0)),
    (4.0, Wind(3.0, 0.0, 0.4, 2.0, 5)),
    (4.9, RECORDED),
    (5.6, replace(RECORDED, mean_speed_m_s=4.0, direction_deg=170.0)),
)
EDDY_STEPS = (0, 1, 100, 600)
GOOD = Wind(seed=1, model="spectral").document()
BAD: tuple[object, ...] = (
    None,
    [],
    {},
    {**GOOD, "version": 2},
    {**GOOD, "model": "breeze"},
    {**GOOD, "gusts": 1},
    {**GOOD, "waves": []},
    {**GOOD, "length_scale_m": 4.9},
    {key: value for key, value in GOOD.items() if key != "length_scale_m"},
    {key: value for key, value in GOOD.items() if key != "seed"},
    {**GOOD, "beta": 2.1},
    {**GOOD, "beta": None},
    {**GOOD, "mean_speed_m_s": "8"},
    {**GOOD, "mean_speed_m_s": 1e300},
    {**GOOD, "seed": 1.5},
    {**GOOD, "height_exponent": -0.1},
    {**GOOD, "model": "perlin", "beta": 1.0},
    {**Wind().document(), "length_scale_m": 20.0},
    {**Wind().document(), "waves": []},
    {**Wind().document(), "waves": [{"frequency_hz": 0.1, "share": 0.5}, {"frequency_hz": 9, "share": 0.5}]},
    {
        **Wind().document(),
        "waves": [{"frequency_hz": 0.1, "share": 0.6}, {"frequency_hz": 0.2, "share": 0.6}],
    },
    {**Wind().document(), "waves": [{"frequency_hz": 0.1, "share": 0.6, "colour": 1}]},
    {**GOOD, "recording": {}},
    {key: value for key, value in RECORDED.document().items() if key != "recording"},
    {**RECORDED.document(), "recording": {"interval_s": 0.01, "unit": 1, "pairs": "AAAAAAAAAAA="}},
    {**RECORDED.document(), "recording": {"interval_s": 1, "unit": 1, "pairs": "AAAA"}},
    {**RECORDED.document(), "recording": {"interval_s": 1, "unit": 1, "pairs": "AAAA AAAAAA="}},
    {**RECORDED.document(), "recording": {"interval_s": 1, "unit": 1, "pairs": "AAAAAAAAAAA=", "rate": 1}},
)


def places() -> tuple[np.ndarray, np.ndarray]:
    """A few places in a forest."""
    return tuple(np.random.default_rng(31).uniform(-300.0, 300.0, (2, 4)).round(3))


def velocities(field: WindField, times_s: list[float]) -> list[list[float]]:
    """Velocities (x of every place, then z) at each time."""
    x, z = places()
    out = np.zeros((2, len(x)))
    rows: list[list[float]] = []
    for time_s in times_s:
        field.velocity(x, z, time_s, out[0], out[1])
        rows.append(out.ravel().tolist())
    return rows


def models() -> list[dict[str, object]]:
    """Every wind at every frame of FRAMES."""
    times = [frame * FRAME_S for frame in FRAMES]
    return [{"wind": wind.document(), "velocity_m_s": velocities(WindField(wind), times)} for wind in WINDS]


def changed() -> dict[str, Any]:
    """A wind that changes several times, one row per tenth of a second."""
    field, rows, pending = WindField(Wind()), [], list(CHANGES)
    times = [k * 0.1 for k in range(60)]
    for time_s in times:
        while pending and pending[0][0] <= time_s:
            field.change(pending.pop(0)[1], time_s)
        rows += velocities(field, [time_s])
    changes = [{"time_s": time_s, "wind": wind.document()} for time_s, wind in CHANGES]
    return {"start": Wind().document(), "changes": changes, "times_s": times, "velocity_m_s": rows}


def with_fronts() -> dict[str, Any]:
    """A wind with more gust fronts than are kept, one row per half second; the last start later."""
    field, rows = WindField(Wind(6.5, 40.0, 0.5, 8.0, 3)), []
    starts = [
        (0.25, -20.0, -15.5),
        (1.0, 3.5, -60.0),
        (1.5, 100.0, 0.25),
        (2.0, -250.0, 12.0),
        (2.5, 0.5, 0.5),
    ]
    for time_s, x_m, z_m in starts:
        field.state = with_front(field.state, x_m, z_m, time_s)
    times = [k * 0.5 for k in range(40)]
    for time_s in times:
        rows += velocities(field, [time_s])
    return {
        "start": Wind(6.5, 40.0, 0.5, 8.0, 3).document(),
        "fronts": starts,
        "state": field.state.document(),
        "times_s": times,
        "velocity_m_s": rows,
    }


def eddies() -> list[dict[str, object]]:
    """Exact values of single cells after some steps."""
    solver, rows = Eddies(5), []
    for steps in EDDY_STEPS:
        while solver.steps < steps:
            solver.step()
        cells = solver.velocity[:, [0, 77, 8000, 16383]].ravel().tolist()
        rows.append({"steps": steps, "cells": cells})
    return rows


def refusals() -> list[dict[str, object]]:
    """Invalid documents with the path and the text of their error."""
    rows: list[dict[str, object]] = []
    for document in BAD:
        try:
            parse_wind(document)
        except WindError as error:
            rows.append({"document": document, "path": error.path, "expected": error.expected})
        else:
            raise AssertionError(f"not refused: {document}")
    return rows


def main() -> None:
    """Write the files."""
    x, z = places()
    golden = {
        "frame_s": FRAME_S,
        "frames": FRAMES,
        "x_m": x.tolist(),
        "z_m": z.tolist(),
        "models": models(),
        "changed": changed(),
        "fronts": with_fronts(),
        "eddies": eddies(),
        "refused": refusals(),
    }
    (GOLDEN_FOLDER / "wind_models.json").write_text(json.dumps(golden, separators=(",", ":")) + "\n")
    SCHEMA.write_text(json.dumps(wind_schema(), indent=2) + "\n")


if __name__ == "__main__":
    main()
