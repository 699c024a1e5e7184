"""The tensors of a modal model from its parts."""

from __future__ import annotations

import numpy as np

from galewood.motion.modal import ModalTensors
from galewood.pipeline.reduction.drag_points import DragPoints
from galewood.pipeline.reduction.oscillators import Oscillators
from galewood.util import Array, Floats


def modal_tensors(
    own: Oscillators,
    step: Floats,
    drag: DragPoints,
    *,
    sway: Floats,
    force: Floats,
    shown: Floats,
    pose: Floats,
    limits: Floats,
) -> ModalTensors:
    """A modal model in single precision. ``step`` (d, 6) are the propagators of its oscillators."""
    relative = step.copy()
    relative[:, [0, 3]] -= 1.0
    tensors = (
        relative, own.load, sway, force, shown, pose, limits,
        drag.point, drag.shape, drag.rest, drag.place, own.places.place_m, own.place_load,
    )  # fmt: skip
    return ModalTensors(*map(single, tensors), streamlined_exponent=drag.streamlined_exponent)


def single(tensor: Array) -> Array:
    """A contiguous array in single precision."""
    return np.ascontiguousarray(tensor, np.float32)
