"""The wind at the nodes of a model is that of a forest: pressure at the tree, and gusts within its crown."""

from __future__ import annotations

import numpy as np
import pytest
from galewood.motion.wind import (
    PRESETS,
    Wind,
    WindField,
    crown_carried,
    crown_field,
    dynamic_pressure,
    height_factor,
    write_gusts,
)
from galewood.motion.wind.pressure import compressed
from galewood.motion.wind.transition import WindState, steady
from galewood.solid.fem import FemModel, FemSettings, Place, node_pressures
from galewood.util import Floats

HEIGHT_M, EXPONENT = 9.0, 1.64
GUSTY = Wind(mean_speed_m_s=8.0, direction_deg=70.0, gustiness=0.8, model="spectral", length_scale_m=24.0)
PLACE = Place(x_m=13.0, z_m=-40.0, yaw_rad=2.2, start_s=31.0)


def points(nodes_m: Floats) -> FemModel:
    """A model of which only the nodes and the time step matter."""
    none, count = np.zeros(0), len(nodes_m)
    return FemModel(
        nodes_m=nodes_m, elements=np.zeros((0, 4), np.int32), grad=none, blocks=none, mass_kg=np.ones(count),
        drag_area_m2=np.ones(count), fixed=np.zeros(0, np.int32), gravity_n=np.zeros((count, 3)),
        prestress=none, streamlined_exponent=EXPONENT, vertex_count=count, alpha=0.0, beta=0.0,
        settings=FemSettings(), report={},
    )  # fmt: skip


def nodes(seed: int = 710) -> Floats:
    """Random nodes of a crown, m."""
    print("seed", seed)
    return np.random.default_rng(seed).uniform([-4, 0, -4], [4, HEIGHT_M, 4], (12, 3))


def winds(
    model: FemModel, wind: Wind, place: Place = PLACE, frames: int = 20, most_pa: float = np.inf
) -> Floats:
    """(frames, N + 1, 2) pressures at the nodes and, last, at the tree."""
    found = node_pressures(model, steady(wind), place, frames, height_m=HEIGHT_M, most_pa=most_pa)
    return np.array([np.vstack([one.node_pa, one.tree_pa]) for one in found])


def test_each_node_feels_the_gust_of_its_place_in_the_world() -> None:
    model = points(nodes())
    found, field = winds(model, GUSTY), WindField(GUSTY)
    cos, sin = np.cos(PLACE.yaw_rad), np.sin(PLACE.yaw_rad)
    for frame in (0, 7, 19):
        time_s = PLACE.start_s + (frame + 1) * model.settings.dt_s
        tree = np.zeros((2, 1))
        factor = height_factor(np.array([HEIGHT_M]), GUSTY.height_exponent, GUSTY.reference_height_m)
        field.pressure([PLACE.x_m], [PLACE.z_m], time_s, tree[0], tree[1], EXPONENT, factor)
        for node, rest_m in enumerate(model.nodes_m):
            x, y, z = rest_m
            world_m = np.array([[PLACE.x_m + cos * x + sin * z, y, PLACE.z_m + cos * z - sin * x]])
            gust, still = np.zeros((1, 2)), ((np.zeros(1), np.zeros(1)), np.array([[1.0, 0.0]]), np.ones(1))
            moment = field.at(time_s)
            write_gusts(
                crown_field(moment.crown.seed),
                crown_carried(moment),
                world_m,
                *still,
                (tree[0], tree[1]),
                EXPONENT,
                gust,
            )
            along, across = gust[0]
            (px,), (pz,) = tree
            world = np.array([px + along * px - across * pz, pz + along * pz + across * px])
            # three.js rotates x towards −z: the tree's frame is turned back
            own = [cos * world[0] - sin * world[1], sin * world[0] + cos * world[1]]
            assert np.allclose(found[frame, node], own, rtol=1e-9)


def test_the_pressure_grows_and_turns_with_the_gusts_about_that_at_the_tree() -> None:
    found = winds(points(nodes()), GUSTY, frames=400)
    gusts = found[:, :-1] - found[:, -1:]
    assert np.abs(gusts).max() > 0.2 * np.linalg.norm(found[:, -1], axis=1).mean()
    assert np.abs(gusts.mean()) < 0.1 * np.abs(gusts).max()


@pytest.mark.parametrize("wind", [Wind(mean_speed_m_s=8.0, gustiness=0.8), Wind(mean_speed_m_s=0.0)])
def test_a_cosine_wind_and_still_air_are_the_same_at_all_nodes(wind: Wind) -> None:
    found = winds(points(nodes()), wind)
    assert np.array_equal(found[:, :-1], np.broadcast_to(found[:, -1:], found[:, :-1].shape))


def test_a_wind_beyond_the_range_is_compressed_as_a_whole() -> None:
    model, storm = (
        points(nodes()),
        Wind(mean_speed_m_s=30.0, gustiness=0.5, model="spectral", length_scale_m=24.0),
    )
    factor = height_factor(np.array([HEIGHT_M]), storm.height_exponent, storm.reference_height_m)
    peak_pa = float(dynamic_pressure(45.0 * factor, EXPONENT)[0])
    most_pa = 0.4 * peak_pa
    plain, squeezed = winds(model, storm), winds(model, storm, most_pa=most_pa)
    below = np.linalg.norm(plain[:, -1], axis=1) <= peak_pa
    assert below.any()
    assert np.allclose(squeezed[below], plain[below] * compressed(2.5) / 2.5)


def test_a_later_start_shifts_the_wind_and_a_transition_changes_it() -> None:
    model = points(nodes())
    later = Place(PLACE.x_m, PLACE.z_m, PLACE.yaw_rad, PLACE.start_s + 5 * model.settings.dt_s)
    assert np.allclose(winds(model, GUSTY)[5:], winds(model, GUSTY, later, frames=15))
    changing = WindState(PRESETS["breeze"], GUSTY, since_s=PLACE.start_s)
    found = [
        one.tree_pa for one in node_pressures(model, changing, PLACE, 200, height_m=HEIGHT_M, most_pa=np.inf)
    ]
    assert np.linalg.norm(found[-1]) > np.linalg.norm(found[0])
