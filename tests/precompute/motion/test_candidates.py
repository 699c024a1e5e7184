"""Candidate lists against a search of all records: equal results for any pressure and allowed weight."""

import math
from typing import Any

import numpy as np
import pytest
from galewood.constants import SEARCH_ANY_AIR
from galewood.motion.search import candidates, contenders, envelope
from galewood.motion.search.candidates import Rule, Search, air_of, build_search, gain_bound
from galewood.motion.search.similarity import InternalStates, compared, mismatch_rows
from galewood.pipeline.tables.assemble import internal_states, spread_pa
from galewood.player.paper_search import SearchArrays, best_candidate, brute_force, nearest_pressure

from tests.golden.make import SMALL, Beam, beam_runs


def test_the_gain_never_exceeds_its_bound() -> None:
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(2, 100000, 2)) * 3
    f = a + rng.normal(size=a.shape) * 2
    gain = np.exp(-0.5 * ((f - b) ** 2).sum(1)) - np.exp(-0.5 * ((f - a) ** 2).sum(1))
    bound = gain_bound()
    index = np.minimum((np.linalg.norm(a - b, axis=1) * 256).astype(int) + 1, len(bound) - 1)
    assert (gain <= bound[index]).all()
    assert (np.diff(bound) >= 0).all()


def differences(
    states: InternalStates, pressure: np.ndarray, starts: np.ndarray, rule: Rule, rng: np.random.Generator
) -> tuple[int, Search]:
    """Number of random queries on which the candidates and brute force disagree, and the candidates."""
    layout, air = compared(states), air_of(pressure, starts)
    search = build_search(layout, air, rule)
    half = 1 / (2 * rule.sigma_pa**2)
    arrays = SearchArrays(
        search.offsets.astype(np.int64), search.record.astype(np.int64),
        search.mismatches / states.components, air.pressure, air.calm, air.barred,
        np.argsort(air.pressure[:, 0], kind="stable"), half,
    )  # fmt: skip
    wrong = 0
    for _ in range(1000):
        c = int(rng.integers(len(pressure)))
        weight = float(rng.uniform(rule.weight_initial, rule.weight_maximum))
        f = (
            air.pressure[rng.integers(len(pressure))]
            + rng.normal(size=2) * rng.choice([0, 0.03, 0.3, 3]) * rule.sigma_pa
        )
        row = mismatch_rows(layout, c, c + 1)[0] / states.components
        for wanted in (SEARCH_ANY_AIR, 0, 1):
            if wanted == 0 and air.calm[c]:
                continue  # this is a first step, which does not use the candidates
            found = best_candidate(arrays, c, weight, wanted, f[0], f[1])
            wrong += found != brute_force(c, row, air.pressure, air.barred, half, weight, f, wanted)
    return wrong, search


@pytest.mark.parametrize("seed", [4, 5])
def test_candidates_of_a_swaying_beam_match_brute_force(seed: int) -> None:
    print("seed", seed)
    runs = beam_runs(Beam(), 40)
    states = internal_states(runs)
    pressure = np.concatenate([run.pressure_pa for run in runs])
    starts = np.cumsum([0, *(len(run.pressure_pa) for run in runs)])
    rule = Rule(states.components, SMALL.sigma_share * spread_pa(pressure), 0.3, 0.5)
    wrong, _ = differences(states, pressure, starts, rule, np.random.default_rng(seed))
    assert wrong == 0


def random_runs(rng: np.random.Generator, digits: int = 7) -> tuple[InternalStates, np.ndarray, np.ndarray]:
    """States, pressures and starts of 400 random records, partly in still air; few ``digits`` cause ties."""
    z, q = 400, 6
    path = np.cumsum(rng.normal(size=(z, q, 12)), axis=0) * 0.02 + rng.choice([-1, 1], size=(z, q, 12))
    path = np.round(path, digits)
    states = InternalStates(
        *(part.astype(np.float32) for part in (path[..., :3], path[..., 3:6], path[..., 6:]))
    )
    pressure = np.round(np.cumsum(rng.normal(size=(z, 2)), axis=0), digits).astype(np.float32)
    pressure[150:200] = 0.0
    pressure[380:] = 0.0
    return states, pressure, np.array([0, 90, 200, 310, z])


RULES = [
    (6, 0.36, 0.38, 2.0, 7),
    (7, 0.05, 0.6, 1.0, 7),
    (8, 0.3, 0.33, 9.0, 7),
    (10, 0.3, 0.4, 2.0, 1),
    (11, 0.01, 0.02, 3.0, 1),
    (12, 0.9, 0.95, 0.5, 1),
]
"""Seed, smallest and largest weight, σ in Pa, and digits of the values."""


