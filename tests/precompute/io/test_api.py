"""The public API: what ``import galewood`` offers, on a small tree."""

from __future__ import annotations

import math
import runpy
import subprocess
import sys
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any, cast

import galewood
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from galewood.motion.wind import WindField
from galewood.player.modal_forest import ModalForest
from galewood.table import encode
from pydantic import ValidationError

from tests.precompute.fixtures.shared_tets import TARGET_TETS, cache_with_tets, small_tree_glb

SCRIPT = Path(__file__).parents[3] / "docs" / "examples" / "hundred_trees.py"
QUICK: dict[str, Any] = {
    "target_tets": TARGET_TETS,
    "sampled_elements": 8,
    "frames": 16,
    "design_speed_m_s": 14.0,
    "reference_frames": 0,
    "stiffness": "as drawn",
}
HEIGHT_M = 12.0
"""As in the example, so that its build finds the runs of the others."""

pytestmark = pytest.mark.usefixtures("one_worker")


@pytest.fixture(scope="module")
def cache_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return cache_with_tets(
        tmp_path_factory.mktemp("api") / "cache", tmp_path_factory, HEIGHT_M, share_runs=True
    )


@pytest.fixture(scope="module")
def mesh(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mesh") / "maple.glb"
    path.write_bytes(small_tree_glb("maple"))
    return path


@pytest.fixture(scope="module")
def tree(mesh: Path) -> galewood.Tree:
    return galewood.read(mesh, species="maple", height_m=HEIGHT_M)


@pytest.fixture(scope="module")
def table(tree: galewood.Tree, cache_dir: Path) -> galewood.MotionTable:
    stages: list[str] = []
    options: dict[str, Any] = QUICK | {"reference_frames": 12}
    built = galewood.build(
        tree, on_progress=lambda now: stages.append(now.stage), cache_dir=cache_dir, **options
    )
    expected = ["meshing", "skeleton", "model", "sampling", "table", "records", "done"]
    assert list(dict.fromkeys(stages)) == expected
    return built


def test_the_version_is_that_of_the_installation() -> None:
    assert galewood.__version__ == version("galewood")


def test_every_public_name_is_there_and_documented() -> None:
    names = dir(galewood)
    assert {"build", "Forest"} <= set(names)
    for name in names:
        assert getattr(galewood, name).__doc__ or name.isupper()


def test_importing_the_library_loads_no_stage() -> None:
    code = "import sys, galewood; print([m for m in sys.modules if m.startswith(('galewood.', 'numpy'))])"
    assert subprocess.check_output([sys.executable, "-c", code], text=True).strip() == "[]"


def test_a_recorded_forest_is_the_stepped_one_with_its_derivatives(table: galewood.MotionTable) -> None:
    wind = galewood.PRESETS["autumn-gusts"]
    place = [(3.0, -2.0, 0.7, 1.0)]
    motion = galewood.Forest([table], place, wind).record(6.0)
    stepped, dt_s = galewood.Forest([table], place, wind), float(table.metadata["dt_s"])
    top = table.table.node_basis[int(np.argmax(table.table.node_rest_m[:, 1]))]
    own = [top @ stepped.modal_coordinates(0)]
    for _ in range(180):
        stepped.step(dt_s)
        own.append(top @ stepped.modal_coordinates(0))
    cos, sin = np.cos(0.7), np.sin(0.7)
    turned = np.array(own) @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]).T
    size = np.abs(turned).max()
    np.testing.assert_allclose(motion.displacement_m[:, 0], turned, atol=1e-5 * size)
    assert motion.time_s[-1] == pytest.approx(6.0)
    # the derivatives are those of a track sampled finely
    fine = galewood.Forest([table], place, wind).record(6.0, rate_hz=960)
    for of, rate in [
        (fine.displacement_m, fine.velocity_m_s),
        (fine.velocity_m_s, fine.acceleration_m_s2),
    ]:
        expected = np.gradient(of, fine.time_s, axis=0)[2:-2]
        assert np.abs(expected - rate[2:-2]).max() < 0.02 * np.abs(rate).max()


