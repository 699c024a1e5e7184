"""Figures of an evaluation against independent computations."""

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from galewood.check.evaluation.evaluate import (
    METHODS,
    compare,
    compare_methods,
    floor,
    nearest_sample,
    play_pressures,
)
from galewood.check.evaluation.gusts import GustCase, evaluate_in_gusts, place_of, play_in_wind
from galewood.check.evaluation.long_run import long_run, play_beyond_range
from galewood.check.evaluation.measures import errors, figures, growth, hausdorff, joined, windows
from galewood.check.evaluation.model_file import SourceError, find_model
from galewood.check.evaluation.plot import plot_errors
from galewood.check.evaluation.reference_runs import (
    ReferenceRun,
    ReferenceTask,
    follow,
    read_reference_run,
    run_references,
    sway_of,
)
from galewood.check.evaluation.source import Source, source_of
from galewood.check.evaluation.winds import long_gusts, noise, perlin, unseen_winds
from galewood.io.cli.commands import app
from galewood.io.cli.tools import file_writer
from galewood.motion.wind import PRESETS, Wind
from galewood.motion.wind.transition import WindState
from galewood.options import EvaluationOptions
from galewood.pipeline.sampling.runner import SampleTask, content_hash, run_task
from galewood.pipeline.stages.build import build_table, model_of
from galewood.pipeline.tables.options import BuildOptions
from galewood.solid.fem import node_pressures
from galewood.solid.fem.dynamics import Simulator
from galewood.table.format import Table, decode
from galewood.wood import WoodDocument, wood_of_species
from typer.testing import CliRunner

from tests.golden import GOLDEN_FOLDER
from tests.precompute.fixtures.shared_tets import TARGET_TETS, cache_with_tets, small_tree_glb

TABLE = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())


def test_an_exact_track_has_no_error_and_the_error_of_a_resting_one_is_the_sway() -> None:
    rng = np.random.default_rng(601)
    reference = 0.1 * rng.normal(size=(80, 30, 3))
    perfect, resting = errors(reference, reference), errors(np.zeros_like(reference), reference)
    sway = np.linalg.norm(reference, axis=2).max() / 2.0
    assert figures(perfect, 2.0)["max_error"] == 0
    assert np.isclose(figures(resting, 2.0)["max_error"], sway)
    assert np.isclose(figures(resting, 2.0)["max_error_of_sway"], 1)
    assert np.isclose(figures(resting, 2.0)["rms_error"], np.sqrt((reference**2).sum(axis=2).mean()) / 2.0)
    assert set(figures(resting, 2.0)["frames"]) == {"20", "22", "40", "60"}


def test_joined_pieces_give_the_figures_of_the_whole_run() -> None:
    rng = np.random.default_rng(603)
    track, reference = rng.normal(size=(2, 70, 9, 3))
    weight = rng.integers(1, 9, 9)
    pieces = [errors(track[a : a + 20], reference[a : a + 20], weight) for a in range(0, 70, 20)]
    assert figures(joined(pieces), 3.0) == figures(errors(track, reference, weight), 3.0)


def test_a_weight_is_the_number_of_vertices_that_a_row_represents() -> None:
    rng = np.random.default_rng(604)
    track, reference = rng.normal(size=(2, 12, 5, 3))
    count = np.array([1, 4, 2, 1, 3])
    many = errors(np.repeat(track, count, axis=1), np.repeat(reference, count, axis=1))
    assert np.allclose(errors(track, reference, count).mean_square_m2, many.mean_square_m2)


def test_growth_is_plain_and_relative_to_the_sway() -> None:
    reference = np.zeros((40, 1, 3))
    reference[:20, 0, 0], reference[20:, 0, 0] = 1.0, 3.0
    found = growth(errors(1.1 * reference, reference), 2.0)
    assert np.isclose(found["growth"] or 0, 3.0)
    assert np.isclose(found["growth_of_sway"] or 0, 1.0)
    reference[20:] = 0.0
    assert growth(errors(reference + 0.1, reference), 2.0)["growth_of_sway"] is None


def test_windows_are_complete_and_in_order() -> None:
    reference = np.ones((25, 2, 3))
    track = reference + np.repeat([0.0, 0.2, 9.9], [10, 10, 5])[:, None, None]
    found = windows(errors(track, reference), 10, 1.0)
    assert [round(window["max_error"], 9) for window in found] == [0.0, round(0.2 * 3**0.5, 9)]


def test_hausdorff_distance_matches_brute_force() -> None:
    rng = np.random.default_rng(602)
    a, b = rng.normal(size=(40, 3)), rng.normal(size=(25, 3))
    gaps = np.linalg.norm(a[:, None] - b[None], axis=2)
    assert np.isclose(hausdorff(a, b), max(gaps.min(axis=0).max(), gaps.min(axis=1).max()))