@pytest.mark.parametrize(("seed", "initial", "maximum", "sigma_pa", "digits"), RULES)
def test_candidates_of_random_states_match_brute_force(
    seed: int, initial: float, maximum: float, sigma_pa: float, digits: int
) -> None:
    print("seed", seed)
    rng = np.random.default_rng(seed)
    states, pressure, starts = random_runs(rng, digits)
    z = len(pressure)
    wrong, search = differences(
        states, pressure, starts, Rule(states.components, sigma_pa, initial, maximum), rng
    )
    print("candidates per state", len(search.record) / z)
    assert wrong == 0
    assert len(search.record) < 0.9 * z * z


@pytest.mark.parametrize("head", [0, 5, 12, 1000])
@pytest.mark.parametrize("rare", [0.0, 0.2, 2.0])
@pytest.mark.parametrize("digits", [1, 7])
def test_counting_in_stages_finds_all_mismatches(
    monkeypatch: pytest.MonkeyPatch, head: int, rare: float, digits: int
) -> None:
    monkeypatch.setattr(contenders, "MAX_BOUND_COMPONENTS", head)
    monkeypatch.setattr(contenders, "RARE_MATCH_SHARE", rare)
    states, _, _ = random_runs(np.random.default_rng(13), digits)
    layout = compared(states)
    parts, exact = contenders.stages(layout), mismatch_rows(layout, 37, 96)
    rows = contenders.lower_bounds(parts, 37, 96)
    assert (rows <= exact).all()
    bounds, chosen = rows.copy(), np.random.default_rng(14).random(rows.shape) < 0.5
    contenders.complete(parts, 37, chosen, rows)
    assert (rows == np.where(chosen, exact, bounds)).all()


@pytest.mark.parametrize(("seed", "initial", "maximum", "sigma_pa", "digits"), RULES)
def test_records_ruled_out_by_their_bounds_change_nothing(
    monkeypatch: pytest.MonkeyPatch, seed: int, initial: float, maximum: float, sigma_pa: float, digits: int
) -> None:
    print("seed", seed)
    states, pressure, starts = random_runs(np.random.default_rng(seed), digits)
    layout, air = compared(states), air_of(pressure, starts)
    rule = Rule(states.components, sigma_pa, initial, maximum)
    monkeypatch.setattr(contenders, "MAX_BOUND_COMPONENTS", 20)
    found = build_search(layout, air, rule)

    def choose_all(*arguments: Any) -> None:
        arguments[-1][:] = True

    monkeypatch.setattr(candidates, "_choose_rows", choose_all)
    complete = build_search(layout, air, rule)
    for name, value in vars(complete).items():
        assert np.array_equal(getattr(found, name), value), name


def test_the_gaussian_of_the_envelope_is_far_more_accurate_than_the_margin() -> None:
    for exponent in np.linspace(0.0, 60.0, 5000):
        error = envelope._gaussian(float(exponent)) - math.exp(-exponent)  # pyright: ignore[reportPrivateUsage]
        assert abs(error) < 0.02 * candidates.ROUNDING_MARGIN


def test_the_search_can_be_cancelled() -> None:
    class Cancelled(Exception):
        pass

    def cancel(fraction: float) -> None:
        raise Cancelled

    states, pressure, starts = random_runs(np.random.default_rng(15))
    with pytest.raises(Cancelled):
        build_search(
            compared(states), air_of(pressure, starts), Rule(states.components, 2.0, 0.3, 0.4), cancel
        )


def test_nearest_pressure_matches_a_full_search() -> None:
    rng = np.random.default_rng(9)
    pressure = rng.integers(-6, 7, size=(300, 2)).astype(np.float64)  # many equal ones
    barred, calm = rng.random(300) < 0.3, np.logical_not(np.any(pressure, axis=1))
    by_x, nothing = np.argsort(pressure[:, 0], kind="stable"), np.zeros(0, np.int64)
    search = SearchArrays(nothing, nothing, np.zeros(0), pressure, calm, barred, by_x, 1.0)
    for _ in range(500):
        f = rng.choice([rng.normal(size=2) * 6, rng.integers(-8, 9, size=2).astype(float)])
        for air in (SEARCH_ANY_AIR, 0, 1):
            allowed = ~barred & ((calm == air) if air != SEARCH_ANY_AIR else True)
            gaps = np.where(allowed, ((f - pressure) ** 2).sum(axis=1), np.inf)
            expected = int(np.argmin(gaps)) if allowed.any() else -1
            assert nearest_pressure(search, air, f[0], f[1]) == expected
