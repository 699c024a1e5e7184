"""Training of the modal model: its oscillators, and its training error, which is that of a single tree."""

import numpy as np
from galewood.pipeline.reduction.oscillators import felt_wind, propagators, reduced, response
from galewood.pipeline.reduction.training import ModalTraining, Size, fitted, output_modes
from galewood.pipeline.reduction.training_error import simulated_q, training_error_m
from galewood.pipeline.sampling import NO_GUSTS, CrownGusts
from galewood.pipeline.sampling.recording import SampledRun, sample_trajectory
from galewood.pipeline.sampling.training_winds import gust_shapes, training_shapes
from galewood.player.modal_forest import ModalForest

from tests.golden.beam import Beam
from tests.golden.make import scheme


def training_runs(beam: Beam, design_speed_m_s: float) -> list[SampledRun]:
    shapes = training_shapes(beam.first_hz, beam.dt_s, beam.streamlined_exponent)[::3]
    shapes += gust_shapes(beam.dt_s, beam.streamlined_exponent, count=3)
    winds = [shape.at(design_speed_m_s) for shape in shapes]
    return [sample_trajectory(beam, wind, np.arange(beam.n), beam.dt_s) for wind in winds]


def test_the_training_error_is_that_of_the_fitted_model() -> None:
    beam = Beam()
    runs = training_runs(beam, 2.0)
    model = fitted(ModalTraining(beam.oscillators(), scheme(beam), runs, Size(5, 3, 6)), beam.mass_kg)
    assert len(model.modal.step) == 5
    assert model.modal.coupled == 3
    assert training_error_m(model.modal, model.subspace, runs, beam.dt_s) == model.training_error_m
    assert model.training_error_m < 0.01 * beam.height_m


def test_a_small_body_has_fewer_oscillators() -> None:
    beam = Beam()
    count = len(beam.oscillators().omega)
    given = ModalTraining(beam.oscillators(), scheme(beam), training_runs(beam, 2.0), Size(count + 7, 3, 99))
    own, subspace = output_modes(given, beam.mass_kg)
    assert len(own.omega) == count
    assert subspace.modes == count


def test_oscillators_are_sorted_by_how_far_they_move_the_tree() -> None:
    beam = Beam()
    body = beam.oscillators()
    winds = [
        felt_wind(np.asarray(run.pressure_pa), CrownGusts.of_array(run.gusts), body.places.place_m, beam.dt_s)
        for run in training_runs(beam, 8.0)
    ]
    ritz = reduced(body, winds, scheme(beam), 5)
    far = np.sqrt((ritz.shapes.reshape(5, -1, 3) ** 2).sum(axis=2).max(axis=1))
    steps = propagators(ritz.omega, np.diag(ritz.damping), scheme(beam))
    moved = [
        np.concatenate([response(step, ritz.force(wind)[:, k : k + 1]) for wind in winds])
        for k, step in enumerate(steps)
    ]
    sway = far * [np.sqrt(np.mean(motion**2)) for motion in moved]
    assert (np.diff(sway) < 0.05 * sway[0]).all()
    assert sway[0] > 3 * sway[-1]


def test_simulated_training_runs_match_a_single_tree() -> None:
    rng = np.random.default_rng(901)
    beam = Beam()
    runs = training_runs(beam, 8.0)
    modal = fitted(ModalTraining(beam.oscillators(), scheme(beam), runs, Size(5, 3, 6)), beam.mass_kg).modal
    gusty = CrownGusts(3, 5.0, 8.0, 0.4, 6.0, 0.5, beam.streamlined_exponent)
    winds = [(rng.normal(size=(frames, 2)) * 10.0, gusts) for frames, gusts in ((30, NO_GUSTS), (47, gusty))]
    for (wind, within), track in zip(winds, simulated_q(modal, winds, beam.dt_s), strict=True):
        single = ModalForest(modal, beam.dt_s, np.ones(modal.modes, np.float32), 1)
        assert len(track) == len(wind) + 1 and not track[0].any()
        gusts = within.relative(modal.place.astype(np.float64), wind, beam.dt_s)
        still = np.zeros((1, gusts.shape[1]))
        for frame, (x, z) in enumerate(np.concatenate([wind, [[0.0, 0.0]]])):
            single.advance(beam.dt_s, [x], [z], gusts[frame : frame + 1] if frame < len(wind) else still)
            assert np.array_equal(single.q[0], track[frame].astype(single.q.dtype))
