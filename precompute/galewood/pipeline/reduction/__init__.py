"""Model order reduction; in: training runs; out: POD basis, fitted modal model."""

from galewood.pipeline.reduction.gust_layer import GustModes, gust_modes, gust_range
from galewood.pipeline.reduction.linear import linear_motion
from galewood.pipeline.reduction.oscillators import Exposure, Oscillators, oscillators_of
from galewood.pipeline.reduction.pod import Subspace, quantise, quantum
from galewood.pipeline.reduction.training import ModalTraining, fit_smallest, output_modes, size_of, sizes_for
from galewood.pipeline.reduction.wind_scale import TrainingWinds, training_winds

__all__ = [
    "Exposure",
    "GustModes",
    "ModalTraining",
    "Oscillators",
    "Subspace",
    "TrainingWinds",
    "fit_smallest",
    "gust_modes",
    "gust_range",
    "linear_motion",
    "oscillators_of",
    "output_modes",
    "quantise",
    "quantum",
    "size_of",
    "sizes_for",
    "training_winds",
]
