"""Model order reduction; in: training runs; out: POD basis, fitted modal model, render nodes."""

from galewood.reduction.calm_bark import AxisPoses, calmed, drawn_poses
from galewood.reduction.gust_layer import GustModes, gust_modes, gust_range
from galewood.reduction.linear import LinearMotion, linear_motion
from galewood.reduction.nodes import MAX_NODES, Motion, Nodes, make_nodes
from galewood.reduction.oscillators import Exposure, Oscillators, oscillators_of
from galewood.reduction.pod import QuantisedMotion, Subspace, quantise, quantum
from galewood.reduction.training import Fitted, ModalTraining, fit_smallest, shown_modes, size_of, sizes_for
from galewood.reduction.wind_scale import TrainingWinds, training_winds

__all__ = [
    "MAX_NODES",
    "AxisPoses",
    "Exposure",
    "Fitted",
    "GustModes",
    "LinearMotion",
    "ModalTraining",
    "Motion",
    "Nodes",
    "Oscillators",
    "QuantisedMotion",
    "Subspace",
    "TrainingWinds",
    "calmed",
    "drawn_poses",
    "fit_smallest",
    "gust_modes",
    "gust_range",
    "linear_motion",
    "make_nodes",
    "oscillators_of",
    "quantise",
    "quantum",
    "shown_modes",
    "size_of",
    "sizes_for",
    "training_winds",
]
