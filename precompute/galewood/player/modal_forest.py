"""The drift-free method: a few oscillators of the tree's own, stepped exactly, bent by a small force.

State of a tree: d modal coordinates e (m·√kg) about its gravity rest pose and their velocities v. A step is
the finite elements' own linear step, diagonal in e, under the wind's load and a force that is polynomial in
the two sway coordinates (docs/design/0005-drift-free-motion.md). The shown pose is e itself, and a few modes
more that follow e and the pressure at once, bending included. Trees are stepped side by side, LANES at a
time, so that the compiler can use the whole width of the machine and BLAS sums the terms. web/src/tangent.ts
is the same arithmetic.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from galewood.modal import ModalTensors, advance_trees, widened, working_room
from galewood.player.instances import TreeInstances
from galewood.util import Singles


class ModalForest(TreeInstances):
    """Trees of one table, each with its own state, in its own frame and at its own pace."""

    def __init__(self, modal: ModalTensors, dt_s: float, mode_scale: Singles, count: int) -> None:
        """``count`` trees at rest; dt_s is the table's step, mode_scale (r,) the stream's unit of q."""
        super().__init__(count, mode_scale, dt_s)
        self._tensors, self._lanes = widened(modal), working_room(modal)
        d = len(modal.step)
        self._e, self._v = np.zeros((count, d)), np.zeros((count, d))
        self._turned = np.zeros((count, 2))
        self.extrapolation_ratio = np.zeros(count, np.float32)
        """(count,) how far into the sampled range of sway and pressure a tree is: above 1 it is beyond it."""

    def advance(self, dt_s: float, pressure_x: npt.ArrayLike, pressure_z: npt.ArrayLike) -> None:
        """Let dt_s seconds pass under world pressures (count,) in Pa; large trees sway slower."""
        px, pz = self._passing(dt_s, pressure_x, pressure_z)
        advance_trees(
            self._tensors, self._dt_s / 2, self._rate, self._turn, px, pz, self._e, self._v, self._phase,
            self._turned, self._now, self._before, self.q, self.extrapolation_ratio, self._lanes,
        )  # fmt: skip
