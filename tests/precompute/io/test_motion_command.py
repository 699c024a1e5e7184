"""`galewood motion`: figures, plot, comparison and calibration of a pole; what is wrong is said."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.io.cli.commands import app
from galewood.wood import read_wood_document
from typer.testing import CliRunner

from tests.precompute.check.sway.oscillators import driven_oscillator
from tests.precompute.fixtures.tree_meshes import obj_bytes, tube

FREQUENCY_HZ, DAMPING_RATIO = 0.9, 0.05


def run(*arguments: str | Path) -> Any:
    return CliRunner().invoke(app, ["motion", *map(str, arguments)])


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("record") / "pole.csv"
    along = driven_oscillator(FREQUENCY_HZ, DAMPING_RATIO, 10.0, 1800.0, 3)
    across = 0.4 * driven_oscillator(FREQUENCY_HZ, DAMPING_RATIO, 10.0, 1800.0, 4)
    rows = [f"{k / 10},{a:.6g},{b:.6g}" for k, (a, b) in enumerate(zip(along, across, strict=True))]
    path.write_text("\n".join(["time (s),strain_x (µε),strain_y (µε)", *rows]), encoding="utf-8")
    return path


def test_figures_and_plot(record: Path, tmp_path: Path) -> None:
    figures, plot = tmp_path / "figures.json", tmp_path / "plots" / "pole.png"
    found = run(record, "--json", figures, "--plot", plot)
    assert found.exit_code == 0, found.output
    assert "strain, two axes, 10 samples per second, 30 min" in found.output
    assert "by random decrement" in found.output and plot.stat().st_size > 10_000
    along = json.loads(figures.read_text())["along"]
    assert along["frequency_hz"] == pytest.approx(FREQUENCY_HZ, rel=0.02)
    assert along["damping_ratio"] == pytest.approx(DAMPING_RATIO, rel=0.3)


def test_a_calibrated_pole_sways_like_its_record(record: Path, tmp_path: Path) -> None:
    tree, wood, figures = (tmp_path / name for name in ("pole.obj", "wood.json", "figures.json"))
    tree.write_bytes(obj_bytes(tube((0, 0, 0), (0, 6, 0), 0.05, 0.03, sides=16)))
    common = (record, "--tree", tree, "--species", "ash", "--foliage", "bare", "--target-tets", "600")
    cache = ("--cache-dir", tmp_path / "cache")
    found = run(*common, *cache, "--calibrate", wood, "--json", figures)
    assert found.exit_code == 0, found.output
    calibration = json.loads(figures.read_text())["calibration"]
    assert calibration["reached"]
    assert calibration["with"]["frequency_hz"] == pytest.approx(FREQUENCY_HZ, rel=0.02)
    calibrated = read_wood_document(wood.read_bytes()).wood()
    assert calibrated.young_longitudinal_pa == pytest.approx(calibration["young_longitudinal_pa"])
    again = run(*common, *cache, "--wood-properties", wood, "--json", figures)
    assert again.exit_code == 0, again.output
    predicted = json.loads(figures.read_text())["model"]
    assert predicted["frequency_hz"] == pytest.approx(calibration["with"]["frequency_hz"], rel=1e-3)
    assert np.isclose(predicted["damping_ratio"], calibration["with"]["damping_ratio"], rtol=1e-2)


def test_what_is_wrong_is_said(record: Path, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.csv"
    wrong.write_text("name,size\nash,3\n")
    found = run(wrong)
    assert found.exit_code == 1 and "wrong.csv: no columns of a record of motion" in found.output
    assert run(record, "--calibrate", tmp_path / "wood.json").exit_code == 2
    assert run(record, "--columns", "strain_x").exit_code == 2
    missing = run(record, "--columns", "axis1=strain_z")
    flat = tmp_path / "flat.csv"
    flat.write_text("\n".join(["time,strain_x,strain_y", *(f"{k / 10},12,12" for k in range(900))]))
    still = run(flat)
    assert still.exit_code == 0 and "no motion" in still.output
    picture = run(record, "--plot", tmp_path / "plot.txt")
    assert picture.exit_code == 1 and "plot.txt was not written" in picture.output
    assert missing.exit_code == 1 and "there is no column 'strain_z'" in missing.output