def test_a_sampled_wind_is_its_own_nearest_sample() -> None:
    start, end = TABLE.records.trajectory[:2].astype(int)
    track = nearest_sample(TABLE, TABLE.records.pressure_pa[start:end].astype(np.float64))
    assert np.allclose(track, TABLE.recorded_q_m[start:end], atol=1e-6)


def test_poses_of_the_modal_model_follow_a_sampled_run() -> None:
    start, end = TABLE.records.trajectory[1:3].astype(int)
    track, extrapolation_ratio = play_pressures(
        TABLE, TABLE.records.pressure_pa[start:end].astype(np.float64), METHODS["modal"]
    )
    true = TABLE.recorded_q_m[start + 1 : end]
    assert np.abs(track[:-1] - true).max() < 2e-3 * np.abs(true).max()
    assert 0 < extrapolation_ratio < 1.3


def test_winds_have_the_given_strength_and_depend_on_the_seed() -> None:
    first, second = (unseen_winds(10.0, 300, 1 / 30, 1.64, strength=0.65, seed=seed) for seed in (1, 2))
    top = 15.0 * (6.5 / 5.0) ** 1.64
    for name, pressure in first.items():
        assert 0.3 * top < np.linalg.norm(pressure, axis=1).max() <= top * 1.0001, name
    assert not np.allclose(first["perlin"], second["perlin"])
    assert not first["gust-then-still"][100:].round(9).any()


@pytest.mark.parametrize("name", ["new-period-and-amplitude", "between-directions", "perlin", "one-over-f"])
def test_continuing_winds_repeat_three_times_without_a_seam(name: str) -> None:
    wind = unseen_winds(12.0, 600, 1 / 30, 1.3, strength=0.65, seed=605)[name]
    assert len(wind) == 900
    assert np.allclose(wind[300:], wind[:-300], atol=1e-9)
    steps = np.linalg.norm(np.diff(wind, axis=0), axis=1)
    assert steps[299] <= 1.5 * np.delete(steps, 299).max()


def test_growth_excludes_the_lead_in() -> None:
    reference = np.ones((90, 2, 3))
    error = np.repeat([0.01, 0.3, 0.3], 30)
    run = errors(reference + error[:, None, None], reference)
    assert np.isclose(figures(run, 2.0, lead=30)["growth"], 1.0)
    assert np.isclose(figures(run, 2.0)["growth"], 1.0)  # the largest of 45 frames either way
    assert np.isclose(figures(run, 2.0, lead=30)["max_error"], 0.3 * np.sqrt(3) / 2)
    preliminary = errors(reference + error[::-1][:, None, None], reference)
    assert np.isclose(figures(preliminary, 2.0, lead=30)["growth"], 0.01 / 0.3)


def test_noise_has_unit_variance_and_no_seam() -> None:
    rng = np.random.default_rng(606)
    for series in (noise(rng, 300, 1 / 30, 5 / 3), perlin(rng, 300, 1 / 30)):
        assert 0.2 < series.std() < 2.0
        steps = np.abs(np.diff(np.append(series, series[0])))
        assert steps[-1] <= 1.5 * steps[:-1].max()


def test_long_gusts_are_equal_in_every_window() -> None:
    wind = long_gusts(607, 3000, 500, 1 / 30, 15.0, 1.3)
    strength = np.linalg.norm(wind, axis=1).reshape(6, 500)
    assert np.allclose(strength, strength[0])
    assert np.linalg.norm(wind[0] - wind[1500]) > 0.1 * strength.max()


def test_the_plot_is_written(tmp_path: Path) -> None:
    found = {"reference_sway": 0.1, "error_by_frame": [0.0, 0.01, 0.02]}
    in_gusts = {"7 m/s": {"reference_sway": 0.1, "modal": found}}
    plot_errors(in_gusts, {"step": {"modal": found, "rest-pose": found}}, tmp_path / "errors.png")
    assert (tmp_path / "errors.png").read_bytes().startswith(b"\x89PNG")


SOFT = WoodDocument(
    name="soft maple",
    based_on="maple",
    young_longitudinal_pa=wood_of_species("maple").young_longitudinal_pa / 30,
)
"""With its own wood the stub sways at 7 Hz, too fast for the time steps of the elements to be exact."""
HEIGHT_M = 5.2
"""A third of the small tree's own: it sways faster, so that a short run covers many periods."""
OPTIONS = BuildOptions(
    species="maple",
    height_m=HEIGHT_M,
    target_tets=TARGET_TETS,
    sampled_elements=8,
    design_speed_m_s=14.0,
    frames=60,
    wood=SOFT,
)


