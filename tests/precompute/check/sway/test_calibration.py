"""Wood that is fitted to the record of a pole which finite elements have moved in gusts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import galewood
import numpy as np
import pytest
from galewood.check.sway import analyse_motion, calibrated, predicted_sway
from galewood.check.verify.bars import polygon_bar
from galewood.measurements import motion_record, read_motion
from galewood.motion.wind import dynamic_pressure
from galewood.solid.fem import FemModel, FemSettings, Simulator
from galewood.solid.model import build_model
from galewood.util import Floats
from galewood.wood import Wood, wood_of_species

from tests.precompute.check.sway.oscillators import driven_oscillator, slow_noise
from tests.precompute.fixtures.tree_meshes import obj_bytes, tube

SEED = 4177
DURATION_S = 900.0
WOOD = wood_of_species("ash")
TRUE = replace(WOOD, young_longitudinal_pa=0.8 * WOOD.young_longitudinal_pa, damping_ratio=0.045)


def pole(wood: Wood) -> FemModel:
    """A stem with a crown on its upper half."""
    bar = polygon_bar(sides=6, radius_m=0.09, length_m=8.0, layers=24, tip_radius_m=0.03)
    crown = bar.vertices_m[:, 1] > 4.0
    share = np.where(crown, 1.0 / crown.sum(), 0.0)
    laden = replace(bar, mass_kg=25.0 * share)
    model = build_model(laden, laden, wood, laden, FemSettings())
    return replace(model, drag_area_m2=3.0 * share)


def gusts() -> Floats:
    """(n,) wind of 4 m/s at 30 Hz."""
    count = round(30 * DURATION_S)
    return 4.0 + 1.2 * np.clip(slow_noise(30.0, DURATION_S, 0.05, SEED), -2.5, 2.5)[:count]


def test_a_record_made_by_finite_elements_gives_their_wood_back() -> None:
    model, wind = pole(TRUE), gusts()
    mode_pressure = dynamic_pressure(wind, model.streamlined_exponent)
    simulator, top = Simulator(model), int(np.argmax(model.nodes_m[:, 1]))
    sway = np.empty((len(wind), 2))
    cross = dynamic_pressure(np.abs(slow_noise(30.0, DURATION_S, 0.05, SEED + 1)), model.streamlined_exponent)
    for k, (along, across) in enumerate(zip(mode_pressure, cross, strict=True)):
        simulator.step(np.array([along, 0.3 * across]))
        sway[k] = simulator.u[top, [0, 2]]
    analysis = analyse_motion(motion_record(np.arange(len(wind)) / 30.0, sway, wind_m_s=wind))
    found = calibrated(analysis, WOOD, pole)
    assert found.reached
    assert found.wood.young_longitudinal_pa == pytest.approx(TRUE.young_longitudinal_pa, rel=0.03)
    assert found.wood.damping_ratio == pytest.approx(TRUE.damping_ratio, rel=0.15)


def test_calibration_is_exact_for_an_exact_record() -> None:
    """Without wind: the frequency and the damping of the record are those of an oscillator."""
    true = predicted_sway(pole(TRUE))
    record = driven_oscillator(true.frequency_hz, true.damping_ratio, 20.0, 3600.0, SEED)
    analysis = analyse_motion(motion_record(np.arange(len(record)) / 20.0, record))
    found = calibrated(analysis, WOOD, pole)
    resonance = analysis.along.resonance
    assert found.reached and resonance is not None
    assert found.after.frequency_hz == pytest.approx(resonance.frequency_hz, rel=2e-3)
    assert found.after.damping_ratio == pytest.approx(resonance.damping_ratio, rel=1e-9)
    assert found.wood.young_longitudinal_pa == pytest.approx(TRUE.young_longitudinal_pa, rel=0.02)
    assert found.wood.damping_ratio == pytest.approx(TRUE.damping_ratio, rel=0.12)
    assert found.before.frequency_hz > found.after.frequency_hz


def test_files_are_taken_like_records(tmp_path: Path) -> None:
    record = driven_oscillator(0.9, 0.05, 10.0, 1800.0, SEED)
    path = tmp_path / "pole.csv"
    rows = [f"{k / 10},{one:.6g}" for k, one in enumerate(record)]
    path.write_text("\n".join(["time (s),strain", *rows]), encoding="utf-8")
    expected = analyse_motion(read_motion(path)).figures()
    for file in (path, str(path)):
        assert galewood.analyse_motion(file).figures() == expected
    tree = tmp_path / "tree.obj"
    tree.write_bytes(obj_bytes(tube((0, 0, 0), (0, 6, 0), 0.05, 0.03, sides=16)))
    found = galewood.calibrate(
        galewood.read(tree, species="ash"), path, foliage="bare", target_tets=600, cache_dir=tmp_path
    )
    assert found.reached and found.after.frequency_hz == pytest.approx(0.9, rel=0.02)


def test_drag_damps_in_proportion_to_the_wind() -> None:
    """Below 5 m/s the drag on a small motion is ρ U A v: twice the wind, twice the damping."""
    model = pole(WOOD)
    slow, fast = (predicted_sway(model, np.full(3, wind)).drag_damping_ratio for wind in (2.0, 4.0))
    assert fast == pytest.approx(2 * slow, rel=1e-6) and slow > 0


@pytest.mark.parametrize("stuck", [np.full(4000, 3.0), np.linspace(0.0, 200.0, 4000), np.zeros(4000)])
def test_a_stuck_or_drifting_sensor_has_no_motion(stuck: np.ndarray) -> None:
    found = analyse_motion(motion_record(np.arange(4000) / 20.0, stuck[:, None]))
    assert found.along.resonance is None
    assert found.along.deviation == 0


def test_a_record_without_resonance_is_refused() -> None:
    analysis = analyse_motion(motion_record(np.arange(300) / 10.0, np.zeros(300)))
    assert analysis.along.resonance is None and analysis.along.notes
    with pytest.raises(ValueError, match="no motion"):
        calibrated(analysis, WOOD, pole)
