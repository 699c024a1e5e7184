"""The drift-free method: a few oscillators of the tree's own, stepped exactly, bent by a small force.

State of a tree: d modal coordinates e (m·√kg) about its gravity rest pose and their velocities v. A step is
the finite elements' own linear step, diagonal in e, under the wind's load and a force that is polynomial in
the two sway coordinates (docs/design/0005-drift-free-motion.md). The shown pose is e itself, and a few modes
more that follow e and the pressure at once, bending included. Trees are stepped side by side, LANES at a
time, so that the compiler can use the whole width of the machine and BLAS sums the terms. web/src/tangent.ts
is the same arithmetic.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

from precompute.paced import MAX_STEPS_PER_ADVANCE, PacedTrees

Array = npt.NDArray[Any]
Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]

LANES = 32
"""Trees whose terms are multiplied at once, by BLAS: few enough that it does so on one core."""
REACH = 1.25
"""The polynomials are held where they are beyond this multiple of the sampled range: their force stays
bounded, and the linear step that it drives is contracting, so any bounded wind gives a bounded motion."""
REST = 1e-7
"""In still air a motion below this share of the sampled range ends, exactly."""


@dataclass(frozen=True)
class Tangent:
    """Tensors of the method: d dynamic coordinates, c coupled ones, r ≥ d shown modes, F = 44 + 6c terms.

    A step of an oscillator under a force f is e' = r00 e + r01 v + s0 f, v' = r10 e + r11 v + s1 f.
    """

    step: Singles  # (d, 6) r00 − 1, r01, r10, r11 − 1, s0, s1
    load: Singles  # (d, 2) modal force per Pa of pressure along x and z
    sway: Singles  # (2, d) the two sway coordinates, 1 at the edge of the sampled range
    force: Singles  # (F, d)
    shown: Singles  # (d,) m of q_k per unit of e_k
    pose: Singles  # (d + 2 + 7 + 2c, r − d) m of the further q per unit
    limits: Singles  # (3 + 2c,) sampled range: sway, its speed 1/s, pressure Pa; coupled coordinates, speeds

    @property
    def coupled(self) -> int:
        """c: products of the coordinates numbered 2 to 2 + c with the sway and the pressure are kept."""
        return coupled_of(self.limits)

    @property
    def modes(self) -> int:
        return len(self.shown) + self.pose.shape[1]


@numba.njit(cache=True, nogil=True)
def coupled_of(limits):  # pragma: no cover  (compiled)
    """c, of the sampled range (3 + 2c,)."""
    return (len(limits) - 3) // 2


def shape_terms(coupled: int) -> int:
    return 7 + 2 * coupled


def force_terms(coupled: int) -> int:
    return shape_terms(coupled) + 37 + 4 * coupled


# ---- terms: every array's last axis runs over trees side by side, or over the frames of a run ------------


@numba.njit(cache=True, nogil=True)
def write_shape(pair, e, limits, out):  # pragma: no cover  (compiled)
    """Terms in the pose alone: sway of degree 2 and 3, then each coupled coordinate times the sway."""
    for lane in range(pair.shape[1]):
        x, y = pair[0, lane], pair[1, lane]
        xx, xy, yy = x * x, x * y, y * y
        out[0, lane], out[1, lane], out[2, lane] = xx, xy, yy
        out[3, lane], out[4, lane], out[5, lane], out[6, lane] = xx * x, xx * y, x * yy, yy * y
    for j in range(coupled_of(limits)):
        far = REACH * limits[3 + j]
        for lane in range(pair.shape[1]):
            z = min(max(e[2 + j, lane], -far), far)
            out[7 + 2 * j, lane] = z * pair[0, lane]
            out[8 + 2 * j, lane] = z * pair[1, lane]


@numba.njit(cache=True, nogil=True)
def write_motion(pair, speed, pressure, out, at):  # pragma: no cover  (compiled)
    """Terms with the sway's speed and with the pressure.

    A bent tree has centrifugal forces, damps otherwise (β acts on its elements as they stand) and is pushed
    otherwise.
    """
    for lane in range(pair.shape[1]):
        x, y, u, v = pair[0, lane], pair[1, lane], speed[0, lane], speed[1, lane]
        uu, uv, vv = u * u, u * v, v * v
        out[at, lane], out[at + 1, lane], out[at + 2, lane] = uu, uv, vv
        out[at + 3, lane], out[at + 4, lane], out[at + 5, lane] = uu * x, uu * y, uv * x
        out[at + 6, lane], out[at + 7, lane], out[at + 8, lane] = uv * y, vv * x, vv * y
    at += 9
    for side in range(2):
        slow, pushed = at + 5 * side, at + 10 + 9 * side
        for lane in range(pair.shape[1]):
            x, y, u, p = pair[0, lane], pair[1, lane], speed[side, lane], pressure[side, lane]
            out[slow, lane], out[slow + 1, lane] = u * x, u * y
            out[pushed, lane], out[pushed + 1, lane] = p * x, p * y
            for k in range(3):
                out[slow + 2 + k, lane] = u * out[k, lane]
            for k in range(7):
                out[pushed + 2 + k, lane] = p * out[k, lane]


@numba.njit(cache=True, nogil=True)
def write_coupled(pair, pressure, e, v, limits, out, at):  # pragma: no cover  (compiled)
    """Each coupled coordinate's speed times the sway, and the coordinate times the pressure.

    A bough of a bent tree damps otherwise, and one that is bent itself is pushed otherwise.
    """
    count = coupled_of(limits)
    for j in range(count):
        far, fast = REACH * limits[3 + j], REACH * limits[3 + count + j]
        for lane in range(pair.shape[1]):
            z = min(max(e[2 + j, lane], -far), far)
            w = min(max(v[2 + j, lane], -fast), fast)
            out[at + 4 * j, lane] = w * pair[0, lane]
            out[at + 4 * j + 1, lane] = w * pair[1, lane]
            out[at + 4 * j + 2, lane] = z * pressure[0, lane]
            out[at + 4 * j + 3, lane] = z * pressure[1, lane]


@numba.njit(cache=True, nogil=True)
def hold(pair, far):  # pragma: no cover  (compiled)
    """Draw every (x, y) back to length ``far`` where it is longer."""
    for lane in range(pair.shape[1]):
        size = np.sqrt(pair[0, lane] * pair[0, lane] + pair[1, lane] * pair[1, lane])
        back = far / size if size > far else 1.0
        pair[0, lane] *= back
        pair[1, lane] *= back


@numba.njit(cache=True, nogil=True)
def write_sway(sway, values, out):  # pragma: no cover  (compiled)
    """The two sway coordinates (2, lanes) of values (d, lanes)."""
    out[:] = 0.0
    for k in range(len(values)):
        for lane in range(values.shape[1]):
            out[0, lane] += sway[0, k] * values[k, lane]
            out[1, lane] += sway[1, k] * values[k, lane]


@numba.njit(cache=True, nogil=True)
def write_force_terms(sway, limits, half_s, e, v, pressure, ahead, pairs, out):  # pragma: no cover
    """All terms of the force at the middle of the coming step, as far as the state now tells.

    ahead (d, lanes) and pairs (3, 2, lanes) are room to work in.
    """
    for k in range(len(e)):
        for lane in range(e.shape[1]):
            ahead[k, lane] = e[k, lane] + half_s * v[k, lane]
    write_sway(sway, ahead, pairs[0])
    write_sway(sway, v, pairs[1])
    pairs[2] = pressure
    for i in range(3):
        hold(pairs[i], REACH * limits[i])
    write_shape(pairs[0], ahead, limits, out)
    at = 7 + 2 * coupled_of(limits)
    write_motion(pairs[0], pairs[1], pairs[2], out, at)
    write_coupled(pairs[0], pairs[2], ahead, v, limits, out, at + 37)


@numba.njit(cache=True, nogil=True)
def write_pose_terms(limits, e, pressure, pair, out):  # pragma: no cover  (compiled)
    """e, the pressure, and the terms in the pose; pair: the sway of e, which is held in place."""
    d = len(e)
    out[:d] = e
    out[d : d + 2] = pressure
    hold(pair, REACH * limits[0])
    write_shape(pair, e, limits, out[d + 2 :])


# ---- a step of LANES trees -------------------------------------------------------------------------------


@numba.njit(cache=True, nogil=True)
def _step(tensors, half_s, lanes):  # pragma: no cover  (compiled)
    """Advance the trees in the lanes by the table's step."""
    step, load, sway, force, _, _, limits = tensors
    e, v, pressure, ahead, pairs, terms, total, _ = lanes
    write_force_terms(sway, limits, half_s, e, v, pressure, ahead, pairs, terms)
    np.dot(force, terms[: force.shape[1]], total[: len(e)])
    for k in range(len(e)):
        a, b, c, d, s0, s1 = step[k]
        for lane in range(LANES):
            pushed = load[k, 0] * pressure[0, lane] + load[k, 1] * pressure[1, lane]
            x, y, f = e[k, lane], v[k, lane], total[k, lane] + pushed
            e[k, lane] = x + (a * x + b * y + s0 * f)
            v[k, lane] = y + (c * x + d * y + s1 * f)


