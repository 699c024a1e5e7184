"""`galewood bench-serve` measures a server that it starts with the built-in trees."""

from __future__ import annotations

import json
from pathlib import Path

from galewood_server.cli.commands import app
from typer.testing import CliRunner


def test_a_small_load_is_streamed_without_losses(tmp_path: Path) -> None:
    out = tmp_path / "figures.json"
    load = ["--clients", "3", "--trees", "20", "--stalled", "2", "--seconds", "2"]
    load += ["--server-core", "-1", "--client-core", "-1"]
    found = CliRunner().invoke(app, ["bench-serve", *load, "--json", str(out)])
    assert found.exit_code == 0, found.output
    figures = json.loads(out.read_text())
    for phase in (figures["steady"], figures["with_stalled_clients"]):
        assert phase["frames_hz"]["slowest_client"] > 0
        assert phase["lost_clients"] == phase["base_mismatches"] == 0
    assert figures["with_stalled_clients"]["sockets_left"] >= 3
