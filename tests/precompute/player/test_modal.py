"""The modal model follows its reference solution, stays bounded, and comes to rest in still air."""

import numpy as np
import pytest
from galewood.motion.modal import ModalTensors
from galewood.motion.wind import dynamic_pressure
from galewood.pipeline.reduction.modal_fit import ridge_fit
from galewood.pipeline.reduction.oscillators import propagators, response
from galewood.pipeline.sampling.training_winds import noise, training_shapes
from galewood.player.modal_forest import ModalForest
from galewood.solid.fem.model import FemSettings
from galewood.table.format import decode

from tests.golden.beam import Beam
from tests.precompute.table.test_table import FILE

TABLE = decode(FILE)
DT_S = float(TABLE.metadata["dt_s"])
HEIGHT_M = float(TABLE.metadata["height_m"])


def forest(count: int = 1, modal: ModalTensors | None = None) -> ModalForest:
    return ModalForest(modal or TABLE.modal, DT_S, TABLE.mode_scale, count)


def masses(q: np.ndarray) -> np.ndarray:
    """(n, 3) displacement of the pole's masses, each of which has two render vertices."""
    moved = np.einsum("nik,k->ni", TABLE.node_basis.astype(np.float64), q)
    return moved[TABLE.vertex_node][:12:2]


def noisy_pressure_pa(rng: np.random.Generator, frames: int) -> np.ndarray:
    """(frames, 2) wind with a mean of 7 m/s and a heading that varies about a random one."""
    speed_m_s = np.clip(7.0 * (1.0 + 0.35 * noise(rng, frames, DT_S, 5 / 3)), 0.0, 12.0)
    heading = rng.uniform(0, 2 * np.pi) + rng.uniform(0.3, 0.7) * noise(rng, frames, DT_S, 2.0)
    return dynamic_pressure(speed_m_s)[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])


def sway_error(
    seed: int, frames: int, calm_from: int, period: int | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Largest error and displacement of each frame, over the height, in noise that ends at ``calm_from``."""
    rng = np.random.default_rng(seed)
    wind = np.resize(noisy_pressure_pa(rng, period or frames), (frames, 2))
    wind[calm_from:] = 0
    beam, trees = Beam(), forest()
    error, sway = np.empty(frames), np.empty(frames)
    for frame, (x, z) in enumerate(wind):
        beam.step(wind[frame])
        trees.advance(DT_S, [x], [z])
        trees.advance(0.0, [x], [z])
        shown = trees._now[0]  # pyright: ignore[reportPrivateUsage]
        error[frame] = np.linalg.norm(masses(shown) - beam.u, axis=1).max() / HEIGHT_M
        sway[frame] = np.linalg.norm(beam.u, axis=1).max() / HEIGHT_M
    return error, sway


@pytest.mark.parametrize("seed", [501, 502, 503])
def test_follows_the_reference_solution_in_unseen_winds_and_returns_to_rest(seed: int) -> None:
    error, sway = sway_error(seed, 900, 600)
    assert sway.max() > 0.1
    assert error.max() < 0.05 * sway.max()
    assert error[-1] < 1e-4


def test_the_error_does_not_grow_with_time() -> None:
    # The noise repeats every 1,500 frames; the first window starts from rest.
    error, _ = sway_error(seed=504, frames=9000, calm_from=9000, period=1500)
    largest = error.reshape(6, 1500).max(axis=1)[1:]
    assert largest[1:].max() <= 1.01 * largest[0]


def test_stays_bounded_and_reports_extrapolation_far_beyond_the_sampled_wind() -> None:
    trees = forest()
    storm = 10 * float(TABLE.modal.limits[2])
    for frame in range(4000):
        trees.advance(DT_S, [storm if frame % 40 < 20 else -storm], [storm])
        assert trees.extrapolation_ratio[0] > 1
    assert np.isfinite(trees.q).all()
    for _ in range(4000):
        trees.advance(DT_S, [0.0], [0.0])
    assert not trees.q.any()


def test_trees_stay_at_rest_in_still_air() -> None:
    trees = forest(3)
    for _ in range(100):
        trees.advance(DT_S / 2, np.zeros(3), np.zeros(3))
    assert not trees.q.any()
    assert not trees.extrapolation_ratio.any()


def test_trees_are_independent_of_each_other() -> None:
    rng = np.random.default_rng(505)
    both, alone = forest(2), forest(1)
    for _ in range(200):
        x, z = rng.normal(0, 10, (2, 2))
        both.advance(DT_S, x, z)
        alone.advance(DT_S, x[1:], z[1:])
        assert np.array_equal(both.q[1], alone.q[0])


def test_the_wind_is_turned_into_the_frame_of_the_tree() -> None:
    turned, straight = forest(), forest()
    turned.set_trees([0.0], [0.0], [0.3], [1.0])
    c, s = np.float32(np.cos(np.float32(0.3))), np.float32(np.sin(np.float32(0.3)))
    for _ in range(60):
        turned.advance(DT_S, [8.0], [3.0])
        straight.advance(DT_S, [8.0 * float(c) - 3.0 * float(s)], [8.0 * float(s) + 3.0 * float(c)])
    assert np.allclose(turned.q, straight.q, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(("scheme", "substeps"), [("tr-bdf2", 1), ("tr-bdf2", 3), ("backward-euler", 2)])
def test_propagators_follow_the_time_scheme_and_the_exact_solution(scheme: str, substeps: int) -> None:
    settings = FemSettings(dt_s=1 / 400, substeps=substeps, scheme=scheme)  # pyright: ignore[reportArgumentType]
    omega, damping = 2 * np.pi * 0.7, 0.25
    step = propagators(np.array([omega]), np.array([damping]), settings)
    moved = response(step[0], np.full((2000, 1), omega**2))[:, 0]
    t = np.arange(2001) / 400
    half, ringing = damping / 2, np.sqrt(omega**2 - damping**2 / 4)
    exact = 1 - np.exp(-half * t) * (np.cos(ringing * t) + half / ringing * np.sin(ringing * t))
    assert np.abs(moved - exact).max() < (1e-4 if scheme == "tr-bdf2" else 5e-2)


def test_ridge_fit_recovers_the_coefficients_of_the_data() -> None:
    rng = np.random.default_rng(506)
    terms = rng.normal(size=(500, 6)) * 10.0 ** np.arange(-3, 3)
    exact = rng.normal(size=(6, 2))
    assert np.allclose(ridge_fit(terms, terms @ exact, 1e-12), exact, rtol=1e-6)


def test_training_winds_are_deterministic_and_peak_at_the_given_speed() -> None:
    first, second, top = (
        [shape.at(10.0) for shape in training_shapes(0.6, 1 / 30, seed=seed)] for seed in (1, 1, 2)
    )
    assert [wind.name for wind in first] == [wind.name for wind in second]
    for a, b in zip(first, second, strict=True):
        assert np.array_equal(a.pressure_pa, b.pressure_pa)
        assert np.linalg.norm(a.pressure_pa, axis=1).max() == pytest.approx(15.0 * 2**1.3)
    assert not np.array_equal(first[0].pressure_pa, top[0].pressure_pa)
