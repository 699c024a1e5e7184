"""Figures of an evaluation against what they must be."""

from pathlib import Path

import numpy as np

from precompute.evaluate import METHODS, compare, hausdorff, nearest_sample, table_nodes
from precompute.evaluate_plot import plot_errors
from precompute.evaluate_winds import unseen_winds
from precompute.table import decode
from tests.precompute.test_table import FILE

TABLE = decode(FILE)


def test_a_perfect_track_has_no_error_and_a_resting_one_errs_by_the_sway() -> None:
    rng = np.random.default_rng(601)
    rest, truth = rng.normal(size=(30, 3)), 0.1 * rng.normal(size=(80, 30, 3))
    perfect, resting = compare(truth, truth, rest, 2.0), compare(np.zeros_like(truth), truth, rest, 2.0)
    assert perfect["max_error"] == perfect["hausdorff"][60] == 0
    assert resting["max_error"] == resting["true_sway"] == np.linalg.norm(truth, axis=2).max() / 2.0
    assert resting["max_error_of_sway"] == 1
    assert set(resting["frames"]) == {20, 22, 40, 60}


def test_hausdorff_distance_is_that_of_brute_force() -> None:
    rng = np.random.default_rng(602)
    a, b = rng.normal(size=(40, 3)), rng.normal(size=(25, 3))
    gaps = np.linalg.norm(a[:, None] - b[None], axis=2)
    assert np.isclose(hausdorff(a, b), max(gaps.min(axis=0).max(), gaps.min(axis=1).max()))


def test_a_sampled_wind_is_its_own_nearest_sample() -> None:
    start, end = TABLE.trajectory[:2].astype(int)
    track = nearest_sample(TABLE, TABLE.pressure_pa[start:end].astype(np.float64))
    pose = TABLE.pose()[start:end] * TABLE.mode_scale
    assert np.allclose(track, np.einsum("nik,tk->tni", TABLE.node_basis, pose), atol=1e-6)


def test_tracks_of_the_drift_free_method_follow_a_sampled_run() -> None:
    start, end = TABLE.trajectory[1:3].astype(int)
    track, coverage = table_nodes(TABLE, TABLE.pressure_pa[start:end].astype(np.float64), METHODS["tangent"])
    pose = TABLE.pose()[start + 1 : end] * TABLE.mode_scale
    true = np.einsum("nik,tk->tni", TABLE.node_basis, pose)
    assert np.abs(track[:-1] - true).max() < 0.06 * np.abs(true).max()
    assert 0 < coverage < 1.3


def test_winds_keep_to_their_strength_and_change_with_the_seed() -> None:
    first, second = unseen_winds(10.0, 300, 1 / 30, seed=1), unseen_winds(10.0, 300, 1 / 30, seed=2)
    top = 15.0 * (6.5 / 5.0) ** 1.3
    for name, pressure in first.items():
        assert 0.3 * top < np.linalg.norm(pressure, axis=1).max() <= top * 1.0001, name
    assert not np.allclose(first["perlin"], second["perlin"])
    assert not first["gust-then-still"][100:].round(9).any()


def test_the_plot_is_written(tmp_path: Path) -> None:
    found = {"true_sway": 0.1, "error_by_frame": [0.0, 0.01, 0.02]}
    plot_errors({"step": {"tangent": found, "rest-pose": found}}, tmp_path / "errors.png")
    assert (tmp_path / "errors.png").read_bytes().startswith(b"\x89PNG")
