"""Steps many trees by the modal model, a batch of trees at a time (docs/design/0010-kernel.md)."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import numba
import numpy as np

from galewood.constants import MAX_STEPS_PER_ADVANCE, MODAL_REST
from galewood.motion.modal.drag import add_drag, drag_tensors
from galewood.motion.modal.lanes import of_lane, write_product
from galewood.motion.modal.tensors import ModalTensors
from galewood.motion.modal.terms import hold as hold
from galewood.motion.modal.terms import write_force_terms, write_pose_terms, write_sway
from galewood.util import Array, Floats

BATCH_TREES = 64
"""Most trees per matrix product: few enough that BLAS stays on one core."""


@numba.njit(cache=True, nogil=True)
def _step(tensors, half_s, batch):  # pragma: no cover  (compiled)
    """Advance all trees of a batch by one table step: linear step, polynomial force and drag.

    What drives the trees is the terms, or their sums, and at the end the gusts at the places, from
    ``_write_wind``.
    """
    step, load, sway, force, _, _, limits, point, inputs, outputs, rest, exponent, _, _, shares = tensors
    e, v, pressure, felt, air, ahead, pairs, terms, total, moved, _, factors = batch
    write_force_terms(sway, limits, half_s, e, v, felt, ahead, pairs, terms)
    if len(shares) > 0:
        write_product(shares, terms[: shares.shape[1]], factors[: len(shares)])
    write_product(force, factors[: force.shape[1]], total[: len(e)])
    for k in range(len(e)):
        along, across, r00, r01, to_e = load[k, 0], load[k, 1], step[k, 0], step[k, 1], step[k, 4]
        for lane in range(e.shape[1]):
            total[k, lane] += (
                of_lane(along, lane) * pressure[0, lane] + of_lane(across, lane) * pressure[1, lane]
            )
            # the mean speed during the step, without the drag
            path = of_lane(r00, lane) * e[k, lane] + of_lane(r01, lane) * v[k, lane]
            ahead[k, lane] = (path + of_lane(to_e, lane) * total[k, lane]) * (0.5 / half_s)
    if len(point) > 0:
        add_drag(point, inputs, outputs, rest, exponent, ahead, air, moved, total[: len(e)])
    for k in range(len(e)):
        r00, r01, r10, r11, to_e, to_v = (
            step[k, 0],
            step[k, 1],
            step[k, 2],
            step[k, 3],
            step[k, 4],
            step[k, 5],
        )
        for lane in range(e.shape[1]):
            x, y, f = e[k, lane], v[k, lane], total[k, lane]
            e[k, lane] = x + (of_lane(r00, lane) * x + of_lane(r01, lane) * y + of_lane(to_e, lane) * f)
            v[k, lane] = y + (of_lane(r10, lane) * x + of_lane(r11, lane) * y + of_lane(to_v, lane) * f)


@numba.njit(cache=True, nogil=True)
def settle(sway, limits, e, v, pressure, pairs):  # pragma: no cover  (compiled)
    """Set trees that hardly move in still air to rest. Writes the sway of e (d, lanes) to pairs[0]."""
    write_sway(sway, e, pairs[0])
    for lane in range(e.shape[1]):
        if pressure[0, lane] != 0.0 or pressure[1, lane] != 0.0:
            continue
        small = MODAL_REST * of_lane(limits[0], lane)
        reach = max(abs(of_lane(sway[0, 0], lane)), abs(of_lane(sway[1, 0], lane)))
        if max(abs(pairs[0, 0, lane]), abs(pairs[0, 1, lane])) > small:
            continue
        vx, vy, largest = 0.0, 0.0, 0.0
        for k in range(len(e)):
            vx += of_lane(sway[0, k], lane) * v[k, lane]
            vy += of_lane(sway[1, k], lane) * v[k, lane]
            largest = max(largest, abs(e[k, lane]))
        if max(abs(vx), abs(vy)) <= MODAL_REST * of_lane(limits[1], lane) and largest * reach < small:
            e[:, lane] = 0.0
            v[:, lane] = 0.0
            pairs[0, :, lane] = 0.0


@numba.njit(cache=True, nogil=True)
def _write_poses(tensors, batch, count, state):  # pragma: no cover  (compiled)
    """Move ``now`` to ``before``, write the new poses to ``now``, and the extrapolation ratios."""
    _, _, _, _, shown, pose, limits, _, _, _, _, _, _, _, _ = tensors
    e, _, pressure, felt, _, _, pairs, terms, total, _, tree, _ = batch
    _, _, _, now, before, extrapolation_ratio = state
    d = len(e)
    for lane in range(count):
        x, y = pairs[0, 0, lane], pairs[0, 1, lane]
        px, pz = pressure[0, lane], pressure[1, lane]
        if tree[lane] >= 0:
            extrapolation_ratio[tree[lane]] = max(
                np.sqrt(x * x + y * y) / of_lane(limits[0], lane),
                np.sqrt(px * px + pz * pz) / of_lane(limits[2], lane),
            )
    write_pose_terms(limits, e, felt, pairs[0], terms)
    write_product(pose, terms[: pose.shape[1]], total[: len(pose)])
    for lane in range(count):
        i = tree[lane]
        if i < 0:
            continue
        for k in range(d):
            before[i, k] = now[i, k]
            now[i, k] = of_lane(shown[k], lane) * e[k, lane]
        for k in range(len(pose)):
            before[i, d + k] = now[i, d + k]
            now[i, d + k] = total[k, lane]


@numba.njit(cache=True, nogil=True)
def _write_wind(tensors, batch, count, gusts):  # pragma: no cover  (compiled)
    """Write the batch's gusts at the places, the mean over the crown, and the wind at the drag points, Pa.

    The first are the last rows of what drives the trees: along x at all places, then along z. ``gusts`` as in
    ``advance_trees``; without columns there are none.
    """
    _, _, _, force, _, _, _, point, _, _, _, _, drag_place, mean, _ = tensors
    _, _, pressure, felt, air, _, _, _, _, _, tree, factors = batch
    places, points = len(mean), len(point)
    first = force.shape[1] - 2 * places
    local_x, local_z = factors[first : first + places], factors[first + places : first + 2 * places]
    felt[:] = pressure
    if gusts.shape[1] == 0:
        local_x[:] = 0.0
        local_z[:] = 0.0
        air[:points], air[points:] = pressure[0], pressure[1]
        return
    for lane in range(count):
        own, x, z = gusts[max(tree[lane], 0)], pressure[0, lane], pressure[1, lane]
        mean_x = mean_z = 0.0
        for g in range(places):
            along, across = own[2 * g], own[2 * g + 1]
            local_x[g, lane], local_z[g, lane] = along * x - across * z, along * z + across * x
            mean_x += of_lane(mean[g], lane) * along
            mean_z += of_lane(mean[g], lane) * across
        felt[0, lane] += mean_x * x - mean_z * z
        felt[1, lane] += mean_x * z + mean_z * x
    write_product(drag_place, local_x, air[:points])
    write_product(drag_place, local_z, air[points:])
    for j in range(points):
        for lane in range(count):
            air[j, lane] += pressure[0, lane]
            air[points + j, lane] += pressure[1, lane]


@numba.njit(cache=True, nogil=True)
def step_trees(tensors, half_s, batch, count, gusts, state):  # pragma: no cover  (compiled)
    """Step the ``count`` trees whose indices are in the batch; those below 0 keep their state."""
    own_e, own_v, pressure, _, _, _, _, _, _, _, tree, _ = batch
    e, v, turned, _, _, _ = state
    for lane in range(count):
        i = max(tree[lane], 0)
        pressure[0, lane], pressure[1, lane] = turned[i, 0], turned[i, 1]
        for k in range(len(own_e)):
            own_e[k, lane], own_v[k, lane] = e[i, k], v[i, k]
    _write_wind(tensors, batch, count, gusts)
    _step(tensors, half_s, batch)
    settle(tensors[2], tensors[6], own_e, own_v, pressure, batch[6])
    for lane in range(count):
        i = tree[lane]
        for k in range(len(own_e)):
            if i >= 0:
                e[i, k], v[i, k] = own_e[k, lane], own_v[k, lane]
    _write_poses(tensors, batch, count, state)


@numba.njit(cache=True, nogil=True)
def begin(rate, turn, wind, phase, state):  # pragma: no cover  (compiled)
    """Turn the pressures into the frames of the trees, and add the steps that become due."""
    pressure_x, pressure_z, _ = wind
    turned = state[2]
    for i in range(len(phase)):
        turned[i, 0] = turn[i, 0] * pressure_x[i] - turn[i, 1] * pressure_z[i]
        turned[i, 1] = turn[i, 1] * pressure_x[i] + turn[i, 0] * pressure_z[i]
        phase[i] += rate[i]


@numba.njit(cache=True, nogil=True)
def display(phase, state, q):  # pragma: no cover  (compiled)
    """Write the poses between the last two steps to q."""
    _, _, _, now, before, _ = state
    for i in range(len(phase)):
        phase[i] -= np.floor(phase[i])
        for k in range(now.shape[1]):
            q[i, k] = before[i, k] + (now[i, k] - before[i, k]) * phase[i]


@numba.njit(cache=True, nogil=True)
def advance_trees(tensors, half_s, batch, rate, turn, wind, phase, state, q):  # pragma: no cover  (compiled)
    """Advance all trees by ``rate`` steps each (count,) and write the interpolated poses to q.

    q is (count, r).

    ``tensors`` is from ``float64_tensors``, ``batch`` from ``working_room``; ``half_s`` is half a step, s.
    ``turn`` is cosine and sine of the yaw; ``wind`` the pressure at the trees along x, along z, (count,) Pa,
    and the relative gusts (count, 2G) of ``write_gusts`` at the places, or (count, 0). Updates phase (count,)
    and ``state`` in place: e, v (count, d), the pressures in the frames of the trees (count, 2), the poses of
    the last step and of that before (count, r), and the extrapolation ratios (count,).
    """
    begin(rate, turn, wind, phase, state)
    tree, gusts = batch[10], wind[2]
    for _ in range(MAX_STEPS_PER_ADVANCE):
        count = stepped = 0
        for i in range(len(phase)):
            if phase[i] >= 1.0:
                phase[i] -= 1.0
                tree[count] = i
                count += 1
            if count == len(tree) or (count > 0 and i == len(phase) - 1):
                step_trees(tensors, half_s, batch, count, gusts, state)
                stepped += count
                count = 0
        if stepped == 0:
            break
    display(phase, state, q)


def float64_tensors(modal: ModalTensors) -> tuple[Floats | float, ...]:
    """The tensors in float64, as the step uses them; force and pose (r − d, terms) are transposed.

    The force (d, F + 2G) ends with the loads of the places, as what drives the trees ends with their gusts.
    Then come those of the drag (``drag_tensors``), the places' shares in the gusts at its points (m, G) and
    in the mean gust (G,), and the terms' shares in sums (sums, F): none.
    """
    t = modal
    force = np.concatenate([t.force.T, t.place_load.reshape(len(t.step), -1)], axis=1)
    tensors = (t.step, t.load, t.sway, force, t.shown, t.pose.T, t.limits)
    wide = tuple(np.ascontiguousarray(tensor, np.float64) for tensor in tensors)
    drag = drag_tensors(t.drag_point, t.drag_shape, t.drag_rest, t.streamlined_exponent)
    shares = np.zeros((0, len(t.force)))  # the terms themselves drive the trees
    return *wide, *drag, np.ascontiguousarray(t.drag_place, np.float64), t.mean_gust, shares


def working_room(modal: ModalTensors, count: int, sums: int = -1) -> tuple[Array, ...]:
    """Work arrays of a batch: e, v, the pressures at the tree, in the mean over the crown and at the drag
    points, prediction, pairs, terms, forces, drag, tree indices, and what drives the trees: the terms, or so
    many sums of them, and the gusts. A forest of ``count`` trees needs no wider ones than that.
    """
    lanes = max(1, min(count, BATCH_TREES))
    d, points = len(modal.step), len(modal.drag_point)
    terms = np.zeros((max(len(modal.force) + 2 * len(modal.place), len(modal.pose)), lanes))
    factors = terms if sums < 0 else np.zeros((sums + 2 * len(modal.place), lanes))
    heights = (d, d, 2, 2, 2 * points, d)
    rooms = [np.zeros((height, lanes)) for height in heights]
    total = np.zeros((max(d, modal.pose.shape[1]), lanes))
    moved = np.zeros((3 * points + 2, lanes))
    return (
        *rooms,
        np.zeros((3, 2, lanes)),
        terms,
        total,
        moved,
        np.zeros(lanes, np.int64),
        factors,
    )
