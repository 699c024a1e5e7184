"""Gusts within a crown: the field, the layer of oscillators that follows them, and wind beyond the range."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from galewood.motion.modal import advance_gusts
from galewood.motion.wind import PRESETS, Wind, WindField, crown_carried, crown_field, write_gusts
from galewood.motion.wind.pressure import compress_pressure, compressed
from galewood.pipeline.reduction import gust_modes
from galewood.pipeline.reduction.gust_layer import OSCILLATOR_COUNT
from galewood.player import WindDrivenTrees, grid_placements
from galewood.solid.fem import Drag
from galewood.table import Table, decode

from tests.golden import GOLDEN_FOLDER
from tests.golden.beam import Beam
from tests.golden.make import scheme
from tests.golden.make_gusts import gusts, motion

SHIPPED = Path(__file__).parents[3] / "assets" / "species" / "shipped"
NAMES = sorted(path.stem for path in SHIPPED.glob("*.table") if "." not in path.stem)
ONE, NOTHING, AHEAD = np.ones(1), np.zeros(1), np.array([[1.0, 0.0]])


def test_the_field_has_unit_variance_no_mean_and_no_divergence() -> None:
    field = crown_field(7)
    assert np.allclose(field.mean(axis=(0, 1)), 0.0, atol=1e-12)
    assert np.allclose(np.square(field).mean(axis=(0, 1)), 1.0)
    rows, columns = np.meshgrid(*(2 * np.pi * np.fft.fftfreq(len(field)),) * 2, indexing="ij")
    along, across = (np.fft.fft2(field[..., side]) for side in range(2))
    # each component was scaled on its own, by nearly the same factor
    divergence = columns * along + rows * across
    gradient = np.hypot(columns, rows) * np.hypot(np.abs(along), np.abs(across))
    assert np.sqrt(np.square(np.abs(divergence)).sum() / np.square(gradient).sum()) < 0.2


def test_the_gusts_are_carried_with_the_wind_and_reach_the_top_first() -> None:
    seed = 11
    rng = np.random.default_rng(seed)
    print("seed", seed)
    place = rng.uniform(-3, 3, (5, 3))
    heading, distance = 0.7, 123.0
    c, s = np.cos(heading), np.sin(heading)
    here, there, above = (np.zeros((1, 10)) for _ in range(3))
    field, push = crown_field(seed), (ONE * 9.0, NOTHING)
    write_gusts(field, (c, s, distance, 0.3), place, (ONE, ONE), AHEAD, ONE, push, 1.3, here)
    on = (ONE + 5 * c, ONE + 5 * s)
    write_gusts(field, (c, s, distance + 5.0, 0.3), place, on, AHEAD, ONE, push, 1.3, there)
    assert np.allclose(here, there)
    # 1 m higher the same gust was 0.6 m ago; across the wind the field is shifted by 0.8 m
    raised = place + np.array([0.0, 1.0, 0.0])
    beside = (ONE + 0.8 * s, ONE - 0.8 * c)
    write_gusts(field, (c, s, distance - 0.6, 0.3), raised, beside, AHEAD, ONE, push, 1.3, above)
    assert np.allclose(here, above)


def test_gusts_turn_and_grow_with_the_tree() -> None:
    place, field = np.array([[2.0, 3.0, -1.0]]), crown_field(3)
    carried = (1.0, 0.0, 40.0, 0.5)
    placed, whole = np.zeros((1, 2)), np.zeros((1, 2))
    yaw, size = 0.9, 1.4
    turn = np.array([[np.cos(yaw), np.sin(yaw)]])
    push = (ONE * 30.0, ONE * 4.0)
    write_gusts(field, carried, place, (ONE * 6, ONE * 2), turn, ONE * size, push, 1.3, placed)
    cos, sin = turn[0]
    world = size * np.array([[cos * 2.0 - sin, 3.0, -cos - sin * 2.0]]) + [[6.0, 0.0, 2.0]]
    write_gusts(field, carried, world, (NOTHING, NOTHING), AHEAD, ONE, push, 1.3, whole)
    assert np.allclose(placed, whole)


@pytest.mark.parametrize("model", ["cosine", "perlin"])
def test_cosine_winds_and_still_air_have_no_gusts(model: str) -> None:
    wind = Wind(mean_speed_m_s=8.0, gustiness=1.0, model=model, length_scale_m=20.0)
    out, place = np.ones((1, 4)), np.zeros((2, 3))
    for pressure in (0.0, 5.0):
        carried = crown_carried(WindField(wind).at(3.0))
        push = (ONE * pressure, NOTHING)
        write_gusts(crown_field(1), carried, place, (ONE, ONE), AHEAD, ONE, push, 1.3, out)
        assert bool(out.any()) == (model != "cosine" and pressure > 0)


def test_without_drag_the_layer_is_an_exact_linear_system() -> None:
    seed = 5
    rng = np.random.default_rng(seed)
    print("seed", seed)
    omega, zeta, dt_s = 6.0, 0.03, 1 / 30
    rate = np.array([[0.0, 1.0], [-omega * omega, -2 * zeta * omega]])
    from scipy.linalg import expm

    step = expm(dt_s * rate)
    gain = (step - np.eye(2)) @ np.linalg.inv(rate) @ np.array([0.0, 1.0])
    row = np.array([[step[0, 0] - 1, step[0, 1], step[1, 0], step[1, 1] - 1, *gain]])
    load = rng.normal(size=(1, 6))
    state, q = tuple(np.zeros((1, 1)) for _ in range(4)), np.zeros((1, 1), np.float32)
    e, v, _, _ = state
    exact = np.zeros(2)
    for _ in range(200):
        relative, push = rng.normal(size=(1, 6)), rng.uniform(1, 40, 2)
        pressure = (push[:1], push[1:])
        advance_gusts((row, load, NOTHING, 1.3), ONE, AHEAD, NOTHING, pressure, relative, state, q)
        a, b = relative[0, ::2], relative[0, 1::2]
        local = np.stack([a * push[0] - b * push[1], a * push[1] + b * push[0]], axis=1).ravel()
        exact = step @ exact + gain * float(load[0] @ local)
        assert np.allclose([e[0, 0], v[0, 0]], exact, rtol=1e-9, atol=1e-12)


def test_the_drag_of_equal_pressures_at_all_nodes_is_that_of_one_pressure() -> None:
    beam = Beam()
    velocity = np.random.default_rng(2).normal(size=(beam.n, 3))
    pressure = np.array([12.0, -7.0])
    one = Drag(beam.area_m2, 2 * beam.area_m2, None, 1.3).at(velocity, pressure)
    force, damping = one.force_n.copy(), one.damping.copy()
    each = Drag(beam.area_m2, 2 * beam.area_m2, None, 1.3).at(velocity, np.tile(pressure, (beam.n, 1)))
    assert np.array_equal(force, each.force_n) and np.array_equal(damping, each.damping)


def test_the_layer_follows_the_nonlinear_system_under_the_same_gusts() -> None:
    """Each mass of the pole is a place, so that the layer's gusts are those of the masses."""
    beam = Beam()
    layer = gust_modes(beam.oscillators(), scheme(beam))
    place = np.ascontiguousarray(layer.tensors.place, np.float64)
    tensors = (np.ascontiguousarray(t, np.float64) for t in (layer.tensors.step, layer.tensors.load))
    step, load = tensors
    drag = np.ascontiguousarray(layer.tensors.drag, np.float64)
    assert len(place) == beam.n and len(step) == OSCILLATOR_COUNT
    order = [int(np.argmin(np.abs(beam.rest_m[:, 1] - y))) for y in place[:, 1]]
    assert sorted(order) == list(range(beam.n))
    frames, mean, exponent = 300, np.array([8.0, 0.0]), beam.streamlined_exponent
    field, calm, gusty = crown_field(4), Beam(), Beam()
    state = tuple(np.zeros((1, len(step))) for _ in range(4))
    q, relative = np.zeros((1, len(step)), np.float32), np.zeros((1, 2 * beam.n))
    shapes = layer.shapes.reshape(len(step), -1, 3)
    errors, sizes = [], []
    for frame in range(frames):
        carried = (1.0, 0.0, 4.0 * frame * beam.dt_s, 0.15)
        push = (ONE * mean[0], NOTHING)
        write_gusts(field, carried, place, (NOTHING, NOTHING), AHEAD, ONE, push, exponent, relative)
        advance_gusts((step, load, drag, exponent), ONE, AHEAD, NOTHING, push, relative, state, q)
        local = np.zeros((beam.n, 2))
        local[order] = mean[0] * relative.reshape(-1, 2)
        calm.step(mean)
        gusty.step(mean + local)
        exact = gusty.u - calm.u
        errors.append(np.einsum("k,kni->ni", state[0][0], shapes) - exact)
        sizes.append(exact)
    error, size = (np.sqrt(np.mean(np.square(rows[60:]))) for rows in (errors, sizes))
    assert size > 1e-3 and error / size < 0.25


