"""Training of the modal model of a tree: fits a model of a given size to the training runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from galewood.motion.modal import ModalTensors
from galewood.pipeline.reduction.modal_fit import fit_modal_model
from galewood.pipeline.reduction.oscillators import Oscillators, leading_oscillators
from galewood.pipeline.reduction.output_error import FIT_ITERATIONS
from galewood.pipeline.reduction.pod import Subspace, fit_subspace, thinned
from galewood.pipeline.reduction.training_error import training_error_m
from galewood.pipeline.sampling import SampledRun
from galewood.solid.fem import FemSettings
from galewood.util import Floats

FURTHER_MODES = 6
"""POD modes in addition to the shapes of the oscillators."""


@dataclass(frozen=True)
class Size:
    """Size of the modal model."""

    dynamic: int
    """Oscillators with state."""
    coupled: int
    """Oscillators after the first two that interact with the sway."""
    natural: int
    """Natural modes that the oscillators are combined from."""


STANDARD_SIZE = Size(24, 4, 100)


def size_for(modes: int | None) -> Size:
    """The size of a model of ``modes`` oscillators (2 to 64); None: the standard size."""
    if modes is None:
        return STANDARD_SIZE
    return Size(modes, min(STANDARD_SIZE.coupled, modes - 2), STANDARD_SIZE.natural)


@dataclass(frozen=True)
class ModalTraining:
    """Input of the training: natural modes of the body, the FEM settings, and the training runs."""

    body: Oscillators
    scheme: FemSettings
    runs: Sequence[SampledRun]
    size: Size = STANDARD_SIZE
    fit_iterations: int = FIT_ITERATIONS
    """Steps of the fit that follows the linear one (``reduction.output_error``)."""


@dataclass(frozen=True)
class Fitted:
    """A fitted modal model, its output modes, and its training error, m."""

    modal: ModalTensors
    subspace: Subspace
    training_error_m: float


def output_modes(training: ModalTraining, mass_kg: Floats) -> tuple[Oscillators, Subspace]:
    """The oscillators, and the output modes: their shapes and a few POD modes of the runs."""
    frames = sum(len(run.pressure_pa) + 1 for run in training.runs)
    snapshots = thinned((run.displacement_m for run in training.runs), frames)
    size = training.size
    own = leading_oscillators(training.body, training.scheme, size.natural, size.dynamic)
    return own, fit_subspace(snapshots, mass_kg, FURTHER_MODES, leading=own.shapes)


def fitted(training: ModalTraining, mass_kg: Floats) -> Fitted:
    """Fit a modal model to the training runs, which also determine the output modes."""
    own, subspace = output_modes(training, mass_kg)
    modal = fit_modal_model(
        own, mass_kg, training.runs, subspace, training.scheme,
        coupled=training.size.coupled, iterations=training.fit_iterations,
    )  # fmt: skip
    return Fitted(modal, subspace, training_error_m(modal, subspace, training.runs, training.scheme.dt_s))
