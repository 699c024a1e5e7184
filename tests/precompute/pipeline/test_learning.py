"""Training: the smallest sufficient size is chosen, and the training error is that of a single tree."""

import numpy as np
import pytest
from galewood.pipeline.reduction import training as training_module
from galewood.pipeline.reduction.oscillators import propagators, reduced, response
from galewood.pipeline.reduction.training import ModalTraining, Size, fit_smallest, size_of
from galewood.pipeline.reduction.training_error import simulated_q, training_error_m
from galewood.pipeline.sampling.recording import SampledRun, sample_trajectory
from galewood.pipeline.sampling.training_winds import training_shapes
from galewood.player.modal_forest import ModalForest

from tests.golden.beam import Beam
from tests.golden.make import scheme

FEW, MORE = Size(2, 0, 6), Size(5, 3, 6)


def training_runs(beam: Beam, design_speed_m_s: float) -> list[SampledRun]:
    shapes = training_shapes(beam.first_hz, beam.dt_s, beam.streamlined_exponent)
    winds = [shape.at(design_speed_m_s) for shape in shapes[::3]]
    return [sample_trajectory(beam, wind, np.arange(beam.n), beam.dt_s) for wind in winds]


@pytest.mark.parametrize(("share", "expected"), [(1e-3, FEW), (1e-6, MORE), (0.0, MORE)])
def test_a_larger_size_is_chosen_only_if_the_smallest_misses_the_training_runs(
    monkeypatch: pytest.MonkeyPatch, share: float, expected: Size
) -> None:
    monkeypatch.setattr(training_module, "TRAINING_ERROR_SHARE", share)
    beam = Beam()
    runs = training_runs(beam, 2.0)
    given = ModalTraining(beam.oscillators(), scheme(beam), runs, sizes=[FEW, MORE])
    fitted = fit_smallest(given, beam.mass_kg, beam.height_m, 1e-4 * beam.height_m)
    assert len(fitted.modal.step) == expected.dynamic
    assert fitted.modal.coupled == expected.coupled
    again = training_error_m(fitted.modal, fitted.subspace, runs, beam.dt_s)
    assert again == fitted.training_error_m


@pytest.mark.parametrize(("share", "requests"), [(1.0, 0), (0.0, 1)])
def test_further_runs_are_requested_once_and_only_if_the_smallest_size_is_insufficient(
    monkeypatch: pytest.MonkeyPatch, share: float, requests: int
) -> None:
    monkeypatch.setattr(training_module, "TRAINING_ERROR_SHARE", share)
    beam = Beam()
    runs, more = training_runs(beam, 2.0), training_runs(beam, 3.0)
    calls: list[int] = []

    def further() -> list[SampledRun]:
        calls.append(1)
        return more

    given = ModalTraining(beam.oscillators(), scheme(beam), runs, [FEW, Size(4, 2, 6), MORE], further)
    modal = fit_smallest(given, beam.mass_kg, beam.height_m, 1e-4).modal
    assert len(calls) == requests
    strongest_pa = max(np.linalg.norm(run.pressure_pa, axis=1).max() for run in (runs, more)[requests])
    assert modal.limits[2] == pytest.approx(strongest_pa)


def test_oscillators_are_sorted_by_how_far_they_move_the_tree() -> None:
    beam = Beam()
    winds = [np.asarray(run.pressure_pa) for run in training_runs(beam, 8.0)]
    ritz = reduced(beam.oscillators(), winds, scheme(beam), 5)
    far = np.sqrt((ritz.shapes.reshape(5, -1, 3) ** 2).sum(axis=2).max(axis=1))
    steps = propagators(ritz.omega, np.diag(ritz.damping), scheme(beam))
    moved = [
        np.concatenate([response(step, (wind @ load)[:, None]) for wind in winds])
        for step, load in zip(steps, ritz.load, strict=True)
    ]
    sway = far * [np.sqrt(np.mean(motion**2)) for motion in moved]
    assert (np.diff(sway) < 0.05 * sway[0]).all()
    assert sway[0] > 3 * sway[-1]


def test_simulated_training_runs_match_a_single_tree() -> None:
    rng = np.random.default_rng(901)
    beam = Beam()
    runs = training_runs(beam, 8.0)
    given = ModalTraining(beam.oscillators(), scheme(beam), runs, sizes=[MORE])
    modal = fit_smallest(given, beam.mass_kg, beam.height_m, 1e-4).modal
    winds = [rng.normal(size=(frames, 2)) * 10.0 for frames in (30, 47)]
    for wind, track in zip(winds, simulated_q(modal, winds, beam.dt_s), strict=True):
        single = ModalForest(modal, beam.dt_s, np.ones(modal.modes, np.float32), 1)
        assert len(track) == len(wind) + 1 and not track[0].any()
        for frame, (x, z) in enumerate(np.concatenate([wind, [[0.0, 0.0]]])):
            single.advance(beam.dt_s, [x], [z])
            assert np.array_equal(single.q[0], track[frame].astype(single.q.dtype))


def test_the_size_is_identified_by_its_number_of_oscillators_also_for_a_small_body() -> None:
    beam = Beam()
    count = len(beam.oscillators().omega)
    given = ModalTraining(beam.oscillators(), scheme(beam), [], sizes=[FEW, Size(count + 7, 3, count + 9)])
    assert [size_of(given, dynamic) for dynamic in (2, count)] == list(given.sizes)
    with pytest.raises(ValueError, match="build the table again"):
        size_of(given, 3)
