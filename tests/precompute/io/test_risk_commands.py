"""`galewood strain` and `galewood critical-wind`: what they write, and how they fail."""

import csv
import json
from pathlib import Path

import pytest
from galewood.io.cli.commands import app
from galewood.solid.strain import CAUTION_TEXT
from typer.testing import CliRunner

from tests.precompute.fixtures.cylinder_models import simpleforest, y_model


@pytest.fixture
def fork(tmp_path: Path) -> Path:
    path = tmp_path / "fork.csv"
    path.write_bytes(simpleforest(y_model()))
    return path


def one_line(text: str) -> str:
    return " ".join(text.split())


def test_strain_writes_figures_and_sections(fork: Path) -> None:
    table, figures = fork.with_name("sections.csv"), fork.with_name("figures.json")
    command = ["strain", str(fork), "--species", "oak", "--speed", "20", "--csv", str(table)]
    result = CliRunner().invoke(app, [*command, "--json", str(figures)])
    assert result.exit_code == 0, result.output
    assert one_line(CAUTION_TEXT) in one_line(result.output)
    found = json.loads(figures.read_text())
    assert found["caution"] == CAUTION_TEXT
    lines = table.read_text().splitlines()
    assert lines[0] == f"# {CAUTION_TEXT}"
    rows = list(csv.DictReader(lines[1:]))
    stem = [float(row["strain"]) for row in rows if row["part"] == "stem"]
    assert max(stem) == pytest.approx(found["largest"]["stem"]["strain"], rel=1e-4)
    assert 0 < found["breast_height_strain"] <= max(stem)


def test_critical_wind_is_reported_in_leaf_and_bare(fork: Path) -> None:
    figures = fork.with_name("figures.json")
    command = ["critical-wind", str(fork), "--species", "oak", "--samples", "10", "--json", str(figures)]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 0, result.output
    assert one_line(CAUTION_TEXT) in one_line(result.output)
    assert "overturning: not assessed" in result.output
    found = json.loads(figures.read_text())
    assert set(found) == {"leaf", "bare"}
    assert found["bare"]["sample_count"] == 10


def test_a_file_that_is_no_tree_fails_with_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "tree.glb"
    path.write_bytes(b"glTF but not really")
    for command in ("strain", "critical-wind"):
        result = CliRunner().invoke(app, [command, str(path)])
        assert result.exit_code == 1
        assert "Traceback" not in result.output


def test_strain_beyond_rupture_is_said_and_silly_winds_are_refused(fork: Path, tmp_path: Path) -> None:
    def said(*options: str, code: int = 0) -> str:
        found = CliRunner().invoke(app, ["strain", str(fork), *options])
        assert found.exit_code == code, found.output
        return one_line(found.output)

    assert "would break" in said("--speed", "150", "--foliage", "bare", "--dbh-cm", "6")
    assert "would break" not in said("--speed", "1", "--foliage", "bare")
    assert "--direction" in said("--direction", "nan", code=1)
    assert "--direction" in said("--direction", "450", code=1)
    assert "--seconds" in said("--gusts", "--seconds", "0.05", code=1)
    (tmp_path / "wind.csv").write_text("time,speed\n0,3\n1,4\n")
    assert "galewood convert" in said("--wind", str(tmp_path / "wind.csv"), code=1)


def test_an_unknown_species_is_refused_by_name(fork: Path) -> None:
    result = CliRunner().invoke(app, ["strain", str(fork), "--species", "triffid"])
    assert result.exit_code == 1
    assert "--species" in result.output and "triffid" in result.output