@numba.njit(cache=True, nogil=True)
def _settle(sway, limits, lanes):  # pragma: no cover  (compiled)
    """Bring trees to rest that move too little to matter in still air. Leaves the sway of e in pairs[0]."""
    e, v, pressure, _, pairs, _, _, _ = lanes
    write_sway(sway, e, pairs[0])
    small, reach = REST * limits[0], max(abs(sway[0, 0]), abs(sway[1, 0]))
    for lane in range(LANES):
        if pressure[0, lane] != 0.0 or pressure[1, lane] != 0.0:
            continue
        if max(abs(pairs[0, 0, lane]), abs(pairs[0, 1, lane])) > small:
            continue
        vx, vy, largest = 0.0, 0.0, 0.0
        for k in range(len(e)):
            vx += sway[0, k] * v[k, lane]
            vy += sway[1, k] * v[k, lane]
            largest = max(largest, abs(e[k, lane]))
        if max(abs(vx), abs(vy)) <= REST * limits[1] and largest * reach < small:
            e[:, lane] = 0.0
            v[:, lane] = 0.0
            pairs[0, :, lane] = 0.0


@numba.njit(cache=True, nogil=True)
def _show(tensors, lanes, tree, count, now, before, coverage):  # pragma: no cover  (compiled)
    """The poses of the states now, those before kept; and how far into the sampled range the trees are."""
    _, _, _, _, shown, pose, limits = tensors
    e, _, pressure, _, pairs, terms, total, _ = lanes
    d = len(e)
    for lane in range(count):
        x, y = pairs[0, 0, lane], pairs[0, 1, lane]
        px, pz = pressure[0, lane], pressure[1, lane]
        coverage[tree[lane]] = max(np.sqrt(x * x + y * y) / limits[0], np.sqrt(px * px + pz * pz) / limits[2])
    write_pose_terms(limits, e, pressure, pairs[0], terms)
    np.dot(pose, terms[: pose.shape[1]], total[: len(pose)])
    for lane in range(count):
        i = tree[lane]
        for k in range(d):
            before[i, k] = now[i, k]
            now[i, k] = shown[k] * e[k, lane]
        for k in range(len(pose)):
            before[i, d + k] = now[i, d + k]
            now[i, d + k] = total[k, lane]