def test_a_tree_in_still_air_recorded_is_an_oscillator_of_its_frequency(table: galewood.MotionTable) -> None:
    scale = 1.5
    forest = galewood.Forest([table], [(0.0, 0.0, 0.0, scale)], galewood.Wind(mean_speed_m_s=6.0))
    forest.record(10.0)
    forest.wind = galewood.Wind(mean_speed_m_s=0.0)
    forest.record(3.0)
    motion = forest.record(6.0, rate_hz=60)
    across, towards = motion.displacement_m[:, 0, 0], -motion.acceleration_m_s2[:, 0, 0]
    hertz = np.sqrt((across * towards).sum() / (across * across).sum()) / (2 * np.pi)
    assert hertz == pytest.approx(table.frequencies_hz[0] / scale, rel=0.05)
    assert np.abs(motion.wind_m_s).max() == np.abs(motion.pressure_pa).max() == 0.0


def test_recorded_motion_is_refused_what_is_no_time_or_vertex(table: galewood.MotionTable) -> None:
    forest = galewood.Forest([table], [(0.0, 0.0)], galewood.Wind())
    for arguments, said in [
        ((math.nan,), "duration_s"), ((0.0,), "duration_s"), ((math.inf,), "duration_s"),
    ]:  # fmt: skip
        with pytest.raises(ValueError, match=said):
            forest.record(*arguments)
    with pytest.raises(ValueError, match="rate_hz"):
        forest.record(1.0, rate_hz=0.0)
    with pytest.raises(ValueError, match="vertex must lie between"):
        forest.record(1.0, vertex=10**9)
    with pytest.raises(ValueError, match="no trees"):
        galewood.Forest([table], galewood.grid(0), galewood.Wind()).record(1.0)
    lowest = int(np.argmin(table.rest_vertices_m[:, 1]))
    assert np.abs(forest.record(2.0, vertex=lowest).displacement_m).max() < 0.01 * table.height_m


def test_recorded_motion_and_measured_wind_compose_with_pandas_and_xarray(
    table: galewood.MotionTable,
) -> None:
    index = pd.date_range("2026-01-02", periods=120, freq="500ms")
    series = pd.Series(5.0 + np.sin(np.arange(120.0)), index=index)
    of_series = galewood.measured_wind(series.index, series, 240.0).wind
    of_arrays = galewood.measured_wind(0.5 * np.arange(120.0), series.to_numpy(), 240.0).wind
    array = xr.DataArray(series.to_numpy(), coords={"time": index}, dims="time")
    assert of_series == of_arrays == galewood.measured_wind(array.time, array, 240.0).wind
    motion = galewood.Forest([table], galewood.grid(3), of_series).record(2.0)
    frame = pd.DataFrame(motion.displacement_m[:, :, 0], index=motion.time_s)
    assert frame.shape == (61, 3) and float(frame.abs().to_numpy().max()) > 0.0


def test_the_model_has_the_frequencies_of_the_table(
    tree: galewood.Tree, table: galewood.MotionTable, cache_dir: Path
) -> None:
    model = galewood.Model(tree, target_tets=TARGET_TETS, cache_dir=cache_dir)
    assert model.frequencies_hz == table.frequencies_hz
    assert model.mass_kg > 0
    motion = model.simulate(galewood.Wind(mean_speed_m_s=8.0), duration_s=1.0)
    assert motion.displacement_m.shape == (30, len(model.rest_vertices_m), 3)
    assert 0 < np.abs(motion.displacement_m).max() < tree.height_m
    assert motion.velocity_m_s.shape == motion.acceleration_m_s2.shape == motion.displacement_m.shape
    weight_n = 9.81 * model.mass_kg
    assert motion.base_force_n[:, 1] == pytest.approx(-weight_n, rel=0.05)
    assert (motion.base_force_n[10:, 0] > 0).all()  # the wind blows to x, and turns the tree about −z
    assert motion.base_moment_nm[-1, 2] < motion.base_moment_nm[0, 2]
    still = model.simulate(galewood.Wind(mean_speed_m_s=0.0), duration_s=0.2)
    assert np.abs(still.displacement_m).max() < 1e-6 * tree.height_m
    with pytest.raises(ValueError, match="time step"):
        model.simulate(galewood.Wind(), duration_s=0.0)
    bare = galewood.Model(tree, foliage="bare", target_tets=TARGET_TETS, cache_dir=cache_dir)
    leaves_kg = table.report["foliage"]["leaf_mass_kg"]
    assert leaves_kg > 0 and bare.mass_kg == pytest.approx(model.mass_kg - leaves_kg)
    assert bare.frequencies_hz[0] > 0.99 * model.frequencies_hz[0]
    assert (model.fem.streamlined_exponent, bare.fem.streamlined_exponent) == (1.3, 2.0)


