"""The inventory of a service: its file, and the command that starts it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from galewood.inventory import read_inventory
from galewood_server.cli.commands import app
from typer.testing import CliRunner

from tests.server.conftest import Server

CSV = "x,y,species,height,dbh\n0,0,Bergahorn,12,30\n3,4,Foo bar,9,\n5,5,oak,,\n"


def test_the_file_is_served_as_it_is(start_server: Callable[..., Server], tmp_path: Path) -> None:
    path = tmp_path / "Bäume.csv"
    path.write_text(CSV)
    with start_server(GALEWOOD_INVENTORY=str(path)).client() as api:
        answer = api.get("/api/inventory")
        assert answer.status_code == 200
        assert answer.text == CSV
        assert answer.headers["content-type"].startswith("text/csv")
        assert answer.headers["content-disposition"].startswith("inline")
        path.unlink()
        answer = api.get("/api/inventory")
        assert (answer.status_code, answer.json()["code"]) == (404, "no-inventory")
        assert "galewood forest" in answer.json()["hint"]


def test_the_command_reports_trees_substitutes_and_skipped_rows(tmp_path: Path) -> None:
    path, report = tmp_path / "stand.csv", tmp_path / "report.json"
    path.write_text(CSV)
    result = CliRunner().invoke(app, ["forest", str(path), "--no-serve", "--json", str(report)])
    assert result.exit_code == 0, result.output
    assert "2 trees of 3 rows" in result.output
    assert "Foo bar: 1 shown as maple (unknown name)" in result.output
    assert "row 4: neither height nor diameter" in result.output
    assert json.loads(report.read_text())["stems"] == read_inventory(path).report.stems == 2


def test_the_command_refuses_other_files(tmp_path: Path) -> None:
    path = tmp_path / "wind.csv"
    path.write_text("time,speed,direction\n0,3,240\n")
    result = CliRunner().invoke(app, ["forest", str(path), "--no-serve"])
    assert result.exit_code == 1
