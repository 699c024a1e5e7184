"""The output-error fit: gradients against finite differences, steps against the player's, recovery."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.motion.modal import (
    ModalTensors,
    add_drag,
    add_drag_gradient,
    add_terms_gradient,
    coupled_of,
    drag_tensors,
    force_terms,
    write_force_terms,
)
from galewood.pipeline.reduction import output_error, run_lanes
from galewood.pipeline.reduction.modal_fit import force_table
from galewood.pipeline.reduction.modal_runs import ModalRun
from galewood.pipeline.reduction.oscillators import felt_wind, propagators
from galewood.pipeline.reduction.training_error import simulated_q
from galewood.pipeline.sampling import CrownGusts
from galewood.solid.fem import FemSettings
from galewood.table.format import decode
from galewood.util import Floats

from tests.golden import GOLDEN_FOLDER

SEED = 71_093
DT_S = 1 / 30
TABLE = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
assert TABLE.modal is not None
MODAL = TABLE.modal
LANES = 5


def terms_of(sway: Floats, limits: Floats, e: Floats, v: Floats, pressure: Floats) -> Floats:
    out = np.empty((force_terms(coupled_of(limits)), LANES))
    write_force_terms(sway, limits, DT_S / 2, e, v, pressure, np.empty_like(e), np.empty((3, 2, LANES)), out)
    return out


@pytest.mark.parametrize("coupled", [0, 3])
@pytest.mark.parametrize("reach", [0.4, 2.5])
def test_gradient_of_the_terms_is_that_of_differences(coupled: int, reach: float) -> None:
    """With reach 2.5 some arguments are clamped."""
    print("seed", SEED)
    rng = np.random.default_rng((SEED, coupled, int(10 * reach)))
    d = 6
    sway, limits = rng.normal(size=(2, d)) / d, np.ones(3 + 2 * coupled)
    e, v, pressure = reach * rng.normal(size=(3, d, LANES))
    pressure = pressure[:2]
    weight = rng.normal(size=(force_terms(coupled), LANES))
    by_e, by_v = np.zeros((d, LANES)), np.zeros((d, LANES))
    add_terms_gradient(sway, limits, DT_S / 2, e, v, pressure, weight, by_e, by_v)
    step = 1e-6
    for k in range(d):
        shift = np.zeros((d, 1))
        shift[k] = step
        for own, change in ((by_e, (shift, 0)), (by_v, (0, shift))):
            ahead = terms_of(sway, limits, e + change[0], v + change[1], pressure)
            behind = terms_of(sway, limits, e - change[0], v - change[1], pressure)
            expected = (weight * (ahead - behind)).sum(axis=0) / (2 * step)
            np.testing.assert_allclose(own[k], expected, rtol=1e-6, atol=1e-6 * np.abs(weight).sum())


@pytest.mark.parametrize(("speed_m_s", "exponent"), [(1.0, 1.3), (8.0, 1.3), (8.0, 1.64), (8.0, 2.0)])
def test_gradient_of_the_drag_is_that_of_differences(speed_m_s: float, exponent: float) -> None:
    rng = np.random.default_rng((SEED, int(speed_m_s)))
    d, points = 10, 3
    point = np.stack([rng.uniform(1, 5, points), rng.uniform(0.2, 1, points)], axis=1)
    tensors = drag_tensors(point, rng.normal(size=(3, points, d)), rng.uniform(0, 2, d), exponent)
    v = speed_m_s * rng.normal(size=(d, LANES))
    air = 0.6 * speed_m_s**2 * rng.normal(size=(2 * points, LANES))
    air[:, 0] = 0.0  # still air
    weight = rng.normal(size=(d, LANES))

    def force(at: Floats) -> Floats:
        total = np.zeros((d, LANES))
        add_drag(*tensors, at, air, np.empty((3 * points + 2, LANES)), total)
        return total

    by_v = np.zeros((d, LANES))
    add_drag_gradient(*tensors, v, air, weight, by_v)
    step = 1e-6
    for k in range(d):
        shift = np.zeros((d, 1))
        shift[k] = step
        expected = (weight * (force(v + shift) - force(v - shift))).sum(axis=0) / (2 * step)
        np.testing.assert_allclose(by_v[k], expected, rtol=1e-5, atol=1e-6 * np.abs(by_v).max())


def winds_pa(count: int, frames: int = 90) -> list[Floats]:
    """Winds as strong as the table's, of different lengths."""
    rng = np.random.default_rng((SEED, count))
    time = np.arange(frames) * DT_S
    winds: list[Floats] = []
    for i in range(count):
        turn, rate, peak = rng.uniform(0, 6), rng.uniform(2, 9), rng.uniform(0.3, 0.8)
        strength = float(MODAL.limits[2]) * peak * (0.5 + 0.5 * np.sin(rate * time))
        wind = strength[:, None] * np.stack([np.cos(turn + time), np.sin(turn + time)], axis=1)
        winds.append(wind[: max(frames - 10 * i, 60)])
    return winds