def test_a_table_is_the_same_after_saving_and_loading(table: galewood.MotionTable, tmp_path: Path) -> None:
    galewood.save(table, tmp_path / "tree.gwt")
    loaded = galewood.load(tmp_path / "tree.gwt")
    assert loaded.data == table.data
    np.testing.assert_array_equal(loaded.rest_vertices_m, table.rest_vertices_m)
    assert loaded.faces.max() == len(loaded.rest_vertices_m) - 1
    (tmp_path / "tree.glb").unlink()
    with pytest.raises(ValueError, match="no mesh"):
        _ = galewood.load(tmp_path / "tree.gwt").rest_vertices_m
    (tmp_path / "tree.gwt").write_bytes(b"nothing")
    with pytest.raises(galewood.TableError):
        galewood.load(tmp_path / "tree.gwt")


def test_a_bare_table_is_saved_beside_the_other_with_its_mesh(
    table: galewood.MotionTable, tmp_path: Path
) -> None:
    metadata = {**table.metadata, "foliage": "bare"}
    bare = replace(table, data=encode(replace(table.table, metadata=metadata)))
    galewood.save(replace(table, bare=bare), tmp_path / "tree.gwt")
    loaded = [galewood.load(tmp_path / name) for name in ("tree.gwt", "tree.bare.gwt")]
    assert [one.foliage for one in loaded] == ["leaf", "bare"]
    assert loaded[1].data == bare.data and loaded[1].render_glb == table.render_glb


def test_a_forest_steps_each_tree_as_a_lone_tree_in_its_wind(table: galewood.MotionTable) -> None:
    wind = galewood.Wind(mean_speed_m_s=6.0, direction_deg=40.0, gustiness=0.5)
    at = galewood.grid(5, tables=2, seed=3)
    forest = galewood.Forest([table, table], at, wind)
    for _ in range(40):
        forest.step(1 / 30)
    for k in range(5):
        lone = galewood.Forest([table], [(at.x_m[k], at.z_m[k], at.yaw_rad[k], at.scale[k])], wind)
        for _ in range(40):
            lone.step(1 / 30)
        np.testing.assert_array_equal(lone.modal_coordinates(0), forest.modal_coordinates(k))
        np.testing.assert_array_equal(lone.vertices_m(0), forest.vertices_m(k))


def test_vertices_are_the_rest_pose_moved_by_the_nodes(table: galewood.MotionTable) -> None:
    still = galewood.Forest([table], [(3.0, -2.0, np.pi / 2, 2.0)], galewood.Wind(mean_speed_m_s=0.0))
    still.step(1 / 30)
    rest = table.rest_vertices_m
    expected = 2.0 * np.column_stack([rest[:, 2], rest[:, 1], -rest[:, 0]]) + np.array([3.0, 0.0, -2.0])
    np.testing.assert_allclose(still.vertices_m(0), expected, atol=1e-12)


def test_a_lone_upright_tree_follows_the_modal_model(table: galewood.MotionTable) -> None:
    wind, dt_s = galewood.Wind(mean_speed_m_s=5.0, height_exponent=0.0), 1 / 30
    forest = galewood.Forest([table], [(0.0, 0.0)], wind)
    twin = ModalForest(table.table.modal, dt_s, table.table.mode_scale, 1)
    field, pressure = WindField(wind), np.zeros((2, 1))
    for frame in range(60):
        forest.step(dt_s)
        time_s, exponent = (frame + 1) * dt_s, table.table.streamlined_exponent
        field.pressure(np.zeros(1), np.zeros(1), time_s, pressure[0], pressure[1], exponent)
        twin.advance(dt_s, pressure[0].astype(np.float32), pressure[1].astype(np.float32))
    np.testing.assert_allclose(forest.modal_coordinates(0), twin.q[0], atol=1e-7)


def test_the_wind_changes_smoothly(table: galewood.MotionTable) -> None:
    forest = galewood.Forest([table], galewood.grid(3), galewood.Wind(mean_speed_m_s=4.0))
    for _ in range(30):
        forest.step(1 / 30)
    before = forest.modal_coordinates(1)
    forest.wind = galewood.Wind(mean_speed_m_s=12.0)
    forest.step(1 / 30)
    assert np.abs(forest.modal_coordinates(1) - before).max() < 0.02 * table.height_m


