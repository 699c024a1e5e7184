"""The drift-free method of a tree, learnt from its runs and as large as they ask for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from galewood.fem import FemSettings
from galewood.modal import ModalTensors
from galewood.reduction.modal_fit import fit_modal_model, leading_oscillators
from galewood.reduction.oscillators import Oscillators, first_of
from galewood.reduction.pod import Subspace, fit_subspace, thinned
from galewood.reduction.training_error import training_error_m
from galewood.sampling import SampledRun
from galewood.util import Floats

LEAST_FURTHER, MOST_FURTHER = 4, 8
"""Shown modes beside the oscillators' own."""
TRAINING_ERROR_SHARE = 2e-3
"""More oscillators are tried where the method misses its own runs by more than this share of the height."""


@dataclass(frozen=True)
class Size:
    """How large the drift-free method is."""

    dynamic: int
    """Oscillators that are stepped."""
    coupled: int
    """Those that bend with the sway, beside the first two."""
    natural: int
    """Natural modes that the oscillators are made of."""


SIZES = (Size(16, 4, 80), Size(48, 20, 120))
"""Smallest first; docs/design/0005-drift-free-motion.md."""


def sizes_for(modes: int | None) -> tuple[Size, ...]:
    """The sizes to try: the standard ones, or one of so many oscillators (2 to 64)."""
    if modes is None:
        return SIZES
    like = SIZES[0] if modes <= SIZES[0].dynamic else SIZES[-1]
    return (Size(modes, min(like.coupled, modes - 2), like.natural),)


@dataclass(frozen=True)
class ModalTraining:
    """What the drift-free method is made from: free oscillators of the body, its scheme, and true runs."""

    body: Oscillators
    scheme: FemSettings
    runs: Sequence[SampledRun]
    sizes: Sequence[Size] = SIZES
    further: Callable[[], Sequence[SampledRun]] = tuple
    """More runs, asked for once if the smallest size does not do: the larger ones have more to find out."""


@dataclass(frozen=True)
class Fitted:
    """The drift-free method, the modes that it shows, and how far it is from its own runs."""

    modal: ModalTensors
    subspace: Subspace
    training_error_m: float


def shown_modes(
    runs: Sequence[SampledRun], mass_kg: Floats, tolerance_m: float, training: ModalTraining, size: Size
) -> tuple[Oscillators, Subspace]:
    """The oscillators that are stepped, and the modes that are shown: their own shapes and a few more."""
    seen = (*runs, *training.runs)
    snapshots = thinned((run.displacement_m for run in seen), sum(len(run.pressure_pa) + 1 for run in seen))
    body = first_of(training.body, size.natural)
    own = leading_oscillators(body, training.runs, training.scheme, size.dynamic)
    return own, fit_subspace(
        snapshots, mass_kg, tolerance_m, leading=own.shapes, least=LEAST_FURTHER, most=MOST_FURTHER
    )


def fit_smallest(
    runs: Sequence[SampledRun], mass_kg: Floats, height_m: float, tolerance_m: float, training: ModalTraining
) -> Fitted:
    """The method with the fewest oscillators that follow the runs closely enough, or else the nearest."""
    tried: list[Fitted] = []
    further: Sequence[SampledRun] = ()
    for size in training.sizes:
        if len(tried) == 1:
            further = training.further()
        tried.append(_fit(runs, mass_kg, tolerance_m, training, size, further))
        if tried[-1].training_error_m <= TRAINING_ERROR_SHARE * height_m:
            return tried[-1]
    return min(tried, key=lambda fitted: fitted.training_error_m)


def size_of(training: ModalTraining, dynamic: int) -> Size:
    """The size that gives so many oscillators (a small body has fewer than asked for). Raises ValueError."""
    most = len(training.body.omega)
    for size in training.sizes:
        if min(size.dynamic, size.natural, most) == dynamic:
            return size
    raise ValueError(f"no size of the drift-free method has {dynamic} oscillators: build the table again")


def _fit(
    runs: Sequence[SampledRun],
    mass_kg: Floats,
    tolerance_m: float,
    training: ModalTraining,
    size: Size,
    further: Sequence[SampledRun],
) -> Fitted:
    """The shown modes do not depend on the ``further`` runs: they can be found again without them."""
    own, subspace = shown_modes(runs, mass_kg, tolerance_m, training, size)
    modal = fit_modal_model(
        own, mass_kg, (*training.runs, *further), subspace, training.scheme, coupled=size.coupled
    )
    error_m = training_error_m(modal, subspace, training.runs, training.scheme.dt_s)
    return Fitted(modal, subspace, error_m)
