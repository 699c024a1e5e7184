"""Model order reduction; in: training runs; out: POD basis, fitted modal model."""

from galewood.pipeline.reduction.linear import LinearMotion, linear_motion
from galewood.pipeline.reduction.oscillators import (
    Exposure,
    Oscillators,
    in_gusts,
    leading_oscillators,
    oscillators_of,
)
from galewood.pipeline.reduction.pod import Subspace, quantise, quantum
from galewood.pipeline.reduction.training import STANDARD_SIZE, ModalTraining, fitted, output_modes, size_for
from galewood.pipeline.reduction.training_error import simulated_q
from galewood.pipeline.reduction.wind_scale import training_winds

__all__ = [
    "STANDARD_SIZE",
    "Exposure",
    "LinearMotion",
    "ModalTraining",
    "Oscillators",
    "Subspace",
    "fitted",
    "in_gusts",
    "leading_oscillators",
    "linear_motion",
    "oscillators_of",
    "output_modes",
    "quantise",
    "quantum",
    "simulated_q",
    "size_for",
    "training_winds",
]