def test_placements_that_do_not_fit_are_refused(table: galewood.MotionTable) -> None:
    with pytest.raises(ValueError, match="columns"):
        galewood.Forest([table], [(1.0,)], galewood.Wind())
    with pytest.raises(ValueError, match="between 0 and 0"):
        galewood.Forest([table], galewood.grid(4, tables=2), galewood.Wind())


@pytest.mark.parametrize("dt_s", [0.0, -1.0, math.nan, math.inf, "1"])
def test_a_step_that_is_no_time_is_refused(table: galewood.MotionTable, dt_s: Any) -> None:
    forest = galewood.Forest([table], [(0.0, 0.0)], galewood.Wind())
    with pytest.raises(ValueError, match="dt_s must be a time above 0 s"):
        forest.step(dt_s)
    assert forest.time_s == 0.0


def test_forests_without_sense_are_refused(table: galewood.MotionTable) -> None:
    wind, method = galewood.Wind(), cast(Any, "typo")
    with pytest.raises(ValueError, match="at least one table"):
        galewood.Forest([], [(0.0, 0.0)], wind)
    with pytest.raises(ValueError, match="method must be one of modal, paper, not 'typo'"):
        galewood.Forest([table], [(0.0, 0.0)], wind, method=method)
    with pytest.raises(ValueError, match="finite"):
        galewood.Forest([table], [(0.0, math.nan)], wind)
    with pytest.raises(ValueError, match="scale"):
        galewood.Forest([table], [(0.0, 0.0, 0.0, 0.0)], wind)


def test_options_are_checked(tree: galewood.Tree, mesh: Path, tmp_path: Path) -> None:
    with pytest.raises(ValidationError):
        galewood.build(tree, cache_dir=tmp_path, modes=1)
    with pytest.raises(ValidationError):
        galewood.build(tree, cache_dir=tmp_path, no_such_option=1)  # pyright: ignore[reportCallIssue]
    with pytest.raises(ValidationError):
        galewood.read(mesh, species="marble")
    broken = tmp_path / "tree.glb"
    broken.write_bytes(b"glTF but not really")
    with pytest.raises(galewood.MeshError) as caught:
        galewood.read(broken)
    assert caught.value.hint


def test_the_number_of_modes_can_be_chosen(tree: galewood.Tree, cache_dir: Path) -> None:
    built = galewood.build(tree, cache_dir=cache_dir, modes=6, **QUICK)
    assert len(built.table.modal.step) == 6
    assert built.metadata["provenance"]["table_settings"]["modes"] == 6


def test_the_error_against_the_reference_is_measured(table: galewood.MotionTable, cache_dir: Path) -> None:
    winds = {"steady": galewood.Wind(mean_speed_m_s=6.0, gustiness=0.0)}
    found = galewood.evaluate(table, winds, duration_s=4.0, cache_dir=cache_dir)
    assert list(found) == ["gusts", "uniform"]
    assert list(found["gusts"]) == list(found["uniform"]) == ["steady"]
    uniform = found["uniform"]["steady"]
    assert 0 < uniform["modal"]["max_error"] < 0.2 * uniform["rest-pose"]["max_error"]
    assert 0 < found["gusts"]["steady"]["modal"]["max_error"] < 0.2 * uniform["rest-pose"]["max_error"]


def test_the_example_bends_a_hundred_trees(
    mesh: Path, cache_dir: Path, table: galewood.MotionTable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = [line for line in SCRIPT.read_text().splitlines() if line and not line.startswith('"""')]
    assert len(code) <= 15
    assert [line for line in code if line.startswith(("import", "from"))] == ["import galewood"]
    full_build = galewood.build  # the same build with quick options: the example's own take a minute
    monkeypatch.setattr(
        galewood, "build", lambda tree, **more: full_build(tree, **more, **QUICK), raising=False
    )
    monkeypatch.setenv("GALEWOOD_CACHE_DIR", str(cache_dir))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "oak.glb").write_bytes(mesh.read_bytes())
    vertices_m = np.array(runpy.run_path(str(SCRIPT))["vertices_m"])
    assert vertices_m.shape == (100, len(table.rest_vertices_m), 3)
    assert np.isfinite(vertices_m).all()
    assert (tmp_path / "oak.gwt").exists()
