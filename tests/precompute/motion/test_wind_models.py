"""Wind documents, transitions, pressure and arithmetic against exact values and other libraries."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from galewood.check.bench.wind import bench_wind
from galewood.constants import PAPER_WAVES, PERLIN_NOISE_VARIANCE, TRANSITION_S, WIND_MODELS
from galewood.motion.wind import transition as transition
from galewood.motion.wind.document import FIELDS, Field
from galewood.motion.wind.evaluation import (
    PRESETS,
    Wave,
    Wind,
    WindError,
    WindField,
    coverage,
    dynamic_pressure,
    height_factor,
    limit_pressure,
    paper_wind,
    parse_state,
    parse_wind,
    parse_wind_or_state,
    to_tree_frame,
    wind_pressure,
    wind_speed,
)
from galewood.motion.wind.models.cosine import cos_turns
from galewood.motion.wind.models.fourier import roots_of_unity, transform_columns, transform_rows
from galewood.motion.wind.models.perlin import SLOPES, noise, permutation
from galewood.motion.wind.pressure import pressure_per_speed, speed_of_pressure
from galewood.motion.wind.recording import EMPTY_RECORDING
from galewood.motion.wind.schema import wind_schema

from tests.golden import GOLDEN_FOLDER, make_wind

ROOT = Path(__file__).parents[3]
GOLDEN: dict[str, Any] = json.loads((GOLDEN_FOLDER / "wind_models.json").read_text())
X, Z = np.linspace(-200.0, 200.0, 41), np.linspace(150.0, -150.0, 41)


def velocity(field: WindField, time_s: float) -> np.ndarray:
    out = np.zeros((2, len(X)))
    field.velocity(X, Z, time_s, out[0], out[1])
    return out


@pytest.mark.parametrize(
    ("values", "path"),
    [
        ({"mean_speed_m_s": -3.0}, "wind.mean_speed_m_s"),
        ({"mean_speed_m_s": math.nan}, "wind.mean_speed_m_s"),
        ({"mean_speed_m_s": "8"}, "wind.mean_speed_m_s"),
        ({"gustiness": 9.0}, "wind.gustiness"),
        ({"seed": 1.5}, "wind.seed"),
        ({"model": "typo"}, "wind.model"),
        ({"model": "perlin", "length_scale_m": math.inf}, "wind.length_scale_m"),
        ({"waves": ()}, "wind.waves"),
    ],
)
def test_a_wind_made_in_a_program_is_checked_as_a_document_is(values: dict[str, Any], path: str) -> None:
    with pytest.raises(WindError) as error:
        Wind(**values)
    assert error.value.path == path


def test_numbers_of_numpy_are_accepted() -> None:
    wind = Wind(mean_speed_m_s=cast(Any, np.float32(9.5)), seed=cast(Any, np.int64(7)))
    assert (wind.mean_speed_m_s, type(wind.mean_speed_m_s), type(wind.seed)) == (9.5, float, int)
    assert parse_wind(json.loads(json.dumps(wind.document()))) == wind


@pytest.mark.parametrize("k", range(len(make_wind.WINDS)))
def test_golden_velocities_over_ten_thousand_frames(k: int) -> None:
    times = [frame * GOLDEN["frame_s"] for frame in GOLDEN["frames"]]
    found = make_wind.velocities(WindField(parse_wind(GOLDEN["models"][k]["wind"])), times)
    np.testing.assert_allclose(found, GOLDEN["models"][k]["velocity_m_s"], rtol=1e-9, atol=1e-12)


def test_golden_transitions_and_eddies() -> None:
    np.testing.assert_allclose(
        make_wind.changed()["velocity_m_s"], GOLDEN["changed"]["velocity_m_s"], rtol=1e-9, atol=1e-9
    )
    assert make_wind.eddies() == GOLDEN["eddies"]


def test_golden_errors_and_schema_are_current() -> None:
    assert make_wind.refusals() == GOLDEN["refused"]
    assert wind_schema() == json.loads(make_wind.SCHEMA.read_text())


@pytest.mark.parametrize("wind", [*make_wind.WINDS, *PRESETS.values(), Wind()])
def test_documents_survive_a_round_trip(wind: Wind) -> None:
    assert parse_wind(json.loads(json.dumps(wind.document()))) == wind


@pytest.mark.parametrize("model", WIND_MODELS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, "8", None, True, [], 1e300])
def test_every_number_is_validated_by_name(model: str, value: object) -> None:
    for name, rule in FIELDS.items():
        if model in rule.models:
            with pytest.raises(WindError) as error:
                parse_wind({**Wind(model=model).document(), name: value})
            assert error.value.path == f"wind.{name}"
            assert f"{rule.low:.10g}..{rule.high:.10g}" in error.value.expected


def test_range_limits_are_inclusive() -> None:
    for model in WIND_MODELS:
        own: dict[str, Field] = {name: rule for name, rule in FIELDS.items() if model in rule.models}
        for end in ("low", "high"):
            numbers = {name: getattr(rule, end) for name, rule in own.items()}
            lists = {"recording": EMPTY_RECORDING.document()} if model == "recorded" else {}
            parse_wind({"version": 1, "model": model, **numbers, **lists})


def test_states_are_validated() -> None:
    state = transition.change_wind(transition.steady(Wind()), Wind(model="perlin"), 3.0)
    assert parse_state(json.loads(json.dumps(state.document()))) == state
    for bad in (None, {}, {**state.document(), "travel": math.nan}, {**state.document(), "wind": 3}):
        with pytest.raises(WindError):
            parse_state(bad)


def test_transform_agrees_with_numpy() -> None:
    rng = np.random.default_rng(4)
    wave = rng.normal(size=(16, 64)) + 1j * rng.normal(size=(16, 64))
    re, im = wave.real.ravel().copy(), wave.imag.ravel().copy()
    x, y = roots_of_unity(64), roots_of_unity(16)
    transform_rows(re, im, 64, 16, x.cosine, x.sine, -1.0)
    transform_columns(re, im, 64, 16, y.cosine, y.sine, -1.0)
    np.testing.assert_allclose((re + 1j * im).reshape(16, 64), np.fft.fft2(wave), atol=1e-12)


def test_fast_cosine_is_accurate() -> None:
    turns = np.random.default_rng(5).uniform(-50.0, 50.0, 5000)
    found = [cos_turns(t) for t in turns]
    np.testing.assert_allclose(found, np.cos(2.0 * np.pi * (turns - np.round(turns))), atol=1e-15)


def test_noise_is_zero_and_smooth_at_lattice_points() -> None:
    order = permutation(9)
    assert sorted(order[:256]) == list(range(256))
    assert noise(order, SLOPES, 3.0, -7.0, 11.0) == 0.0
    step = 1e-5
    before, after = (noise(order, SLOPES, 3.0 + s, 0.4, 0.6) for s in (-step, step))
    at = noise(order, SLOPES, 3.0, 0.4, 0.6)
    assert after - at == pytest.approx(at - before, abs=1e-8)


def test_noise_variance_equals_its_integral() -> None:
    fade = {0: 1, 3: -10, 4: 15, 5: -6}
    square: dict[int, int] = {}
    for i, a in fade.items():
        for j, b in fade.items():
            square[i + j] = square.get(i + j, 0) + a * b
    plain = sum(Fraction(a, n + 1) for n, a in square.items())
    weighted = sum(Fraction(a, n + 3) for n, a in square.items())
    assert float(16 * plain * plain * weighted) == PERLIN_NOISE_VARIANCE


@pytest.mark.parametrize("model", WIND_MODELS)
def test_still_air_has_zero_pressure(model: str) -> None:
    out = np.ones((2, len(X)), np.float32)
    wind_pressure(Wind(mean_speed_m_s=0.0, model=model), X, Z, 77.0, out[0], out[1], 1.3)
    assert not out.any()


def test_pressure_is_the_dynamic_pressure_along_the_heading() -> None:
    wind = Wind(14.0, 200.0, 0.8, model="spectral")
    speed, heading = wind_speed(wind, X, Z, 9.0)
    out = np.zeros((2, len(X)))
    wind_pressure(wind, X, Z, 9.0, out[0], out[1], 1.64)
    pressure = dynamic_pressure(speed, 1.64)
    np.testing.assert_allclose(out, [pressure * np.cos(heading), pressure * np.sin(heading)], rtol=1e-12)


@pytest.mark.parametrize("exponent", [1.3, 1.64, 2.0])
def test_the_pressure_is_a_parabola_up_to_5_m_s_and_a_power_above(exponent: float) -> None:
    slow, fast = np.linspace(0.0, 5.0, 21), np.linspace(5.0, 60.0, 23)
    np.testing.assert_allclose(dynamic_pressure(slow, exponent), 0.6 * slow**2, rtol=1e-14)
    np.testing.assert_allclose(dynamic_pressure(fast, exponent), 15.0 * (fast / 5.0) ** exponent, rtol=1e-14)
    below, above = dynamic_pressure([5.0 - 1e-9, 5.0 + 1e-9], exponent)
    assert below == pytest.approx(15.0, abs=1e-7) and above == pytest.approx(15.0, abs=1e-7)
    for speed_m_s in [*slow, *fast]:
        pressure_pa = float(dynamic_pressure(speed_m_s, exponent))
        assert speed_of_pressure(pressure_pa, exponent) == pytest.approx(speed_m_s, rel=1e-12)
        per_speed, growth = pressure_per_speed(speed_m_s, exponent)
        assert per_speed * speed_m_s == pytest.approx(pressure_pa, rel=1e-12)
        assert growth == (2.0 if speed_m_s <= 5.0 else exponent)


def test_the_exponent_2_is_one_parabola() -> None:
    speed = np.linspace(0.0, 80.0, 161)
    np.testing.assert_allclose(dynamic_pressure(speed, 2.0), 0.6 * speed**2, rtol=1e-14)
    # a bare tree in a gale of 30 m/s: 3.5 times the load by the exponent 1.3
    assert dynamic_pressure(30.0, 2.0) / dynamic_pressure(30.0, 1.3) == pytest.approx(6.0**0.7)


def test_height_factor_tree_frame_and_coverage() -> None:
    assert height_factor(12.0, 0.2, 12.0) == 1.0
    assert height_factor(24.0, 0.2, 12.0) == pytest.approx(2.0**0.2)
    east, south = to_tree_frame(np.array([1.0]), np.array([0.0]), math.pi / 2)
    assert (east[0], south[0]) == pytest.approx((0.0, 1.0))
    assert coverage(np.array([3.0, 5.1, 0.0, 0.0]), np.array([4.0, 0.0, 5.1, 0.0]), 5.0) == 0.5


def test_paper_winds_are_single_cosines_of_constant_direction() -> None:
    for k, (peak, depth, period_s, turns) in enumerate(PAPER_WAVES):
        for time_s in np.linspace(0.0, 12.0, 25):
            wave = (1.0 + depth * math.cos(2.0 * math.pi * (time_s / period_s + turns))) / (1.0 + depth)
            speed, heading = wind_speed(paper_wind(k, 12.0), [0.0], [0.0], time_s)
            assert speed[0] == pytest.approx(12.0 * peak * wave, rel=1e-9)
            assert heading[0] == pytest.approx(math.radians(60.0), abs=1e-9)


DRAGS: list[tuple[str, float, float]] = [
    ("mean_speed_m_s", 8.0, 9.0),
    ("direction_deg", 179.0, -175.0),
    ("gustiness", 0.5, 0.6),
    ("convection_speed_m_s", 8.0, 12.0),
    ("length_scale_m", 20.0, 24.0),
]


@pytest.mark.parametrize("model", WIND_MODELS)
@pytest.mark.parametrize(("name", "start", "end"), DRAGS)
def test_dragging_a_slider_causes_no_jumps_even_after_an_hour(
    model: str, name: str, start: float, end: float
) -> None:
    wind = replace(Wind(model=model), **{name: start})
    field, now = WindField(wind), 3600.0
    last, worst = velocity(field, now), 0.0
    for k in range(1, 241):  # dragged back and forth for a second, sampled every 5 ms
        now += 0.005
        way = (end - start + (-360.0 if name == "direction_deg" and end < start else 0.0)) % 360.0
        goal = start + way * 0.5 * (1.0 - math.cos(k / 20.0))
        if k <= 200 and k % 3 == 0:
            field.change(replace(wind, **{name: (goal + 180.0) % 360.0 - 180.0}), now)
        new = velocity(field, now)
        worst = max(worst, float(np.abs(new - last).max()))
        last = new
    assert worst < 0.4, f"{model} {name}: {worst:.3f} m/s in 5 ms"


def test_change_of_model_is_continuous() -> None:
    field = WindField(Wind(model="perlin"))
    last, worst = velocity(field, 50.0), 0.0
    field.change(Wind(model="spectral", beta=1.0, seed=9), 50.0)
    for k in range(1, 200):
        new = velocity(field, 50.0 + 0.005 * k)
        worst, last = max(worst, float(np.abs(new - last).max())), new
    assert worst < 0.12
    np.testing.assert_allclose(last, velocity(WindField(field.state), 50.0 + 0.005 * 199), rtol=1e-12)


def test_travel_is_the_integral_of_the_changing_rate() -> None:
    state = transition.steady(Wind(model="perlin", convection_speed_m_s=8.0))
    state = transition.change_wind(state, Wind(model="perlin", convection_speed_m_s=3.0), 10.0)
    share = [min(max((t - 10.0) / TRANSITION_S, 0.0), 1.0) for t in np.arange(0.0005, 12.0, 0.001)]
    rate = [8.0 / 20.0 + (3.0 - 8.0) / 20.0 * s * s * (3.0 - 2.0 * s) for s in share]
    assert transition.at(state, 12.0).travel == pytest.approx(sum(rate) * 0.001, rel=1e-6)


def test_fields_with_the_same_state_agree() -> None:
    field = WindField(Wind(model="navier-stokes"))
    velocity(field, 30.0)
    field.change(Wind(model="navier-stokes", direction_deg=90.0, mean_speed_m_s=12.0), 31.0)
    late = WindField(parse_state(json.loads(json.dumps(field.state.document()))))
    np.testing.assert_array_equal(velocity(field, 31.3), velocity(late, 31.3))
    np.testing.assert_array_equal(velocity(field, 700.0), velocity(late, 700.0))


def test_eddies_can_go_back_in_time() -> None:
    field = WindField(Wind(model="navier-stokes"))
    before = velocity(field, 3.0)
    velocity(field, 90.0)
    np.testing.assert_array_equal(velocity(field, 3.0), before)


def test_single_wave_is_a_cosine() -> None:
    wind = Wind(10.0, 0.0, 0.5, 5.0, heading_swing_deg=0.0, waves=(Wave(0.25, 1.0, 0.0, 0.1),))
    speed, _ = wind_speed(wind, [0.0, 20.0], [0.0, 0.0], 1.7)
    assert speed[0] == pytest.approx(10.0 * (1.0 + 0.5 * math.cos(2.0 * math.pi * (0.25 * 1.7 + 0.1))))
    assert speed[1] == pytest.approx(speed[0]), "20 m at 5 m/s are a whole period"


def test_benchmark_covers_every_model() -> None:
    figures = bench_wind(trees=50, frames=3)
    assert set(figures) == {"trees", *WIND_MODELS}


def test_groups_of_trees_can_be_evaluated_separately() -> None:
    field = WindField(Wind(model="perlin", direction_deg=20.0))
    whole, parts = np.zeros((2, 41)), np.zeros((2, 41))
    field.pressure(X, Z, 4.0, whole[0], whole[1], 1.3)
    for part in (slice(0, 11), slice(11, 41)):
        field.pressure(X[part], Z[part], 4.0, parts[0, part], parts[1, part], 1.3)
    np.testing.assert_array_equal(whole, parts)


def test_a_document_or_a_state_is_accepted() -> None:
    state = transition.change_wind(transition.steady(Wind()), Wind(model="perlin"), 3.0)
    assert parse_wind_or_state(state.document()) == state
    assert parse_wind_or_state(Wind().document()) == transition.steady(Wind())
    with pytest.raises(WindError, match=r"wind\.model"):
        parse_wind_or_state({"version": 1})


def test_limited_pressures_keep_their_direction() -> None:
    x, z = np.array([3.0, 30.0, 0.0], np.float32), np.array([4.0, -40.0, 0.0], np.float32)
    limit_pressure(x, z, 10.0)
    np.testing.assert_allclose(np.stack([x, z]), [[3.0, 6.0, 0.0], [4.0, -8.0, 0.0]], rtol=1e-6)


def test_states_in_transition_are_always_valid() -> None:
    rng = np.random.default_rng(8)
    state = transition.steady(Wind(model="spectral"))
    for k in range(300):
        wild = {
            name: float(rng.choice([rule.low, rule.high, rng.uniform(rule.low, rule.high)]))
            for name, rule in FIELDS.items()
            if "spectral" in rule.models and not rule.whole
        }
        state = transition.change_wind(
            state, Wind(model="spectral", seed=int(rng.integers(3)), **cast(Any, wild)), 0.17 * k
        )
        assert parse_state(json.loads(json.dumps(state.document()))) == state
