"""Gusts within a crown: the field, the places that take them, the motion, and wind beyond the range."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from galewood.motion.wind import PRESETS, Wind, WindField, crown_carried, crown_field, write_gusts
from galewood.motion.wind.pressure import compress_pressure, compressed
from galewood.pipeline.reduction.places import PLACE_COUNT, most_telling, places_of
from galewood.pipeline.sampling import CrownGusts
from galewood.player import ModalForest, WindDrivenTrees, grid_placements
from galewood.solid.fem import Drag
from galewood.solid.skinning import joint_rows
from galewood.table import Table, decode

from tests.golden import GOLDEN_FOLDER
from tests.golden.beam import Beam
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


def test_gusts_that_are_the_same_at_all_places_are_a_stronger_wind() -> None:
    """Without the polynomial force: its terms are limited by the pressure at the tree."""
    table = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    linear = replace(table.modal, force=0 * table.modal.force)
    # the weights of the places are estimates, so that they do not add up to 1
    share = linear.drag_place.sum(axis=1, keepdims=True)
    load = linear.place_load / linear.place_load.sum(axis=2, keepdims=True)
    exact = replace(linear, drag_place=linear.drag_place / share, place_load=load * linear.load[:, :, None])
    one, other = (ModalForest(exact, 1 / 15, table.mode_scale, 1) for _ in range(2))
    along, across = 0.4, -0.3
    gusts = np.tile([along, across], (1, len(exact.place)))
    for x, z in ((5.0, 2.0), (9.0, -4.0), (0.0, 0.0)):
        for _ in range(40):
            one.advance(1 / 15, [x], [z], gusts)
            other.advance(1 / 15, [x + along * x - across * z], [z + along * z + across * x])
            assert np.allclose(one.q, other.q, rtol=1e-4, atol=1e-7)
    assert np.abs(one.q).max() > 1e-3


def test_no_gusts_are_gusts_of_zero() -> None:
    table = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    one, other = (ModalForest(table.modal, 1 / 15, table.mode_scale, 3) for _ in range(2))
    still = np.zeros((3, 2 * len(table.modal_place)))
    for k in range(60):
        wind = (np.array([3.0, 9.0, 0.0]) * np.sin(k / 5), np.array([1.0, -4.0, 0.0]))
        one.advance(1 / 15, *wind)
        other.advance(1 / 15, *wind, still)
    assert np.abs(one.q[:2]).max() > 1e-3 and np.array_equal(one.q, other.q)


def test_the_places_estimate_the_gusts_at_the_nodes() -> None:
    """Better than the nearest place, and exactly where a node is a place."""
    seed = 9
    rng = np.random.default_rng(seed)
    print("seed", seed)
    node_m = rng.uniform((-3, 2, -3), (3, 9, 3), (300, 3))
    shapes, omega = rng.normal(size=(30, 900)), np.linspace(2.0, 9.0, 30)
    places = places_of(rng.uniform(0.5, 1.5, 300), node_m, shapes, omega)
    assert places.count == PLACE_COUNT
    gap = np.square(node_m[:, None] - places.place_m[None]).sum(axis=2)
    nearest = np.argmin(gap, axis=1)
    errors, nearest_errors = [], []
    for k in range(40):
        x_m, z_m, heading_rad = rng.uniform(0, (48.0, 48.0, 6.0)).tolist()
        gusts = CrownGusts(900 + k, x_m, z_m, heading_rad, 0.0, 0.01, 1.3)
        wind = np.array([[np.cos(gusts.heading_rad), np.sin(gusts.heading_rad)]])
        exact = gusts.local_pa(node_m, wind, 1 / 30)[0]
        at = gusts.local_pa(places.place_m, wind, 1 / 30)[0]
        errors.append(at @ places.weight.T - exact)
        nearest_errors.append(at[:, nearest] - exact)
    assert np.square(errors).mean() < 0.8 * np.square(nearest_errors).mean()
    alone = places_of(np.ones(4), 5.0 * node_m[:4], shapes[:, :12], omega)
    order = np.argmin(np.square(alone.place_m[:, None] - 5.0 * node_m[None, :4]).sum(axis=2), axis=1)
    assert np.allclose(alone.weight[order], np.eye(4), atol=0.1)


def test_no_exchange_of_one_place_tells_more_of_the_forces() -> None:
    """Against least squares with every exchange, on gusts of which the greedy choice is not the best one."""
    seed = 31
    rng = np.random.default_rng(seed)
    print("seed", seed)
    gusts = rng.normal(size=(80, 6)) @ rng.normal(size=(6, 14)) + 0.2 * rng.normal(size=(80, 14))
    forces = gusts @ rng.normal(size=(14, 5))

    def unexplained(chosen: list[int]) -> float:
        of = gusts[:, chosen]
        return float(np.square(forces - of @ np.linalg.lstsq(of, forces, rcond=None)[0]).sum())

    chosen = most_telling(gusts.astype(np.float32), forces.astype(np.float32), 4)
    assert len(set(chosen)) == 4
    others = sorted(set(range(14)) - set(chosen))
    exchanges = [[*chosen[:k], other, *chosen[k + 1 :]] for k in range(4) for other in others]
    assert unexplained(chosen) < 1.0001 * min(map(unexplained, exchanges))
    greedy: list[int] = []
    for _ in range(4):
        greedy.append(min(set(range(14)) - set(greedy), key=lambda one: unexplained([*greedy, one])))
    assert unexplained(chosen) < 0.95 * unexplained(greedy)


def test_a_narrow_crown_has_few_places_and_none_twice() -> None:
    """Once two or three know all the others, exchanges must not fill up with copies."""
    rng = np.random.default_rng(12)
    for width_m in (0.01, 0.5, 1.0, 2.0, 3.0):
        node_m = rng.uniform((-width_m, 5, -width_m), (width_m, 5 + width_m, width_m), (200, 3))
        shapes, omega = rng.normal(size=(30, 600)), np.linspace(2.0, 9.0, 30)
        places = places_of(np.ones(200), node_m, shapes, omega)
        assert 1 <= places.count == len(np.unique(places.place_m, axis=0)) <= PLACE_COUNT
        assert np.isfinite(places.weight).all()


def test_a_run_has_the_gusts_of_a_tree_in_a_forest() -> None:
    table = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    place_m = np.asarray(table.modal_place, np.float64)
    heading, speed_m_s, dt_s = 0.6, 7.0, 1 / 30
    c, s = np.cos(heading), np.sin(heading)
    wind = np.outer(np.linspace(1.0, 30.0, 20), (c, s))
    found = CrownGusts(5, 11.0, -3.0, heading, speed_m_s, 0.4, 1.64).relative(place_m, wind, dt_s)
    for frame, (x, z) in enumerate(wind):
        out = np.zeros((1, 2 * len(place_m)))
        carried = (c, s, speed_m_s * frame * dt_s, 0.4)
        push = (ONE * x, ONE * z)
        write_gusts(crown_field(5), carried, place_m, (11.0 * ONE, -3.0 * ONE), AHEAD, ONE, push, 1.64, out)
        assert np.allclose(found[frame], out[0], atol=1e-9)


def test_the_drag_of_equal_pressures_at_all_nodes_is_that_of_one_pressure() -> None:
    beam = Beam()
    velocity = np.random.default_rng(2).normal(size=(beam.n, 3))
    pressure = np.array([12.0, -7.0])
    one = Drag(beam.area_m2, 2 * beam.area_m2, None, 1.3).at(velocity, pressure)
    force, damping = one.force_n.copy(), one.damping.copy()
    each = Drag(beam.area_m2, 2 * beam.area_m2, None, 1.3).at(velocity, np.tile(pressure, (beam.n, 1)))
    assert np.array_equal(force, each.force_n) and np.array_equal(damping, each.damping)


def test_the_model_follows_the_nonlinear_system_in_unseen_gusts() -> None:
    """A few of the six masses are places."""
    table = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    beam, modal = Beam(), table.modal
    assert 3 <= len(modal.place) <= beam.n
    heading, seed = 2.2, 4
    unseen = CrownGusts(seed, 7.0, 30.0, heading, 4.0, 0.4, Beam().streamlined_exponent)
    time_s = beam.dt_s * np.arange(300)
    along = 10.0 + 4.0 * np.sin(1.3 * time_s) + 3.0 * np.sin(2.9 * time_s)
    wind = along[:, None] * [np.cos(heading), np.sin(heading)]
    forest = ModalForest(modal, beam.dt_s, table.mode_scale, 1)
    gusts = unseen.relative(np.asarray(modal.place, np.float64), wind, beam.dt_s)
    local = unseen.local_pa(beam.rest_m, wind, beam.dt_s)
    basis = points_basis(table, beam)
    errors, sizes, last = [], [], np.zeros((beam.n, 3))
    for frame, (x, z) in enumerate(wind):
        forest.advance(beam.dt_s, [x], [z], gusts[frame : frame + 1])
        errors.append(basis @ forest.q[0].astype(np.float64) - last)
        beam.step(wind[frame] + local[frame].T)
        last = beam.u.copy()
        sizes.append(last)
    error, sway = np.array(errors)[60:], np.array(sizes)[60:]
    size = np.sqrt(np.square(sway - sway.mean(axis=0)).mean())
    print("error", np.sqrt(np.square(error).mean()) / size)
    assert size > 1e-3 and np.sqrt(np.square(error).mean()) < 0.1 * size


def points_basis(table: Table, beam: Beam) -> np.ndarray:
    """(n, 3, r) displacement of the masses per unit of q: each is the joint of its own render vertices."""
    rows = joint_rows(table, table.node_basis).astype(np.float64)
    return rows[table.vertex_joint[: 2 * beam.n : 2].astype(np.int64)]


def test_pressure_beyond_the_range_grows_with_the_wind() -> None:
    ratios = np.arange(0.0, 30.0, 0.01)
    found = np.array([compressed(ratio) for ratio in ratios])
    assert np.array_equal(found[ratios <= 1], ratios[ratios <= 1]) and (np.diff(found) > 0).all()
    x, z, felt = np.array([6.0, 30.0, 60.0]), np.array([8.0, 40.0, 80.0]), np.zeros(3)
    compress_pressure(x, z, np.array([20.0, 50.0, 50.0]), np.full(3, 25.0), felt)
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
    assert len(table.modal_place) >= 3
    presets = [sway_m(table, PRESETS[preset]) for preset in ("breeze", "autumn-gusts", "storm-front")]
    speeds = [
        sway_m(table, replace(PRESETS["autumn-gusts"], mean_speed_m_s=speed)) for speed in (7.0, 18.0, 40.0)
    ]
    print(name, "presets", presets, "7, 18, 40 m/s", speeds)
    assert presets == sorted(presets) and speeds == sorted(speeds)
