"""E_int against its definition in the paper (Eq. 12–14)."""

import numpy as np
import pytest
from galewood.motion.search.similarity import InternalStates, compared, mismatch_rows


def naive_mismatches(states: InternalStates, c: int, j: int, rms: list[np.ndarray]) -> int:
    """Eq. 12–14 literally: all nine entries of the block, ranges from record j."""
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


def test_mismatches_match_the_definition() -> None:
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


def test_ranks_are_exact_where_values_repeat_or_touch_the_edge_of_a_range() -> None:
    values = np.array(
        [0.0, 1.0, 1.05, 1.05, 0.95, -1.0, 20.0, 21.0, np.nextafter(np.float32(1.05), 2)], np.float32
    )
    states = InternalStates(
        *(np.repeat(values[:, None, None], w, axis=2).repeat(2, axis=1) for w in (3, 3, 6))
    )
    rms = [np.sqrt(np.mean(np.square(p, dtype=np.float64), axis=0)) for p in vars(states).values()]
    rows = mismatch_rows(compared(states), 0, len(values))
    for c in range(len(values)):
        assert rows[c].tolist() == [naive_mismatches(states, c, j, rms) for j in range(len(values))]


def test_more_records_than_sixteen_bits_are_refused() -> None:
    many = np.zeros((65536, 1, 3), np.float32)
    with pytest.raises(ValueError, match="65536 records"):
        compared(InternalStates(many, many, np.zeros((65536, 1, 6), np.float32)))
