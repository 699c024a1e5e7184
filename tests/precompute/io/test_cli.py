"""The commands: what they write, and how they fail."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from galewood.io.cli.commands import app
from galewood.options import BuildRequest
from galewood.util import MeshError
from typer.testing import CliRunner

from tests.golden import GOLDEN_FOLDER
from tests.precompute.fixtures.labelled.trees import labelled_file

GOLDEN = GOLDEN_FOLDER / "pole.safetensors"


def test_every_command_has_help() -> None:
    for command in ("build", "simulate", "export", "evaluate", "bench", "verify"):
        assert CliRunner().invoke(app, [command, "--help"]).exit_code == 0


def test_simulate_plays_a_table(tmp_path: Path) -> None:
    figures = tmp_path / "deep" / "figures.json"
    result = CliRunner().invoke(app, ["simulate", str(GOLDEN), "--seconds", "8", "--json", str(figures)])
    assert result.exit_code == 0, result.output
    assert json.loads(figures.read_text())["largest_sway"] > 0.01


def test_in_still_air_nothing_sways(tmp_path: Path) -> None:
    figures = tmp_path / "figures.json"
    CliRunner().invoke(
        app, ["simulate", str(GOLDEN), "--speed", "0", "--seconds", "4", "--json", str(figures)]
    )
    assert json.loads(figures.read_text())["largest_sway"] == 0.0


def test_a_file_that_is_no_mesh_fails_with_a_sentence(tmp_path: Path) -> None:
    mesh = tmp_path / "tree.glb"
    mesh.write_bytes(b"glTF but not really")
    result = CliRunner().invoke(app, ["build", str(mesh), "--out", str(tmp_path / "out")])
    assert result.exit_code == 1
    assert not (tmp_path / "out").exists()


def test_a_build_asks_before_it_computes(tmp_path: Path) -> None:
    file = labelled_file("garden_scene", 41)
    mesh, out = tmp_path / file.filename, tmp_path / "out.gwt"
    mesh.write_bytes(file.data)
    result = CliRunner().invoke(app, ["build", str(mesh), "--out", str(out), "--cache-dir", str(tmp_path)])
    assert result.exit_code == 1 and not out.exists()
    said = " ".join(result.output.split())
    assert "Please check:" in said and "--accept" in said
    checked = CliRunner().invoke(app, ["check", str(mesh), "--strict"])
    assert checked.exit_code == 3 and "Please check:" in checked.output


def test_export_of_a_table_without_its_mesh_fails_with_a_sentence(tmp_path: Path) -> None:
    table = tmp_path / "pole.gwt"
    table.write_bytes(GOLDEN.read_bytes())
    command = ["export", str(table), "--out", str(tmp_path / "out"), "--seconds", "1"]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 1
    assert not (tmp_path / "out").exists()


def test_square_brackets_of_names_are_printed(tmp_path: Path) -> None:
    measurement = tmp_path / "mast [north].csv"
    measurement.write_text("time,speed [m/s]\n0,[red]fast\n")
    printed = CliRunner().invoke(app, ["convert", str(measurement), "--out", str(tmp_path / "wind.json")])
    assert "mast [north].csv" in printed.output.replace("\n", "")
    assert "'[red]fast' is not a number" in printed.output.replace("\n", " ").replace("  ", " ")


def test_an_unknown_part_of_the_bench_is_refused() -> None:
    result = CliRunner().invoke(app, ["bench", "speed"])
    assert result.exit_code == 2


def test_a_wood_that_is_none_is_refused_field_by_field(tmp_path: Path) -> None:
    mesh, wood = tmp_path / "tree.obj", tmp_path / "wood.json"
    mesh.write_text("v 0 0 0\n")
    wood.write_text('{"name": "lead", "density_kg_m3": 11340.0}')
    result = CliRunner().invoke(
        app, ["build", str(mesh), "--wood-properties", str(wood), "--out", str(tmp_path / "out")]
    )
    assert result.exit_code == 1
    assert "density_kg_m3" in result.output


def test_the_program_limits_the_libraries_threads_before_they_are_loaded() -> None:
    code = (
        "import sys; from galewood_server.cli import main; assert 'numpy' not in sys.modules;"
        "sys.argv = ['galewood', '--help']\n"
        "try: main.main()\nexcept SystemExit: pass\n"
        "import os, numpy; assert os.environ['OPENBLAS_NUM_THREADS'] == '1'"
    )
    bare = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    subprocess.run([sys.executable, "-c", code], env=bare, check=True, capture_output=True)


def test_a_table_is_played_in_a_measured_wind(tmp_path: Path) -> None:
    log = tmp_path / "mast.csv"
    log.write_text("time (s),speed (km/h),direction\n" + "\n".join(f"{k},36,270" for k in range(30)))
    assert CliRunner().invoke(app, ["convert", str(log)]).exit_code == 0
    played = ["simulate", str(GOLDEN), "--seconds", "4", "--wind"]
    result = CliRunner().invoke(app, [*played, str(tmp_path / "mast.wind.json")])
    assert result.exit_code == 0, result.output
    assert CliRunner().invoke(app, [*played, str(log)]).exit_code == 1


@pytest.mark.parametrize("method", ["modal", "paper"])
def test_a_table_is_played_in_a_preset(method: str) -> None:
    command = ["simulate", str(GOLDEN), "--seconds", "4", "--wind", "breeze", "--method", method]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 0, result.output
    result = CliRunner().invoke(app, ["simulate", str(GOLDEN), "--wind", "hurricane"])
    assert result.exit_code == 1 and "breeze" in result.output


def test_all_trees_of_a_file_are_built_and_a_failure_stops_none(tmp_path: Path, monkeypatch) -> None:
    file = labelled_file("three_trees_plain", 41)
    mesh = tmp_path / file.filename
    mesh.write_bytes(file.data)
    built: list[tuple[int | None, str]] = []

    def build_one(mesh: Path, request: BuildRequest, out: Path, *rest: object) -> None:
        built.append((request.tree, out.name))
        if request.tree == 2:
            raise MeshError("no-wood", "unsuitable", "No wood was found.", "Choose it.")

    monkeypatch.setattr("galewood.io.cli.build_command._build_one", build_one)
    command = ["build", str(mesh), "--out", str(tmp_path / "a.gwt"), "--all-trees", "--up-axis", "y"]
    result = CliRunner().invoke(app, command)
    assert built == [(1, "a-1.gwt"), (2, "a-2.gwt"), (3, "a-3.gwt")]
    assert result.exit_code == 1
    assert "No wood was found" in result.output and "1 of 3 trees failed" in result.output