def in_this_process(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
    paths: list[Path] = []
    for task in tasks:
        paths.append(run_task(task))
        done(len(paths))
    return paths


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Table of a small tree with its mesh beside it, and the cache of its build."""
    path = tmp_path_factory.mktemp("evaluate")
    cache = cache_with_tets(path / "cache", tmp_path_factory, HEIGHT_M)
    built = build_table(
        small_tree_glb(),
        "tree.glb",
        OPTIONS,
        in_this_process,
        cache_dir=cache,
        publish=file_writer(path),
    )
    (path / "tree.gwt").write_bytes(built.whole_table())
    (path / "tree.glb").write_bytes(built.render_glb)
    return path


@pytest.fixture(scope="module")
def table(folder: Path) -> Table:
    return decode((folder / "tree.gwt").read_bytes())


@pytest.fixture(scope="module")
def source(folder: Path, table: Table) -> Source:
    return source_of(table, folder / "tree.glb", folder / "cache", workers=1)


@pytest.fixture(scope="module")
def reference(source: Source) -> ReferenceRun:
    rng = np.random.default_rng(608)
    return follow(Simulator(source.model), np.abs(rng.normal(size=(40, 2))) * 20.0)


def test_the_source_of_a_table_is_recovered(table: Table, source: Source, reference: ReferenceRun) -> None:
    assert source.model.report["frequencies_hz"] == table.metadata["frequencies_hz"]
    assert source.rendered.count.sum() == len(table.vertex_node)
    left = floor(table, source, reference.displacement_m)
    sway = sway_of(reference) / float(table.metadata["height_m"])
    assert left["truncation"] < 2e-3 * sway
    assert left["truncation"] <= left["truncation_and_nodes"] < 0.05 * sway


def test_the_error_of_the_projected_reference_solution_is_the_truncation(
    table: Table, source: Source, reference: ReferenceRun
) -> None:
    q = source.subspace.project(reference.displacement_m)
    found = compare(table, source, q, reference.displacement_m)
    assert np.isclose(found["max_error"], floor(table, source, reference.displacement_m)["truncation"])
    assert np.isclose(
        found["rendered"]["max_error"], floor(table, source, reference.displacement_m)["truncation_and_nodes"]
    )


def test_the_error_of_a_tree_at_rest_is_the_sway(
    table: Table, source: Source, reference: ReferenceRun
) -> None:
    found = compare_methods(table, source, reference)
    rest = found["rest-pose"]
    assert np.isclose(rest["max_error"], sway_of(reference) / float(table.metadata["height_m"]))
    assert found["modal"]["max_error"] < 0.03 * rest["max_error"]


def test_without_records_only_the_default_method_is_evaluated(
    folder: Path, table: Table, reference: ReferenceRun
) -> None:
    alone = replace(table, paper=None)
    source = source_of(alone, folder / "tree.glb", folder / "cache", workers=1)
    found = compare_methods(alone, source, reference)
    assert set(found) == {"modal", "rest-pose", "floor"}
    assert set(compare_methods(table, source, reference)) > set(found)


def test_the_model_of_a_mesh_is_that_of_its_build(folder: Path, table: Table) -> None:
    model = model_of(small_tree_glb(), "tree.glb", OPTIONS, folder / "cache")
    assert content_hash(model) == table.metadata["provenance"]["model_sha256"]


def test_a_wind_is_scaled_to_the_requested_sway(source: Source, tmp_path: Path) -> None:
    wind = np.tile([[10.0, 0.0]], (60, 1))
    task = ReferenceTask(source.model_path, wind, 0.02)
    ran = read_reference_run(run_references([task], tmp_path, lambda done: None)[0])
    assert abs(sway_of(ran) / 0.02 - 1) <= 0.03
    assert np.allclose(ran.pressure_pa / ran.pressure_pa[0, 0], wind / wind[0, 0])
    weak = read_reference_run(
        run_references([ReferenceTask(source.model_path, wind, 9.0, 12.0)], tmp_path, lambda d: None)[0]
    )
    assert np.isclose(np.linalg.norm(weak.pressure_pa, axis=1).max(), 12.0)


def test_a_long_run_is_cached_and_motion_is_bounded_beyond_the_sampled_range(
    table: Table, source: Source, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.modules[long_run.__module__], "WINDOW_FRAMES", 400)
    first = long_run(table, source, tmp_path, lambda f, m: None, frames=2000, sway=0.005, seed=610)
    # The stub sways little even so: errors are compared with the sway.
    share = [window["max_error"] / window["sway"] for window in first["methods"]["modal"]]
    assert len(share) == 5
    assert max(share) < 0.01
    # The first window begins at rest, where there is no error yet.
    assert max(share[2:]) <= 1.5 * max(share[:2])
    again = long_run(table, source, tmp_path, lambda f, m: None, frames=2000, sway=0.005, seed=610)
    assert first == again
    far = play_beyond_range(table, source, frames=300)
    assert far["extrapolation_ratio"] > 1
    assert far["largest"] < 1
    assert far["left_at_rest_m"] == 0


def test_the_command_needs_only_the_table_and_fails_without_its_model(folder: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "figures.json", tmp_path / "errors.svg"
    result = CliRunner().invoke(app, [
        "evaluate", str(folder / "tree.gwt"), "--cache-dir", str(folder / "cache"), "--frames", "60",
        "--workers", "1", "--json", str(out), "--plot", str(picture),
    ])  # fmt: skip
    assert result.exit_code == 0, result.output
    found = json.loads(out.read_text())
    assert set(found["uniform"]["step"]) >= {"modal", "paper", "paper-literal", "rest-pose", "floor"}
    assert all(wind["modal"]["max_error_of_sway"] < 0.01 for wind in found["uniform"].values())
    assert list(found["gusts"]) == ["7 m/s", "18 m/s", "10 % sway", "20 % sway"]
    assert list(found).index("gusts") < list(found).index("uniform")
    assert all(0 < case["modal"]["rms_error_of_rms_sway"] < 1 for case in found["gusts"].values())
    assert 0 < result.output.index("In gusts") < result.output.index("the same over the whole crown")
    assert picture.stat().st_size > 1000
    missing = CliRunner().invoke(app, ["evaluate", str(folder / "tree.gwt"), "--cache-dir", str(tmp_path)])
    assert missing.exit_code == 1


def test_the_model_of_another_table_is_not_found(folder: Path) -> None:
    assert find_model({"provenance": {"model_sha256": "0" * 64}}, folder / "cache") is None
    with pytest.raises(SourceError, match="does not name its model"):
        find_model({"provenance": {}}, folder / "cache")


GUSTY = replace(PRESETS["autumn-gusts"], mean_speed_m_s=6.0, length_scale_m=10.0)


def test_gusts_of_a_cosine_wind_are_the_uniform_wind(table: Table, source: Source, tmp_path: Path) -> None:
    options, wind = EvaluationOptions(frames=90, workers=1), Wind(mean_speed_m_s=6.0, gustiness=0.5)
    found = evaluate_in_gusts(
        table, source, options, tmp_path, lambda f, m: None, cases={"cosine": GustCase(wind)}
    )
    assert found["cosine"]["modal"]["rms_error_of_rms_sway"] < 0.05
    place, height_m = place_of(options.seed), float(table.metadata["height_m"])
    pressure_pa = np.array([
        one.tree_pa
        for one in node_pressures(
            source.model, WindState(wind, wind), place, 90, height_m=height_m, most_pa=np.inf
        )
    ])  # fmt: skip
    q, ratio = play_in_wind(table, WindState(wind, wind), place, 90)
    alone, _ = play_pressures(table, pressure_pa, METHODS["modal"])
    assert ratio < 1
    assert np.allclose(q, alone, atol=1e-5 * np.abs(alone).max())


def test_gusts_within_the_crown_are_evaluated_and_scaled_to_a_sway(
    table: Table, source: Source, tmp_path: Path
) -> None:
    options = EvaluationOptions(frames=120, workers=1)
    cases = {"gusts": GustCase(GUSTY), "scaled": GustCase(GUSTY, sway=0.01)}
    found = evaluate_in_gusts(table, source, options, tmp_path, lambda f, m: None, cases=cases)
    for case in found.values():
        assert 0 < case["floor"]["rms_error_of_rms_sway"] < case["modal"]["rms_error_of_rms_sway"] < 0.8
        assert 0.2 < case["modal"]["branches"] < 1.5
        assert case["modal"]["max_error"] == max(case["modal"]["error_by_frame"])
        assert case["modal"]["rms_error_of_rms_sway"] < case["paper"]["rms_error_of_rms_sway"]
    assert found["scaled"]["reference_sway"] == pytest.approx(0.01, rel=0.03)
    assert found["gusts"]["mean_speed_m_s"] == 6.0 != found["scaled"]["mean_speed_m_s"]
    paths = list((tmp_path / "references").iterdir())
    again = evaluate_in_gusts(table, source, options, tmp_path, lambda f, m: None, cases=cases)
    assert again == found and list((tmp_path / "references").iterdir()) == paths