def test_pressure_beyond_the_range_grows_with_the_wind() -> None:
    ratios = np.arange(0.0, 30.0, 0.01)
    found = np.array([compressed(ratio) for ratio in ratios])
    assert np.array_equal(found[ratios <= 1], ratios[ratios <= 1]) and (np.diff(found) > 0).all()
    x, z, felt = np.array([6.0, 30.0, 60.0]), np.array([8.0, 40.0, 80.0]), np.zeros(3)
    compress_pressure(x, z, np.array([20.0, 50.0, 50.0]), 25.0, felt)
    assert np.allclose(felt, [0.4, 2.0, 4.0])
    expected = [10.0, 25.0 * compressed(2.0), 25.0 * compressed(2.0) * compressed(2.0)]
    assert np.allclose(np.hypot(x, z), expected) and np.allclose(z / x, 4 / 3)


def test_trees_in_a_changing_wind_move_as_in_the_golden_file() -> None:
    table = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    golden = json.loads((GOLDEN_FOLDER / "gusts.json").read_text())
    assert np.allclose(gusts(table), golden["gusts"], atol=1e-9)
    assert np.allclose(motion(table), golden["poses"], atol=1e-4)


def sway_m(table: Table, wind: Wind, seconds: float = 40.0) -> float:
    """Root mean square displacement of the tops of some trees about their lean, m."""
    x, z, yaw, _ = grid_placements(12, seed=4)
    trees = WindDrivenTrees(table, np.column_stack([x, z, yaw, np.ones(12)]))
    dt_s, field = float(table.metadata["dt_s"]), WindField(wind)
    top = table.node_basis[int(np.argmax(table.node_rest_m[:, 1]))]
    track: list[np.ndarray] = []
    for frame in range(round(seconds / dt_s)):
        trees.step(field, frame * dt_s, dt_s)
        track.append(trees.q @ top.T)
    settled = np.array(track)[round(8 / dt_s) :]
    return float(np.sqrt(np.square(settled - settled.mean(axis=0)).sum(axis=2).mean()))


@pytest.mark.parametrize("name", NAMES)
def test_stronger_wind_moves_every_shipped_tree_more(name: str) -> None:
    table = decode((SHIPPED / f"{name}.table").read_bytes())
    assert len(table.gust_place) >= 3
    presets = [sway_m(table, PRESETS[preset]) for preset in ("breeze", "autumn-gusts", "storm-front")]
    speeds = [
        sway_m(table, replace(PRESETS["autumn-gusts"], mean_speed_m_s=speed)) for speed in (7.0, 18.0, 40.0)
    ]
    print(name, "presets", presets, "7, 18, 40 m/s", speeds)
    assert presets == sorted(presets) and speeds == sorted(speeds)
