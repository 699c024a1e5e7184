"""Model order reduction; in: training runs; out: POD basis, fitted modal model."""

from galewood.pipeline.reduction.linear import linear_motion
from galewood.pipeline.reduction.oscillators import Exposure, Oscillators, in_gusts, oscillators_of
from galewood.pipeline.reduction.pod import Subspace, quantise, quantum
from galewood.pipeline.reduction.training import ModalTraining, fitted, output_modes, size_for
from galewood.pipeline.reduction.wind_scale import training_winds

__all__ = [
    "Exposure",
    "ModalTraining",
    "Oscillators",
    "Subspace",
    "fitted",
    "in_gusts",
    "linear_motion",
    "oscillators_of",
    "output_modes",
    "quantise",
    "quantum",
    "size_for",
    "training_winds",
]
