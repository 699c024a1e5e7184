"""Steps trees whose tables differ, with a table for each lane of a batch.

docs/design/0036-individuals.md says why.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

from collections.abc import Sequence

import numba
import numpy as np

from galewood.constants import MAX_STEPS_PER_ADVANCE
from galewood.motion.modal.drag import drag_inputs, with_shares
from galewood.motion.modal.step import begin, display, step_trees
from galewood.motion.modal.tensors import ModalTensors
from galewood.motion.modal.term_sums import term_sums
from galewood.util import Array

LANE_COUNT = 32
"""Trees per batch: a multiple of what the compiler takes at once, and few enough for the cache."""

Sizes = tuple[int, ...]


def sizes_of(modal: ModalTensors) -> Sizes:
    """What must be the same in tables whose trees are stepped together; at the end the sums, or −1."""
    sums = term_sums(modal.force)
    return (
        *modal.force.shape, *modal.pose.shape, len(modal.drag_point), len(modal.place),
        -1 if sums is None else len(sums.rows),
    )  # fmt: skip


def tensors_of_each(trees: Sequence[ModalTensors]) -> tuple[Array, ...]:
    """The tensors of ``float64_tensors`` for trees with tables of the same sizes, batch by batch.

    Each is (batches, …, lanes) in single precision, as tables have them: how many bytes a step reads counts.
    Few sums take the place of the terms where they can. The last lanes of the last batch repeat a tree.
    """
    known = {id(one): one for one in trees}
    prepared = {key: _tensors(one) for key, one in known.items()}
    lanes = [prepared[id(one)] for one in trees]
    lanes += lanes[-1:] * (-len(lanes) % LANE_COUNT)
    batches = len(lanes) // LANE_COUNT
    stacks = (np.stack(of).reshape(batches, LANE_COUNT, *of[0].shape) for of in zip(*lanes, strict=True))
    return tuple(np.ascontiguousarray(np.moveaxis(one, 1, -1), np.float32) for one in stacks)


def _tensors(modal: ModalTensors) -> tuple[Array, ...]:
    d = len(modal.step)
    sums = term_sums(modal.force)
    rows = modal.force if sums is None else sums.rows
    shares = np.zeros((0, len(modal.force))) if sums is None else sums.shares
    force = np.concatenate([rows.T, modal.place_load.reshape(d, -1)], axis=1)
    shape = modal.drag_shape.reshape(-1, d)
    return (
        modal.step, modal.load, modal.sway, force, modal.shown, modal.pose.T, modal.limits,
        with_shares(modal.drag_point), shape[:, : drag_inputs(d)], shape.T, modal.drag_rest,
        np.array(modal.streamlined_exponent), modal.drag_place, modal.mean_gust, shares,
    )  # fmt: skip


@numba.njit(cache=True, nogil=True)
def advance_each(tensors, half_s, batch, rate, turn, wind, phase, state, q):  # pragma: no cover  (compiled)
    """Advance trees that each have a table: ``advance_trees``.

    ``tensors`` are those of ``tensors_of_each``, ``batch`` is from ``working_room`` for as many lanes; the
    other arguments are as there. Trees that take no step in a round keep their state while others do.
    """
    (step, load, sway, force, shown, pose, limits, point, inputs, outputs, rest, exponent, place, mean,
     shares) = tensors  # fmt: skip
    begin(rate, turn, wind, phase, state)
    tree = batch[10]
    for b in range(len(step)):
        own = (
            step[b], load[b], sway[b], force[b], shown[b], pose[b], limits[b], point[b], inputs[b],
            outputs[b], rest[b], exponent[b], place[b], mean[b], shares[b],
        )  # fmt: skip
        for _ in range(MAX_STEPS_PER_ADVANCE):
            stepped = 0
            for lane in range(len(tree)):
                i = b * len(tree) + lane
                tree[lane] = -1
                if i < len(phase) and phase[i] >= 1.0:
                    phase[i] -= 1.0
                    tree[lane] = i
                    stepped += 1
            if stepped == 0:
                break
            step_trees(own, half_s, batch, len(tree), wind[2], state)
    display(phase, state, q)
