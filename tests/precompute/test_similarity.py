"""E_int against its definition, and the candidates against asking every record."""

import numpy as np
import pytest

from precompute.lookup import ANY, best_candidate, brute_force
from precompute.similarity import (
    InternalStates,
    build_search,
    compared,
    gain_bound,
    last_records,
    mismatch_rows,
    still_records,
)
from precompute.tabulate import internal_states, spread_pa
from tests.golden.make import SMALL, Beam, beam_runs


def naive_mismatches(states: InternalStates, c: int, j: int, rms: np.ndarray) -> int:
    """Eq. 12–14 word by word: all nine entries of the block, ranges from record j."""
    full = [[0, 3, 4], [3, 1, 5], [4, 5, 2]]
    count = 0
    for m in range(states.velocity.shape[1]):
        pairs = [(states.velocity[j, m, a], states.velocity[c, m, a], rms[0][m, a]) for a in range(3)]
        pairs += [(states.force[j, m, a], states.force[c, m, a], rms[1][m, a]) for a in range(3)]
        flat = [full[a][b] for a in range(3) for b in range(3)]
        pairs += [(states.stiffness[j, m, a], states.stiffness[c, m, a], rms[2][m, a]) for a in flat]
        for of_j, of_c, typical in pairs:
            reach = max(abs(of_j) / np.float32(20), np.float32(1e-3 * typical))
            count += not (of_j - reach <= of_c <= of_j + reach)
    return count


def random_states(rng: np.random.Generator, z: int, q: int) -> InternalStates:
    drift = np.cumsum(rng.normal(size=(z, q, 12)), axis=0) * 0.05 + rng.normal(size=(q, 12))
    parts = drift.astype(np.float32)
    return InternalStates(parts[..., :3], parts[..., 3:6], parts[..., 6:])


def test_mismatches_are_those_of_the_definition() -> None:
    rng = np.random.default_rng(1)
    states = random_states(rng, 30, 7)
    rms = [np.sqrt(np.mean(np.square(p, dtype=np.float64), axis=0)) for p in vars(states).values()]
    rows = mismatch_rows(compared(states), 3, 12)
    for c in range(3, 12):
        assert rows[c - 3].tolist() == [naive_mismatches(states, c, j, rms) for j in range(30)]


def test_a_state_matches_itself_and_a_resting_component_matches() -> None:
    states = random_states(np.random.default_rng(2), 20, 3)
    states.velocity[:, 1] = 0.0
    assert np.diag(mismatch_rows(compared(states), 0, 20)).tolist() == [0] * 20
    states = InternalStates(states.velocity * 0, states.force * 0, states.stiffness * 0)
    assert not mismatch_rows(compared(states), 0, 20).any()


def test_the_bound_of_the_gain_bounds_it() -> None:
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(2, 100000, 2)) * 3
    f = a + rng.normal(size=a.shape) * 2
    gain = np.exp(-0.5 * ((f - b) ** 2).sum(1)) - np.exp(-0.5 * ((f - a) ** 2).sum(1))
    bound = gain_bound()
    index = np.minimum((np.linalg.norm(a - b, axis=1) * 256).astype(int) + 1, len(bound) - 1)
    assert (gain <= bound[index]).all()
    assert (np.diff(bound) >= 0).all()


@pytest.mark.parametrize("seed", [4, 5])
def test_candidates_give_what_asking_every_record_gives(seed: int) -> None:
    print("seed", seed)
    rng = np.random.default_rng(seed)
    beam = Beam()
    runs = beam_runs(beam, 40)
    states = internal_states(runs)
    pressure = np.concatenate([run.pressure_pa for run in runs])
    starts = np.cumsum([0, *(len(run.pressure_pa) for run in runs)])
    sigma, maximum = SMALL.sigma_share * spread_pa(pressure), SMALL.weight_maximum
    search = build_search(states, pressure, starts, sigma, maximum)
    error = search.mismatches / states.components
    wide, barred, calm = pressure.astype(np.float64), last_records(starts), still_records(pressure)
    half = 1 / (2 * sigma * sigma)
    layout = compared(states)
    for _ in range(3000):
        c = int(rng.integers(len(wide)))
        weight = float(rng.uniform(0.05, maximum))
        f = wide[rng.integers(len(wide))] + rng.normal(size=2) * rng.choice([0.0, 0.3, 3.0, 30.0])
        row = mismatch_rows(layout, c, c + 1)[0] / states.components
        for air in (ANY, 0, 1):
            found = best_candidate(
                search.offsets, search.record, error, wide, calm, half, c, weight, air, f[0], f[1]
            )
            assert found == brute_force(c, row, wide, barred, half, weight, f, air)
