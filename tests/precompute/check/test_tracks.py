"""Tracks of the comparison: the wind at the tree is the same as in the forest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from galewood.check.evaluation.gusts import strongest_pa
from galewood.check.evaluation.tracks import pressures_at
from galewood.motion.wind.evaluation import Wind, change_wind, dynamic_pressure, height_factor, steady
from galewood.motion.wind.pressure import compressed
from galewood.motion.wind.transition import WindState
from galewood.solid.fem import FemSettings, Place
from galewood.table.format import decode
from galewood.util import Floats

from tests.golden import GOLDEN_FOLDER
from tests.precompute.solid.fem.test_node_wind import points

POLE = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
NODES = replace(points(np.zeros((1, 3))), settings=FemSettings(dt_s=float(POLE.metadata["dt_s"])))


def pressure_at(wind: WindState, place: Place, frames: int) -> Floats:
    """(frames, 2) Pa at the pole, in its own frame."""
    return np.array([one.tree_pa for one in pressures_at(POLE, NODES, wind, place, frames)])


@pytest.mark.parametrize("yaw_rad", [0.0, 2.1])
def test_a_steady_wind_is_turned_into_the_frame_of_the_tree(yaw_rad: float) -> None:
    wind = steady(Wind(mean_speed_m_s=4.0, direction_deg=30.0, gustiness=0.0))
    pressure = pressure_at(wind, Place(yaw_rad=yaw_rad), 10)
    heading = np.arctan2(pressure[:, 1], pressure[:, 0])
    # three.js rotates x towards −z, so that in the frame of the tree the heading is larger by the yaw.
    assert np.allclose(np.angle(np.exp(1j * (heading - np.radians(30.0) - yaw_rad))), 0.0, atol=1e-5)
    assert np.allclose(np.linalg.norm(pressure, axis=1), np.linalg.norm(pressure[0]))


def test_a_storm_is_compressed_to_the_range_of_the_table() -> None:
    wind = Wind(mean_speed_m_s=60.0, gustiness=0.0)
    factor = height_factor(POLE.metadata["height_m"], wind.height_exponent, wind.reference_height_m)
    ratio = float(dynamic_pressure(60.0 * factor, POLE.streamlined_exponent)) / strongest_pa(POLE)
    assert ratio > 1
    found = np.linalg.norm(pressure_at(steady(wind), Place(), 5), axis=1)
    assert np.allclose(found, strongest_pa(POLE) * compressed(ratio), rtol=1e-6)


def test_still_air_gives_no_pressure_and_a_later_start_shifts_the_wind() -> None:
    assert not pressure_at(steady(Wind(mean_speed_m_s=0.0)), Place(), 5).any()
    gusty = steady(Wind(gustiness=0.8))
    dt_s = float(POLE.metadata["dt_s"])
    whole, late = (
        pressure_at(gusty, Place(), 40),
        pressure_at(gusty, Place(start_s=10 * dt_s), 30),
    )
    assert np.allclose(whole[10:], late, atol=1e-4 * np.abs(whole).max())


def test_a_wind_in_transition_matches_the_forest() -> None:
    before, after = Wind(mean_speed_m_s=2.0, gustiness=0.0), Wind(mean_speed_m_s=4.0, gustiness=0.0)
    transition = pressure_at(change_wind(steady(before), after, 1.0), Place(), 90)
    assert np.allclose(transition[:14], pressure_at(steady(before), Place(), 14))
    assert np.allclose(transition[-20:], pressure_at(steady(after), Place(), 90)[-20:])