@numba.njit(cache=True, nogil=True)
def _step_trees(tensors, half_s, lanes, count, turned, e, v, now, before, coverage):  # pragma: no cover
    """Step the ``count`` trees named in the lanes."""
    own_e, own_v, pressure, _, _, _, _, tree = lanes
    for lane in range(count):
        i = tree[lane]
        pressure[0, lane], pressure[1, lane] = turned[i, 0], turned[i, 1]
        for k in range(len(own_e)):
            own_e[k, lane], own_v[k, lane] = e[i, k], v[i, k]
    _step(tensors, half_s, lanes)
    _settle(tensors[2], tensors[6], lanes)
    for lane in range(count):
        i = tree[lane]
        for k in range(len(own_e)):
            e[i, k], v[i, k] = own_e[k, lane], own_v[k, lane]
    _show(tensors, lanes, tree, count, now, before, coverage)


@numba.njit(cache=True, nogil=True)
def _advance(
    tensors, half_s, rate, turn, pressure_x, pressure_z, e, v, phase, turned, now, before, q, coverage, lanes
):  # pragma: no cover  (compiled)
    for i in range(len(phase)):
        turned[i, 0] = turn[i, 0] * pressure_x[i] - turn[i, 1] * pressure_z[i]
        turned[i, 1] = turn[i, 1] * pressure_x[i] + turn[i, 0] * pressure_z[i]
        phase[i] += rate[i]
    tree = lanes[7]
    for _ in range(MAX_STEPS_PER_ADVANCE):
        count = stepped = 0
        for i in range(len(phase)):
            if phase[i] >= 1.0:
                phase[i] -= 1.0
                tree[count] = i
                count += 1
            if count == LANES or (count > 0 and i == len(phase) - 1):
                _step_trees(tensors, half_s, lanes, count, turned, e, v, now, before, coverage)
                stepped += count
                count = 0
        if stepped == 0:
            break
    for i in range(len(phase)):
        phase[i] -= np.floor(phase[i])
        for k in range(q.shape[1]):
            q[i, k] = before[i, k] + (now[i, k] - before[i, k]) * phase[i]


