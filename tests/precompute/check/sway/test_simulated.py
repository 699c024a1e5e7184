"""The sway of a table in the wind of a record, against a forest that plays the table in the same wind."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import galewood
import numpy as np
import pytest
from galewood.check.sway import simulated_motion
from galewood.io.cli.commands import app
from galewood.measurements import MotionRecord, motion_record
from galewood.motion.wind import WindField, height_factor
from galewood.motion.wind.document import Wave
from galewood.packaged import species_folder
from galewood.pipeline.results import SHIPPED_FOLDER, read_shipped
from galewood.pipeline.stages import builtin_meshes
from galewood.player import WindDrivenTrees
from galewood.util import Floats
from typer.testing import CliRunner

from tests.precompute.check.sway.oscillators import slow_noise

SEED = 611
STEP_S, SECONDS = 1 / 30, 600.0


@pytest.fixture(scope="module")
def table() -> galewood.MotionTable:
    mesh = {mesh.name: mesh for mesh in builtin_meshes(species_folder())}["maple-forest"]
    shipped = read_shipped(species_folder() / SHIPPED_FOLDER, mesh.name, mesh.key)
    assert shipped is not None
    return galewood.MotionTable(shipped.result.table, shipped.result.render_glb, name="maple-forest")


def top_of_a_forest(table: galewood.MotionTable, wind: galewood.Wind) -> tuple[Floats, Floats]:
    """Displacement (T, 2) of the highest node, and the wind (T,) at the top, both after each step."""
    forest, field = WindDrivenTrees(table.table, [(0.0, 0.0, 0.0, 1.0)]), WindField(wind)
    top = table.table.node_basis[int(np.argmax(table.table.node_rest_m[:, 1]))]
    factor = float(height_factor(table.height_m, wind.height_exponent, wind.reference_height_m))
    moved, speed = np.empty((round(SECONDS / STEP_S), 2)), np.empty(round(SECONDS / STEP_S))
    x, z, place = np.zeros(1), np.zeros(1), np.zeros(1)
    for frame in range(len(moved)):
        forest.step(field, (frame + 1) * STEP_S, STEP_S)
        moved[frame] = (top @ forest.q[0])[[0, 2]]
        field.velocity(place, place, (frame + 1) * STEP_S, x, z)
        speed[frame] = factor * float(np.hypot(x[0], z[0]))
    return moved, speed


def test_a_record_of_the_simulation_itself_agrees(table: galewood.MotionTable, tmp_path: Path) -> None:
    print(f"seed {SEED}")
    frequencies = np.random.default_rng(SEED).uniform(0.05, 0.45, 16)
    wind = galewood.Wind(
        mean_speed_m_s=7.0, direction_deg=0.0, gustiness=0.6, heading_swing_deg=0.0, seed=SEED,
        waves=tuple(Wave(float(frequency), 1 / 16) for frequency in frequencies),
    )  # fmt: skip
    moved, speed = top_of_a_forest(table, wind)
    time_s = STEP_S * np.arange(1, len(moved) + 1)
    record = motion_record(time_s, moved, quantity="sway", unit="m", wind_m_s=speed)
    found = simulated_motion(table.table, record)
    late = slice(round(40 / STEP_S), None)  # the beginnings differ
    # a pose right after a step is that of the end of the step before
    error = found.values[late, 0][:-1] - record.values[late, 0][1:]
    print(error.std() / record.values[late, 0].std(), error.mean() / record.values[late, 0].mean())
    assert error.std() < 0.02 * record.values[late, 0].std()
    assert abs(error.mean()) < 0.02 * abs(record.values[late, 0].mean())

    path, figures, plot = tmp_path / "record.csv", tmp_path / "figures.json", tmp_path / "plot.png"
    settled = zip(time_s[late], moved[late], speed[late], strict=True)
    rows = [f"{t:.5f},{x:.7g},{z:.7g},{u:.6g}" for t, (x, z), u in settled]
    path.write_text("\n".join(["time (s),sway_x (m),sway_z (m),wind_speed", *rows]), encoding="utf-8")
    table.save(tmp_path / "maple.gwt")
    result = CliRunner().invoke(
        app,
        [
            "motion",
            str(path),
            "--tree",
            str(tmp_path / "maple.gwt"),
            "--json",
            str(figures),
            "--plot",
            str(plot),
        ],
    )
    assert result.exit_code == 0, result.output
    assert "maple simulated in the same wind" in " ".join(result.output.split())
    assert plot.stat().st_size > 10_000
    both: dict[str, Any] = json.loads(figures.read_text())
    simulated = both["simulated"]
    assert simulated["along"]["standard_deviation"] == pytest.approx(
        both["along"]["standard_deviation"], rel=0.03
    )
    gap = simulated["along"]["standard_deviation"] / both["along"]["standard_deviation"]
    print(gap, both["along"]["spectrum_slope"], simulated["along"]["spectrum_slope"])
    slopes = [one["along"]["spectrum_slope"]["0.05-0.8"] for one in (simulated, both)]
    assert slopes[0] == pytest.approx(slopes[1], abs=0.1)  # above, nothing moves
    gains = [np.array(one["wind"]["transfer"]["gain"]) for one in (both, simulated)]
    swayed = (np.array(both["wind"]["transfer"]["frequency_hz"]) > 0.1) & (gains[0] > 0.1 * gains[0].max())
    print(np.abs(gains[1][swayed] / gains[0][swayed] - 1).max())
    np.testing.assert_allclose(gains[1][swayed], gains[0][swayed], rtol=0.05)


def record_in(wind_m_s: Floats, quantity: Any = "strain") -> MotionRecord:
    """A record at 10 Hz of no motion."""
    return motion_record(np.arange(len(wind_m_s)) / 10, 0 * wind_m_s, quantity=quantity, wind_m_s=wind_m_s)


def test_the_simulated_tree_has_its_own_resonance(table: galewood.MotionTable) -> None:
    wind = np.maximum(1.5 + 0.5 * slow_noise(10.0, 3600.0, 1.0, SEED), 0.1)
    found = galewood.analyse_motion(simulated_motion(table.table, record_in(wind)))
    assert found.along.resonance is not None and found.wind is not None
    assert found.along.resonance.frequency_hz == pytest.approx(table.frequencies_hz[0], rel=0.08)
    assert found.along.resonance.damping_ratio > 0.04  # of wood and drag


def test_accelerations_are_those_of_the_sway(table: galewood.MotionTable) -> None:
    wind = np.maximum(5.0 + 1.5 * slow_noise(10.0, 300.0, 0.3, SEED), 0.1)
    sway = simulated_motion(table.table, record_in(wind)).values[:, 0]
    found = simulated_motion(table.table, record_in(wind, "acceleration"))
    assert (found.quantity, found.unit) == ("acceleration", "m/s²")
    twice = np.gradient(np.gradient(sway, 0.1), 0.1)
    assert np.corrcoef(twice[50:-50], found.values[50:-50, 0])[0, 1] > 0.9


def test_what_is_wrong_is_said(table: galewood.MotionTable) -> None:
    with pytest.raises(ValueError, match="no wind"):
        galewood.simulated_motion(table, motion_record(np.arange(300) / 10, np.zeros(300)))
    storm = simulated_motion(table.table, record_in(np.full(300, 70.0)))
    assert "stronger than the table was made for" in storm.notes[0]
    assert np.isfinite(storm.values).all()
