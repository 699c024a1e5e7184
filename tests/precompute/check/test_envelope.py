"""The sway envelope against the vertices of the same trees in the same gusts, and against a bent ruler."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import galewood
import numpy as np
import pytest
from galewood.check.envelope import (
    SwayEnvelope,
    WindClass,
    clearances,
    envelope_figure,
    read_lines,
    wind_classes,
)
from galewood.io.cli.commands import app
from galewood.measurements import MeasurementError
from galewood.packaged import species_folder
from galewood.pipeline.results import SHIPPED_FOLDER, read_shipped
from galewood.pipeline.stages import builtin_meshes
from typer.testing import CliRunner

WIND_M_S, DIRECTION_DEG = 9.0, 40.0


@pytest.fixture(scope="module")
def table() -> galewood.MotionTable:
    mesh = {mesh.name: mesh for mesh in builtin_meshes(species_folder())}["apricot"]
    shipped = read_shipped(species_folder() / SHIPPED_FOLDER, mesh.name, mesh.key)
    assert shipped is not None
    return galewood.MotionTable(shipped.result.table, shipped.result.render_glb, name="apricot")


@pytest.fixture(scope="module")
def envelope(table: galewood.MotionTable) -> SwayEnvelope:
    return galewood.sway_envelope(
        table, wind_m_s=WIND_M_S, direction_deg=DIRECTION_DEG, sample_count=3, seconds=10.0, seed=7
    )


def test_the_reach_is_that_of_the_drawn_vertices(table: galewood.MotionTable, envelope: SwayEnvelope) -> None:
    """All vertices of the same trees in the same gusts; the envelope follows the outermost ones only."""
    wind = replace(
        galewood.PRESETS["autumn-gusts"], mean_speed_m_s=WIND_M_S, convection_speed_m_s=WIND_M_S,
        direction_deg=DIRECTION_DEG, seed=7, reference_height_m=10.0,
    )  # fmt: skip
    angle = np.radians(DIRECTION_DEG)
    place = 200.0 * (np.arange(3) - 1.5)[:, None] * np.array([-np.sin(angle), np.cos(angle)])
    forest = galewood.Forest([table], place, wind)
    rest = table.rest_vertices_m
    band = np.clip(np.searchsorted(envelope.height_m, rest[:, 1]) - 1, 0, 7)
    toward = np.radians(envelope.direction_deg)
    toward = np.stack([np.cos(toward), np.sin(toward)])
    found = np.full((3, 8, 16), -np.inf)
    for frame in range(1, 901):
        forest.step(1 / 30)
        if frame > 600 and frame % 3 == 0:
            for tree in range(3):
                moved = forest.vertices_m(tree)[:, [0, 2]] - place[tree]
                reach = moved @ toward
                for k in range(8):
                    found[tree, k] = np.maximum(found[tree, k], reach[band == k].max(axis=0))
    found = np.maximum(found, envelope.rest_m)
    np.testing.assert_allclose(envelope.reach_m, found, atol=0.001 * table.height_m)


def test_gusts_reach_farther_downwind(envelope: SwayEnvelope, table: galewood.MotionTable) -> None:
    more = (envelope.quantile_m(0.5) - envelope.rest_m)[-2]
    downwind = int(np.argmin(np.abs(envelope.direction_deg - DIRECTION_DEG)))
    assert more[downwind] > 0.01 * table.height_m
    assert more[downwind] > 2 * more[(downwind + 8) % 16]


def ruler(height_m: float, reach_m: float) -> SwayEnvelope:
    """A tree that reaches equally far on all sides, and half a metre farther in gusts."""
    rest = np.full((8, 16), reach_m)
    return SwayEnvelope(
        np.linspace(0, height_m, 9), np.linspace(0, 337.5, 16), rest, np.stack([rest + 0.5, rest + 0.5]), 1.0,
        (WindClass(5.0, 0.0, 1),),
    )  # fmt: skip


def geojson(*features: tuple[str, list[list[float]], dict[str, object]]) -> bytes:
    return json.dumps({
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "properties": properties, "geometry": {"type": kind, "coordinates": points}}
            for kind, points, properties in features
        ],
    }).encode()  # fmt: skip


def test_clearances_in_metres() -> None:
    """Lines 5 m east and 8 m north of a tree that reaches 3 m, and 3.5 m in gusts."""
    place = (500_000.0, 5_400_000.0)
    lines = geojson(
        ("LineString", [[500_005.0, 5_399_900.0], [500_005.0, 5_400_100.0]], {"name": "wire", "height_m": 6}),
        ("LineString", [[499_900.0, 5_400_008.0], [500_100.0, 5_400_008.0]], {}),
    )
    first, second = clearances(ruler(10.0, 3.0), read_lines(lines, place))
    assert (first.name, second.name) == ("wire", "feature 2")
    # the outline is the polygon about the circle, whose corners lie 2 % farther out
    for found, expected in ((first.rest_m, 2.0), (first.p90_m, 1.5), (second.rest_m, 5.0)):
        assert expected - 0.03 < found <= expected + 1e-9
    assert (first.east_m, first.north_m) == pytest.approx((5.0, 0.0), abs=0.6)  # towards a corner
    assert second.north_m == pytest.approx(8.0, abs=0.01)


def test_no_clearance_is_larger_than_that_of_the_points() -> None:
    """A crown of random points, and straight lines about it: against all distances, by brute force."""
    generator = np.random.default_rng(311)
    points = generator.normal(size=(40, 2)) * [2.0, 1.0]
    direction = np.linspace(0, 337.5, 16)
    toward = np.stack([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
    reach = np.tile((points @ toward).max(axis=0), (8, 1))
    crown = SwayEnvelope(np.linspace(0, 10, 9), direction, reach, reach[None], 1.0, (WindClass(5.0, 0.0, 1),))
    for _ in range(200):
        start = 8 * generator.normal(size=2)
        end = start + 10 * generator.normal(size=2)
        # metres to the east and to the north about a place that cannot be an angle
        line = geojson(("LineString", [[500 + start[0], 500 - start[1]], [500 + end[0], 500 - end[1]]], {}))
        (found,) = clearances(crown, read_lines(line, (500.0, 500.0)))
        along = np.linspace(0, 1, 2001)[:, None]
        nearest = np.linalg.norm((start + along * (end - start))[:, None] - points, axis=2).min()
        assert found.rest_m <= nearest + 1e-3


def test_clearances_by_longitude_and_latitude() -> None:
    """A hundredth of a second of arc of latitude is 0.309 m."""
    at = (8.5, 47.4)
    north = at[1] + 20 / 111_194
    lines = read_lines(geojson(("LineString", [[8.4999, north], [8.5001, north]], {})), at)
    (found,) = clearances(ruler(10.0, 3.0), lines)
    assert found.rest_m == pytest.approx(17.0, abs=0.1)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"{", "not valid JSON"),
        (b"[]", "expected a GeoJSON"),
        (geojson(("Point", [[0.0, 0.0]], {})), "no LineString"),
        (geojson(("LineString", [[0.0, 0.0]], {"name": "short"})), "short: a line needs two points"),
        (geojson(("LineString", [[0.0], [1.0, 1.0]], {})), "no numbers"),
        (geojson(("LineString", [[0.0, 0.0], [1.0, 1.0]], {"height_m": "high"})), "no numbers"),
    ],
)
def test_what_is_wrong_with_lines_is_said(data: bytes, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read_lines(data, (0.0, 0.0))


def test_a_week_of_winds_becomes_classes() -> None:
    rows = [
        f"2024-01-{1 + k // 24:02d}T{k % 24:02d}:00,{1 + k % 12},{270 if k % 3 else 180}" for k in range(168)
    ]
    classes = wind_classes("\n".join(["time,speed,direction", *rows]).encode())
    assert sum(one.sample_count for one in classes) == 168 * 10 // 12  # 1 and 2 m/s are calm
    assert {one.direction_deg for one in classes} == {0.0, 270.0}  # from the west to the east, from the south
    assert max(one.speed_m_s for one in classes) == 12.5
    with pytest.raises(MeasurementError, match="no sample"):
        wind_classes(b"time,speed,direction\n0,1,270\n1,1,270\n")


def test_the_command(table: galewood.MotionTable, tmp_path: Path) -> None:
    path, plot, figures = tmp_path / "apricot.gwt", tmp_path / "reach.png", tmp_path / "reach.json"
    galewood.save(table, path)
    lines = tmp_path / "lines.json"
    wire = geojson(("LineString", [[9.0, -50.0], [9.0, 50.0]], {"name": "wire", "height_m": 4}))
    lines.write_bytes(wire)
    far = CliRunner().invoke(app, ["envelope", str(path), "--speed", "6", "--lines", str(lines)])
    assert far.exit_code == 1 and "km from the tree" in far.output and "as crs" in far.output
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}
    lines.write_text(json.dumps({**json.loads(wire), "crs": crs}))
    given = ("--samples", "2", "--lines", str(lines), "--plot", str(plot), "--json", str(figures))
    found = CliRunner().invoke(app, ["envelope", str(path), "--speed", "6", *given])
    assert found.exit_code == 0, found.output
    assert "wire: " in found.output and plot.stat().st_size > 10_000
    document = json.loads(figures.read_text())
    assert document["samples"] == 2 and len(document["reach_m"]["90%"]) == 8
    (clear,) = document["clearances"]
    band = int(np.searchsorted(document["height_m"], 4.0)) - 1
    east = max(row[0] for row in document["rest_m"][band - 1 : band + 2])
    assert 9 - 1.05 * max(map(max, document["rest_m"])) < clear["rest_m"] <= 9 - east
    assert clear["p90_m"] <= clear["median_m"] <= clear["rest_m"]
    wrong = CliRunner().invoke(app, ["envelope", str(path)])
    assert wrong.exit_code == 1 and "give either" in wrong.output


def test_the_plot_has_all_levels() -> None:
    figure = envelope_figure(ruler(10.0, 3.0))
    assert [line.get_label() for line in figure.axes[0].get_lines()][:2] == ["at rest", "median in gusts"]
