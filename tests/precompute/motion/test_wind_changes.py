"""Changes of the wind at any moment: nothing jumps, and whoever follows the states sees the same wind."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from galewood.constants import TRANSITION_S, WIND_MODELS
from galewood.motion.wind import Wind, WindField, WindState, crown_carried, crown_field, write_gusts
from galewood.motion.wind.document import DEFAULT_WAVES, Wave
from galewood.motion.wind.recording import quantised
from galewood.motion.wind.transition import change_wind, parse_state, steady
from galewood.util import Floats

X_M, Z_M = np.array([-40.0, 0.0, 7.5, 210.0]), np.array([3.0, 0.0, -90.0, 55.0])
PLACES_M = np.array([[0.5, 9.0, -0.5], [-1.0, 4.0, 1.5]])
WAVES = (DEFAULT_WAVES, (Wave(0.3, 0.6, 0.4), Wave(0.9, 0.4, 0.0, 0.25)))

RECORDINGS = tuple(quantised(np.random.default_rng(seed).normal(size=(40, 2)), 0.7) for seed in (11, 12))


def random_wind(rng: np.random.Generator) -> Wind:
    """A wind of any model; seeds, lengths and waves often stay the same, as when only a slider is moved."""
    model = str(rng.choice(WIND_MODELS, p=[0.3, 0.1, 0.3, 0.15, 0.15]))
    own: dict[str, Any] = (
        {"waves": WAVES[int(rng.integers(2))], "heading_swing_deg": float(rng.choice([12.0, 40.0]))}
        if model == "cosine"
        else {"recording": RECORDINGS[int(rng.integers(2))]}
        if model == "recorded"
        else {"length_scale_m": float(rng.choice([20.0, 35.0, 90.0]))}
    )
    return Wind(
        model=model, seed=int(rng.integers(2)), mean_speed_m_s=float(rng.uniform(0.0, 25.0)),
        direction_deg=float(rng.uniform(-180.0, 180.0)), gustiness=float(rng.uniform(0.0, 1.0)),
        convection_speed_m_s=float(rng.uniform(2.0, 20.0)), **own,
    )  # fmt: skip


def felt(state: WindState, time_s: float) -> Floats:
    """Velocities at the places (x of all, then z), m/s, and the relative gusts in a crown at each of them."""
    field, velocity = WindField(state), np.zeros((2, len(X_M)))
    field.velocity(X_M, Z_M, time_s, velocity[0], velocity[1])
    moment, gusts = field.at(time_s), np.zeros((len(X_M), 2 * len(PLACES_M)))
    turn, ones = np.tile([0.6, 0.8], (len(X_M), 1)), np.ones(len(X_M))
    field_of = crown_field(moment.crown.seed)
    pressure = (9 * ones, 0 * ones)
    write_gusts(field_of, crown_carried(moment), PLACES_M, (X_M, Z_M), turn, ones, pressure, 1.3, gusts)
    return np.concatenate([velocity.ravel(), gusts.ravel()])


def random_changes(seed: int, count: int = 25) -> list[tuple[float, Wind]]:
    """Winds and when each is asked for: often before the last transition is over."""
    rng = np.random.default_rng(seed)
    print(f"seed {seed}")
    pauses_s = rng.choice([0.02, 0.2, 0.5, 0.9, 2.0], count) * rng.uniform(0.5, 1.0, count)
    return [(float(time_s), random_wind(rng)) for time_s in 3.0 + np.cumsum(pauses_s)]


@pytest.mark.parametrize("seed", range(4))
def test_a_change_never_makes_the_wind_jump(seed: int) -> None:
    state = steady(random_wind(np.random.default_rng(100 + seed)))
    for time_s, wind in random_changes(seed):
        before = felt(state, time_s)
        state = change_wind(state, wind, time_s)
        np.testing.assert_allclose(felt(state, time_s), before, atol=1e-9)
        # where one transition follows another, and in the middle, where the gusts of crowns change over
        for share in (0.5, 1.0, 1.5, 2.0):
            moment_s = state.since_s + share * TRANSITION_S
            if moment_s > time_s:
                near = [felt(state, moment_s + side) for side in (-1e-8, 1e-8)]
                np.testing.assert_allclose(near[0], near[1], atol=1e-4)


@pytest.mark.parametrize("seed", range(4))
def test_who_follows_the_states_sees_the_same_wind(seed: int) -> None:
    state = followed = steady(random_wind(np.random.default_rng(100 + seed)))
    for time_s, wind in random_changes(seed):
        state = change_wind(state, wind, time_s)
        followed = parse_state(json.loads(json.dumps(state.document())))
        assert followed == state
        for later_s in (0.0, 0.1, 0.7, 1.3):
            np.testing.assert_array_equal(felt(followed, time_s + later_s), felt(state, time_s + later_s))


def test_a_change_early_in_a_transition_from_cosine_keeps_the_length() -> None:
    """A mixture of 20 m and 35 m cannot be written as a cosine document: the second change waits."""
    state = change_wind(steady(Wind()), Wind(model="spectral", length_scale_m=35.0), 5.0)
    state = change_wind(state, Wind(model="spectral", length_scale_m=35.0, mean_speed_m_s=15.0), 5.1)
    assert (state.before, state.since_s) == (Wind(), 5.0)
    assert state.next is not None
    assert WindField(state).at(5.6 + 0.6).wind.mean_speed_m_s == 15.0


def test_the_last_of_several_waiting_changes_counts() -> None:
    state = change_wind(steady(Wind()), Wind(model="perlin"), 5.0)
    for speed in (3.0, 30.0, 12.0):
        state = change_wind(state, Wind(model="perlin", mean_speed_m_s=speed), 5.2)
    assert WindField(state).at(9.0).wind.mean_speed_m_s == 12.0
    later = change_wind(state, Wind(model="perlin", mean_speed_m_s=2.0), 5.9)
    assert later.next is None and later.before.mean_speed_m_s == pytest.approx(10.0, abs=0.5)
