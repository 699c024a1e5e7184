"""Training of the modal model of a tree: chooses the smallest size that fits the training runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from galewood.motion.modal import ModalTensors
from galewood.pipeline.reduction.modal_fit import fit_modal_model
from galewood.pipeline.reduction.oscillators import Oscillators, first_of, leading_oscillators
from galewood.pipeline.reduction.pod import Subspace, fit_subspace, thinned
from galewood.pipeline.reduction.training_error import training_error_m
from galewood.pipeline.sampling import SampledRun
from galewood.solid.fem import FemSettings
from galewood.util import Floats

LEAST_FURTHER, MOST_FURTHER = 4, 8
"""Fewest and most POD modes in addition to the shapes of the oscillators."""
TRAINING_ERROR_SHARE = 3e-3
"""A larger size is tried if the training error exceeds this share of the height."""


@dataclass(frozen=True)
class Size:
    """Size of the modal model."""

    dynamic: int
    """Oscillators with state."""
    coupled: int
    """Oscillators after the first two that interact with the sway."""
    natural: int
    """Natural modes that the oscillators are combined from."""
    gusty: bool = False
    """Whether noise also selects the oscillators."""


SIZES = (Size(16, 0, 80), Size(32, 4, 100, gusty=True))
"""Sizes to try, smallest first (docs/design/0005-drift-free-motion.md)."""


def sizes_for(modes: int | None) -> tuple[Size, ...]:
    """The sizes to try: the standard ones, or a single size of ``modes`` oscillators (2 to 64)."""
    if modes is None:
        return SIZES
    like = SIZES[0] if modes <= SIZES[0].dynamic else SIZES[-1]
    return (Size(modes, min(like.coupled, modes - 2), like.natural, like.gusty),)


@dataclass(frozen=True)
class ModalTraining:
    """Input of the training: natural modes of the body, the FEM settings, and the training runs."""

    body: Oscillators
    scheme: FemSettings
    runs: Sequence[SampledRun]
    sizes: Sequence[Size] = SIZES
    further: Callable[[], Sequence[SampledRun]] = tuple
    """Returns additional training runs; called once, if the smallest size does not fit well enough."""


@dataclass(frozen=True)
class Fitted:
    """A fitted modal model, its output modes, and its training error, m."""

    modal: ModalTensors
    subspace: Subspace
    training_error_m: float


def output_modes(
    training: ModalTraining, mass_kg: Floats, tolerance_m: float, size: Size
) -> tuple[Oscillators, Subspace]:
    """The oscillators of a size, and the output modes: their shapes and a few POD modes of the runs."""
    frames = sum(len(run.pressure_pa) + 1 for run in training.runs)
    snapshots = thinned((run.displacement_m for run in training.runs), frames)
    body = first_of(training.body, size.natural)
    own = leading_oscillators(body, training.scheme, size.dynamic, gusty=size.gusty)
    return own, fit_subspace(
        snapshots, mass_kg, tolerance_m, leading=own.shapes, least=LEAST_FURTHER, most=MOST_FURTHER
    )


def fit_smallest(training: ModalTraining, mass_kg: Floats, height_m: float, tolerance_m: float) -> Fitted:
    """Fit the smallest modal model whose training error is small enough, or else the most accurate.

    The training runs also determine the output modes, up to the vertex error ``tolerance_m``.
    """
    tried: list[Fitted] = []
    further: Sequence[SampledRun] = ()
    for size in training.sizes:
        if len(tried) == 1:
            further = training.further()
        tried.append(_fit(training, mass_kg, tolerance_m, size, further))
        if tried[-1].training_error_m <= TRAINING_ERROR_SHARE * height_m:
            return tried[-1]
    return min(tried, key=lambda fitted: fitted.training_error_m)


def size_of(training: ModalTraining, dynamic: int) -> Size:
    """The size with this number of oscillators; a small body has fewer than requested. Raises ValueError."""
    most = len(training.body.omega)
    for size in training.sizes:
        if min(size.dynamic, size.natural, most) == dynamic:
            return size
    raise ValueError(f"no size of the modal model has {dynamic} oscillators: build the table again")


def _fit(
    training: ModalTraining,
    mass_kg: Floats,
    tolerance_m: float,
    size: Size,
    further: Sequence[SampledRun],
) -> Fitted:
    """Fit one size. The ``further`` runs do not change the output modes."""
    own, subspace = output_modes(training, mass_kg, tolerance_m, size)
    modal = fit_modal_model(
        own, mass_kg, (*training.runs, *further), subspace, training.scheme, coupled=size.coupled
    )
    return Fitted(modal, subspace, training_error_m(modal, subspace, training.runs, training.scheme.dt_s))
