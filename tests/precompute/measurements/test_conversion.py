"""Text files of measurements are recognised by their columns; what `galewood convert` makes of them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from galewood.io.cli import app
from galewood.measurements import (
    Measurement,
    MeasurementError,
    UnknownContentError,
    convert_limited,
    read_data_file,
    read_measurement,
)
from galewood.measurements.inventory import Inventory, InventoryError, read_inventory
from galewood.motion.wind import parse_wind
from galewood.util import MeshError
from typer.testing import CliRunner

STAND = "x,y,species,height,dbh\n0,0,Bergahorn,12,30\n3,4,Foo bar,9,\n5,5,oak,,\n"
POINT = '{"type": "Feature", "geometry": {"type": "Point", "coordinates": [8, 49]}, "properties": {"h": 9}}'
GEOJSON = f'{{"type": "FeatureCollection", "features": [{POINT}]}}'
MAST = "time (s),speed (m/s),direction\n" + "".join(f"{k},{6 + k % 3},270\n" for k in range(40))
TREES = (
    "branch_order,start_x,start_y,start_z,axis_x,axis_y,axis_z,radius,length\n0,0,0,0,0,0,1,0.1,2\n",
    "x,y,z\n0,0,0\n",
    "v 0 0 0\nv 0 1 0\nf 1 2 3\n",
    "",
    "\x00\x01",
    '"' + "a" * 50_000,
)


@pytest.mark.parametrize("text", [STAND, GEOJSON, "# plot 7\n\n" + STAND.replace(",", ";")])
def test_inventories_are_recognised(text: str) -> None:
    found = read_data_file(text.encode())
    assert isinstance(found, Inventory)
    assert found == read_inventory(text.encode())


@pytest.mark.parametrize("text", [MAST, MAST.partition("\n")[2], MAST.replace(",", "\t")])
def test_records_of_anemometers_are_recognised_also_without_names(text: str) -> None:
    found = read_data_file(text.encode(), start_s=5.0)
    assert isinstance(found, Measurement)
    assert found == read_measurement(text.encode(), start_s=5.0)
    assert found.report.used_start_s == 5.0


@pytest.mark.parametrize("text", TREES)
def test_other_files_are_not(text: str) -> None:
    with pytest.raises(UnknownContentError, match="column names"):
        read_data_file(text.encode())


def test_faults_are_those_of_the_readers() -> None:
    with pytest.raises(InventoryError, match="line 2: no coordinates"):
        read_data_file(b"x,y,height\n0,,3\n")
    with pytest.raises(MeasurementError, match="line 2, column 'speed': 'fast' is not a number"):
        read_data_file(b"time,speed,direction\n0,fast,270\n")


def test_a_child_process_gives_the_same_documents() -> None:
    assert json.loads(convert_limited(STAND.encode())) == json.loads(
        json.dumps(read_inventory(STAND.encode()).document())
    )
    expected = read_measurement(MAST.encode(), start_s=4.0).document()
    assert json.loads(convert_limited(MAST.encode(), 4.0)) == json.loads(json.dumps(expected))
    with pytest.raises(MeshError) as error:
        convert_limited(b"time,speed,direction\n0,fast,270\n")
    assert (error.value.code, error.value.hint) == (
        "bad-measurement",
        "Line 2, column 'speed': 'fast' is not a number.",
    )
    with pytest.raises(MeshError) as error:
        convert_limited(b"")
    assert (error.value.code, error.value.reason) == ("unknown-content", "unsupported")


def test_the_command_writes_an_inventory_document(tmp_path: Path) -> None:
    path, report = tmp_path / "stand.csv", tmp_path / "report.json"
    path.write_text(STAND)
    result = CliRunner().invoke(app, ["convert", str(path), "--json", str(report)])
    assert result.exit_code == 0, result.output
    assert "Trees: 2 of 3 rows" in result.output
    assert "Foo bar (unknown) is shown as maple: 1" in result.output
    assert "line 4: neither height nor diameter" in result.output
    document = json.loads((tmp_path / "stand.forest.json").read_text())
    assert document == json.loads(json.dumps(read_inventory(path).document()))
    assert json.loads(report.read_text()) == document["report"]


def test_the_command_writes_a_wind_document(tmp_path: Path) -> None:
    path, out = tmp_path / "mast.csv", tmp_path / "winds" / "mast.json"
    path.write_text(MAST)
    result = CliRunner().invoke(app, ["convert", str(path), "--out", str(out), "--from", "10"])
    assert result.exit_code == 0, result.output
    assert "Mean wind: 7.0 m/s from 270°" in result.output
    assert parse_wind(json.loads(out.read_text())) == read_measurement(path, start_s=10.0).wind


def test_the_command_says_what_is_wrong(tmp_path: Path) -> None:
    path = tmp_path / "mast.csv"
    path.write_text("time,speed,direction\n0,fast,270\n")
    result = CliRunner().invoke(app, ["convert", str(path)])
    assert result.exit_code == 1
    assert "line 2, column 'speed'" in " ".join(result.stderr.split())
    assert not (tmp_path / "mast.wind.json").exists()