def widened(tangent: Tangent) -> tuple[Floats, ...]:
    """The tensors in the type that steps are computed in; force (d, F) and pose (r − d, terms) turned."""
    t = tangent
    tensors = (t.step, t.load, t.sway, t.force.T, t.shown, t.pose.T, t.limits)
    return tuple(np.ascontiguousarray(tensor, np.float64) for tensor in tensors)


def working_room(tangent: Tangent) -> tuple[Array, ...]:
    """Lanes for e, v, pressure, e ahead, three pairs, terms, sums, and the trees that are in them."""
    d = len(tangent.step)
    terms = max(len(tangent.force), len(tangent.pose))
    heights = (d, d, 2, d)
    rooms = [np.zeros((height, LANES)) for height in heights]
    total = np.zeros((max(d, tangent.pose.shape[1]), LANES))
    return (*rooms, np.zeros((3, 2, LANES)), np.zeros((terms, LANES)), total, np.zeros(LANES, np.int64))


class TangentForest(PacedTrees):
    """Trees of one table, each with its own state, in its own frame and at its own pace."""

    def __init__(self, tangent: Tangent, dt_s: float, mode_scale: Singles, count: int) -> None:
        """``count`` trees at rest; dt_s is the table's step, mode_scale (r,) the stream's unit of q."""
        super().__init__(count, mode_scale, dt_s)
        self._tensors, self._lanes = widened(tangent), working_room(tangent)
        d = len(tangent.step)
        self._e, self._v = np.zeros((count, d)), np.zeros((count, d))
        self._turned = np.zeros((count, 2))
        self.coverage = np.zeros(count, np.float32)
        """(count,) how far into the sampled range of sway and pressure a tree is: above 1 it is beyond it."""

    def advance(self, dt_s: float, pressure_x: npt.ArrayLike, pressure_z: npt.ArrayLike) -> None:
        """Let dt_s seconds pass under world pressures (count,) in Pa; large trees sway slower."""
        px, pz = self._passing(dt_s, pressure_x, pressure_z)
        _advance(
            self._tensors, self._dt_s / 2, self._rate, self._turn, px, pz, self._e, self._v, self._phase,
            self._turned, self._now, self._before, self.q, self.coverage, self._lanes,
        )  # fmt: skip
