"""Measured winds: golden files, and a synthetic measurement against the numbers it was made from."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.wind import MeasurementError, WindField, parse_wind, read_measurement

from tests.golden import make_measured

GOLDEN = json.loads((Path(__file__).parents[1] / "golden" / "measured.json").read_text())


def measured(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Components to the east and to the north, m/s."""
    return 5.0 + rng.normal(size=count), -4.0 + rng.normal(size=count)


def wind_at(field: WindField, x_m: float, z_m: float, time_s: float) -> np.ndarray:
    out = np.zeros((2, 1))
    field.velocity(np.array([x_m]), np.array([z_m]), time_s, out[0], out[1])
    return out[:, 0]


def test_samples_are_reproduced_at_the_origin_and_later_downwind() -> None:
    seed = 77
    print("seed", seed)
    east, north = measured(np.random.default_rng(seed), 200)
    speed, angle = np.hypot(east, north), np.degrees(np.arctan2(-east, -north)) % 360.0
    lines = [f"{0.25 * k},{speed[k]:.6f},{angle[k]:.6f}" for k in range(200)]
    found = read_measurement("\n".join(["t (s),speed (km/h),direction", *lines]).encode())
    factor = 1 / 3.6
    wind, report = found.wind, found.report
    assert report.mean_speed_m_s == pytest.approx(factor * speed.mean(), rel=1e-6)
    assert report.max_speed_m_s == pytest.approx(factor * speed.max(), rel=1e-6)
    assert report.intensity == pytest.approx(speed.std() / speed.mean(), rel=1e-6)
    assert report.from_deg == pytest.approx(
        math.degrees(math.atan2(-east.mean(), -north.mean())) % 360, abs=1e-4
    )
    field = WindField(parse_wind(json.loads(json.dumps(wind.document()))))
    heading = math.radians(wind.direction_deg)
    for k in (0, 1, 57, 199, 200 + 20 + 57):
        sample = k % (200 + 20)  # the passage back to the beginning takes 5 s
        expected = factor * np.array([east[sample], -north[sample]])
        assert wind_at(field, 0.0, 0.0, 0.25 * k) == pytest.approx(expected, abs=3e-4)
        for along_m, across_m in ((30.0, 0.0), (-12.0, 45.0)):
            x = along_m * math.cos(heading) - across_m * math.sin(heading)
            z = along_m * math.sin(heading) + across_m * math.cos(heading)
            later = wind_at(field, x, z, 0.25 * k + along_m / wind.convection_speed_m_s)
            assert later == pytest.approx(expected, abs=3e-4)


def test_the_loop_has_no_jump() -> None:
    found = read_measurement(make_measured.FILES["seconds"].encode())
    field = WindField(found.wind)
    times = np.arange(found.report.loop_s - 8.0, found.report.loop_s + 4.0, 0.01)
    velocity = np.array([wind_at(field, 0.0, 0.0, t) for t in times])
    inside = np.array([wind_at(field, 0.0, 0.0, t) for t in np.arange(2.0, 14.0, 0.01)])
    assert np.abs(np.diff(velocity, axis=0)).max() < 1.5 * np.abs(np.diff(inside, axis=0)).max()


def test_long_and_fast_files_are_cut_and_averaged() -> None:
    lines = "\n".join(f"{k / 20:.2f},{5 + k % 2},270" for k in range(20 * 60 * 20))
    found = read_measurement(f"time (s),speed (m/s),dir\n{lines}".encode(), start_s=60.0)
    assert found.wind.recording.fluctuations().shape == (6000, 2)
    assert found.report.used_s == pytest.approx(595.0)
    assert found.report.used_start_s == pytest.approx(60.0)
    assert found.report.max_speed_m_s == pytest.approx(5.5)  # two samples are averaged
    assert len(json.dumps(found.wind.document())) < 40_000


@pytest.mark.parametrize("known", GOLDEN["files"], ids=lambda known: known["name"])
def test_golden_files_are_current(known: dict[str, Any]) -> None:
    found = json.loads(json.dumps(make_measured.read(known["name"], make_measured.FILES[known["name"]])))
    for part in ("report", "wind"):
        for name, value in known[part].items():
            # sines and cosines differ in their last bit between platforms
            expected = pytest.approx(value) if isinstance(value, float) else value
            assert name == "recording" or found[part][name] == expected, name


@pytest.mark.parametrize("known", GOLDEN["refused"], ids=lambda known: known["name"])
def test_faults_are_named(known: dict[str, str]) -> None:
    with pytest.raises(MeasurementError) as error:
        read_measurement(known["text"].encode())
    assert str(error.value) == known["error"]


def test_the_meteorological_direction_is_where_the_wind_comes_from() -> None:
    text = "time,speed,direction\n" + "\n".join(f"{k},6,270" for k in range(20))
    wind = read_measurement(text.encode()).wind
    assert wind.direction_deg == pytest.approx(0.0, abs=1e-9)  # a westerly blows towards x
    text = "time,speed,direction\n" + "\n".join(f"{k},6,0" for k in range(20))
    assert read_measurement(text.encode()).wind.direction_deg == pytest.approx(90.0)  # a northerly, towards z