GUSTS = CrownGusts(6, 3.0, 4.0, 0.8, 5.0, 0.5, 1.3)


def run_of(model: ModalTensors, wind: Floats) -> ModalRun:
    """The motion of a model in gusts as a training run."""
    q = simulated_q(model, [(wind, GUSTS)], DT_S)[0]
    e = q[:, : len(model.shown)] / model.shown
    felt = felt_wind(wind, GUSTS, np.asarray(model.place, np.float64), DT_S)
    return ModalRun(felt, e, np.gradient(e, DT_S, axis=0), q)


def shapes(d: int) -> Floats:
    return np.random.default_rng((SEED, 9)).normal(size=(d, 30))


def simulation(runs: list[ModalRun]) -> output_error.Simulation:
    own = shapes(len(MODAL.shown))
    lanes = run_lanes.side_by_side(MODAL, runs, np.ones(len(runs)))
    return output_error.Simulation(MODAL, lanes, own @ own.T / 10, DT_S)


def exact_force() -> Floats:
    """(d, F + 2G) the force of the table, and no correction of the loads of its places."""
    places = np.zeros((len(MODAL.shown), 2 * len(MODAL.place)))
    return np.concatenate([MODAL.force.T, places], axis=1).astype(np.float64)


def test_the_fit_simulates_what_the_player_plays() -> None:
    runs = [run_of(MODAL, wind) for wind in winds_pa(3)]
    exact = exact_force()
    assert len(MODAL.place) > 2
    cost, _ = simulation(runs).cost(exact)
    still, _ = simulation([replace(run, e=0 * run.e) for run in runs]).cost(exact)
    assert cost < 1e-10 * still  # the player's numbers are float32


def test_the_gradient_of_the_simulation_is_that_of_differences() -> None:
    rng = np.random.default_rng((SEED, 3))
    runs = [run_of(MODAL, wind) for wind in winds_pa(3)]
    own, exact = simulation(runs), exact_force()
    force = np.ascontiguousarray(0.5 * exact)
    exact[:, len(MODAL.force) :] = MODAL.place_load.reshape(len(exact), -1)
    _, gradient = own.cost(force)
    for _ in range(4):
        way = rng.normal(size=force.shape) * np.abs(exact)
        step = 1e-6
        expected = (own.cost(force + step * way)[0] - own.cost(force - step * way)[0]) / (2 * step)
        assert np.isclose(np.sum(gradient * way), expected, rtol=1e-5)


def test_a_motion_that_diverges_costs_infinitely_much() -> None:
    own = simulation([run_of(MODAL, wind) for wind in winds_pa(1)])
    cost, gradient = own.cost(np.full(exact_force().shape, 1e200))
    assert cost == np.inf
    assert not gradient.any()


def stiffening_pair() -> ModalTensors:
    """Two oscillators across each other, whose stiffness grows with the square of the sway; no drag."""
    omega, damping = np.array([3.0, 3.3]), np.array([0.4, 0.4])
    step = propagators(omega, damping, FemSettings())
    step[:, [0, 3]] -= 1.0
    force = np.zeros((force_terms(0), 2))
    force[3], force[5] = (-6.0, 0.0), (-6.0, 0.0)  # x³ and x y² push along x
    force[4], force[6] = (0.0, -6.0), (0.0, -6.0)  # x² y and y³ along y
    none = np.zeros((11, 0)), np.array([1.0, 6.0, 60.0]), np.zeros((0, 2)), np.zeros((3, 0, 2)), np.zeros(2)
    places = np.zeros((0, 0)), np.zeros((0, 3)), np.zeros((2, 2, 0))
    tensors = (step, 0.1 * np.eye(2), np.eye(2), force, np.ones(2), *none, *places)
    singles = (np.ascontiguousarray(tensor, np.float32) for tensor in tensors)
    return ModalTensors(*singles, streamlined_exponent=1.3)


def test_a_linear_model_follows_a_nonlinear_one_after_the_fit() -> None:
    """In gusts, and in one that it was not fitted to."""
    rng = np.random.default_rng((SEED, 4))
    exact = stiffening_pair()
    winds = [np.repeat(rng.normal(0, 40, (15, 2)), 8, axis=0) for _ in range(9)]
    runs = [run_of(exact, wind) for wind in winds[:8]]
    linear = replace(exact, force=0 * exact.force)
    sway, limits = np.asarray(exact.sway, np.float64), np.asarray(exact.limits, np.float64)
    tables = [force_table(run, sway, limits, np.zeros(0), DT_S / 2) for run in runs]
    force = output_error.fitted_force(
        linear, [np.zeros(linear.force.shape)], runs, tables, np.ones(8), np.eye(2, 6), DT_S
    )
    fitted = replace(linear, force=np.ascontiguousarray(force, np.float32))

    def gap(model: ModalTensors, wind: Floats) -> float:
        return float(np.abs(run_of(model, wind).e - run_of(exact, wind).e).max())

    for wind in winds:
        assert gap(fitted, wind) < 0.1 * gap(linear, wind)
