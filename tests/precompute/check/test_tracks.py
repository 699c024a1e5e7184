"""Tracks of the comparison: the wind at the tree is the same as in the forest."""

from __future__ import annotations

import numpy as np
import pytest
from galewood.check.evaluation.tracks import Place, pressure_at
from galewood.motion.wind.evaluation import Wind, change_wind, steady
from galewood.table.format import decode

from tests.golden import GOLDEN_FOLDER

POLE = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())


@pytest.mark.parametrize("yaw_rad", [0.0, 2.1])
def test_a_steady_wind_is_turned_into_the_frame_of_the_tree(yaw_rad: float) -> None:
    wind = steady(Wind(mean_speed_m_s=4.0, direction_deg=30.0, gustiness=0.0))
    pressure = pressure_at(POLE, wind, Place(yaw_rad=yaw_rad), 10)
    heading = np.arctan2(pressure[:, 1], pressure[:, 0])
    # three.js rotates x towards −z, so that in the frame of the tree the heading is larger by the yaw.
    assert np.allclose(np.angle(np.exp(1j * (heading - np.radians(30.0) - yaw_rad))), 0.0, atol=1e-5)
    assert np.allclose(np.linalg.norm(pressure, axis=1), np.linalg.norm(pressure[0]))


def test_a_storm_is_limited_to_the_strongest_sampled_pressure() -> None:
    wind = steady(Wind(mean_speed_m_s=60.0, gustiness=0.0))
    assert POLE.peak_pressure_pa == pytest.approx(
        np.linalg.norm(POLE.records.pressure_pa.astype(np.float64), axis=1).max(), rel=1e-3
    )
    peak = POLE.peak_pressure_pa
    assert np.allclose(np.linalg.norm(pressure_at(POLE, wind, Place(), 5), axis=1), peak, rtol=1e-5)


def test_still_air_gives_no_pressure_and_a_later_start_shifts_the_wind() -> None:
    assert not pressure_at(POLE, steady(Wind(mean_speed_m_s=0.0)), Place(), 5).any()
    gusty = steady(Wind(gustiness=0.8))
    dt_s = float(POLE.metadata["dt_s"])
    whole, late = (
        pressure_at(POLE, gusty, Place(), 40),
        pressure_at(POLE, gusty, Place(start_s=10 * dt_s), 30),
    )
    assert np.allclose(whole[10:], late, atol=1e-4 * np.abs(whole).max())


def test_a_wind_in_transition_matches_the_forest() -> None:
    before, after = Wind(mean_speed_m_s=2.0, gustiness=0.0), Wind(mean_speed_m_s=4.0, gustiness=0.0)
    transition = pressure_at(POLE, change_wind(steady(before), after, 1.0), Place(), 90)
    assert np.allclose(transition[:14], pressure_at(POLE, steady(before), Place(), 14))
    assert np.allclose(transition[-20:], pressure_at(POLE, steady(after), Place(), 90)[-20:])
