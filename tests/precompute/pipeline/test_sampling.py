"""Sampled winds and trajectories: recorded data, fading, storage."""

from pathlib import Path

import numpy as np
import pytest
from galewood.motion.wind.evaluation import dynamic_pressure
from galewood.pipeline.sampling.design_speed import design_wind
from galewood.pipeline.sampling.recording import (
    StoredRun,
    Trajectory,
    is_whole,
    read_trajectory,
    sample_trajectory,
    sample_winds,
    symmetric,
    trajectory_key,
    write_trajectory,
)

from tests.golden.beam import Beam

EXPONENT = Beam().streamlined_exponent
WINDS = sample_winds(12.0, 1 / 30, EXPONENT)


def run(name: str) -> tuple[Beam, Trajectory]:
    beam = Beam(dt_s=1 / 30)
    wind = next(wind for wind in WINDS if wind.name == name)
    return beam, sample_trajectory(beam, wind, np.arange(beam.n), beam.dt_s)


def test_paper_winds_are_included() -> None:
    cosine = [wind for wind in WINDS if wind.name.startswith("cosine")]
    assert len(cosine) == 36
    assert {len(wind.pressure_pa) for wind in cosine} == {180}
    assert {wind.direction_deg for wind in cosine} == {0.0, 60.0, 120.0, 180.0, 240.0, 300.0}
    peak = max(float(np.linalg.norm(wind.pressure_pa, axis=1).max()) for wind in WINDS)
    top = dynamic_pressure(12.0, EXPONENT)
    assert 0.95 * top < peak <= top
    for wind in cosine:
        assert np.linalg.norm(wind.pressure_pa, axis=1).min() > 0
        across = np.array([-np.sin(np.radians(wind.direction_deg)), np.cos(np.radians(wind.direction_deg))])
        assert np.abs(wind.pressure_pa @ across).max() < 1e-12


def test_records_contain_the_state_before_the_step() -> None:
    beam, trajectory = run("cosine-3-060")
    wind = next(wind for wind in WINDS if wind.name == "cosine-3-060")
    beam.reset()
    for i, pressure in enumerate(wind.pressure_pa[:50]):
        assert np.allclose(trajectory.velocity[i], beam.v, atol=1e-6)
        assert np.allclose(trajectory.displacement_m[i], beam.u, atol=1e-6)
        beam.step(pressure)
        assert np.allclose(trajectory.force[i], beam.recorded_force(np.arange(beam.n)), rtol=1e-5, atol=1e-4)
    assert not trajectory.displacement_m[0].any()


def test_gust_fades_smoothly_to_exact_rest() -> None:
    beam, trajectory = run("gust-120")
    assert not trajectory.displacement_m[-2:].any()
    assert not trajectory.velocity[-1].any()
    assert np.array_equal(trajectory.stiffness[-1], trajectory.stiffness[0])
    steps = np.diff(trajectory.displacement_m, axis=0)
    # The faded velocity is the derivative of the faded motion (backward Euler: v_i = (u_i − u_{i−1}) / Δt).
    assert np.allclose(trajectory.velocity[1:], steps[:-1] / beam.dt_s, atol=2e-3)
    assert np.abs(np.diff(steps, axis=0)).max() < 0.05 * np.abs(trajectory.displacement_m).max()


def test_still_air_causes_no_motion() -> None:
    _, trajectory = run("still-000")
    assert not trajectory.displacement_m.any()
    assert not trajectory.pressure_pa.any()


def test_progress_callback_can_cancel_between_frames() -> None:
    class StopError(Exception):
        pass

    def on_progress(fraction: float) -> None:
        if fraction > 0.1:
            raise StopError

    beam = Beam(dt_s=1 / 30)
    with pytest.raises(StopError):
        sample_trajectory(beam, WINDS[5], np.arange(2), beam.dt_s, on_progress)


def test_trajectory_is_stored_completely_under_a_hash_of_its_inputs(tmp_path: Path) -> None:
    _, trajectory = run("cosine-0-000")
    path = tmp_path / "deep" / "run.npz"
    write_trajectory(path, trajectory)
    again = read_trajectory(path)
    for name, values in vars(trajectory).items():
        assert np.array_equal(getattr(again, name), values)
        assert np.array_equal(getattr(StoredRun(path), name), values)
    assert [p.name for p in path.parent.iterdir()] == ["run.npz"]
    points = np.arange(3)
    keys = {trajectory_key(m, w, p) for m in "ab" for w in WINDS[:9] for p in (points, points + 1)}
    assert len(keys) == 36


def test_symmetric_blocks_are_packed_into_six_numbers() -> None:
    block = np.array([[[1.0, 4, 5], [4, 2, 6], [5, 6, 3]]])
    assert symmetric(block).tolist() == [[1, 2, 3, 4, 5, 6]]


def test_design_wind_is_reduced_until_the_sway_is_acceptable() -> None:
    beam = Beam(dt_s=1 / 30)
    gentle = design_wind(beam, 5.0, beam.height_m, beam.dt_s, EXPONENT)
    assert gentle.speed_m_s == 5.0
    assert gentle.sway_share < 0.2
    strong = design_wind(beam, 60.0, 0.5, beam.dt_s, EXPONENT)  # with an assumed height of 0.5 m
    assert strong.speed_m_s < 60.0
    assert strong.sway_share <= 0.2


def test_truncated_file_is_not_accepted_as_a_run(tmp_path: Path) -> None:
    _, trajectory = run("still-000")
    path = tmp_path / "run.npz"
    write_trajectory(path, trajectory)
    content = path.read_bytes()
    assert is_whole(path)
    for kept in (0, 1, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:kept])
        assert not is_whole(path)
    path.unlink()
    assert not is_whole(path)
