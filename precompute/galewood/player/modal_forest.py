"""The modal reduced-order model of many trees: a few oscillators with a small nonlinear force.

State of a tree: d modal coordinates e (m·√kg) about its gravity rest pose and their velocities v. A step is
the time step of the FEM, linear and diagonal in e, under the wind load and a force that is polynomial in the
two sway coordinates (docs/design/0005-drift-free-motion.md). The pose consists of e and a few more modes that
follow e and the pressure quasi-statically. Trees are stepped in batches, so that BLAS sums the terms and the
compiler can use the full SIMD width.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import numpy.typing as npt

from galewood.motion.modal import ModalTensors, advance_trees, float64_tensors, working_room
from galewood.player.instances import TREE_ARRAYS, TreeInstances
from galewood.util import Array, Floats, Singles

MODAL_ARRAYS = (*TREE_ARRAYS, "_e", "_v", "_turned", "extrapolation_ratio")
"""Attributes of ``ModalForest`` with a row for each tree."""


class ModalForest(TreeInstances):
    """Trees of one table stepped by the modal model, each with its own state, yaw and time scale."""

    def __init__(self, modal: ModalTensors, dt_s: float, mode_scale: Singles, count: int) -> None:
        """Create ``count`` trees at rest; dt_s: table step, s; mode_scale (r,): unit of streamed q."""
        super().__init__(count, mode_scale, dt_s)
        self.modal, self.dt_s, self._count = modal, dt_s, count
        d = len(modal.step)
        self._shown = modal.shown.astype(np.float64)
        self._e, self._v = np.zeros((count, d)), np.zeros((count, d))
        self._turned, self._no_gusts = np.zeros((count, 2)), np.zeros((count, 0))
        self.extrapolation_ratio = np.zeros(count, np.float32)
        """(count,) sway or pressure over the largest sampled value; above 1 the motion is extrapolated."""

    @cached_property
    def _prepared(self) -> tuple[tuple[Floats | float, ...], tuple[Array, ...]]:
        """Tensors and work arrays of a step; trees that are stepped with those of other tables need none."""
        return float64_tensors(self.modal), working_room(self.modal, self._count)

    def advance(
        self,
        dt_s: float,
        pressure_x: npt.ArrayLike,
        pressure_z: npt.ArrayLike,
        gusts: Floats | None = None,
    ) -> None:
        """Advance by dt_s seconds under world pressures (count,) in Pa. Large trees sway slower.

        ``gusts`` (count, 2G) are the relative gusts at the places of each crown (``PlaceGusts``); None: the
        wind is the same everywhere in a crown.
        """
        wind = (*self._begin(dt_s, pressure_x, pressure_z), self._no_gusts if gusts is None else gusts)
        state = (self._e, self._v, self._turned, self._now, self._before, self.extrapolation_ratio)
        tensors, batch = self._prepared
        advance_trees(
            tensors, self._dt_s / 2, batch, self._rate, self._turn, wind, self._phase, state,
            self.q,
        )  # fmt: skip

    def displace(self, tree: int, e: npt.ArrayLike, v: npt.ArrayLike) -> None:
        """Add to the coordinates e (d,) and speeds v (d,), per second of a tree of this size, of one tree."""
        moved = np.asarray(e, np.float64)
        self._e[tree] += moved
        self._v[tree] += np.asarray(v, np.float64) * self._size[tree]
        d = len(moved)
        shown = self._shown * moved
        self._now[tree, :d] += shown
        self._before[tree, :d] += shown
