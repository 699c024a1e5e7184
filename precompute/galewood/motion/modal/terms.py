"""Polynomial terms of the modal model's force and pose.

The last axis of every array runs over the trees of a batch, or over the frames of a run. ``sway`` and
``limits`` are those of one table, or have that axis, too (``lanes``).
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import numba
import numpy as np

from galewood.constants import MODAL_REACH
from galewood.motion.modal.lanes import of_lane
from galewood.motion.modal.tensors import coupled_of


@numba.njit(cache=True, nogil=True)
def write_shape(pair, e, limits, out):  # pragma: no cover  (compiled)
    """Terms in the pose: sway products of degree 2 and 3, then each coupled coordinate times the sway."""
    for lane in range(pair.shape[1]):
        x, y = pair[0, lane], pair[1, lane]
        xx, xy, yy = x * x, x * y, y * y
        out[0, lane], out[1, lane], out[2, lane] = xx, xy, yy
        out[3, lane], out[4, lane], out[5, lane], out[6, lane] = xx * x, xx * y, x * yy, yy * y
    for j in range(coupled_of(limits)):
        largest = limits[3 + j]
        for lane in range(pair.shape[1]):
            far = MODAL_REACH * of_lane(largest, lane)
            z = min(max(e[2 + j, lane], -far), far)
            out[7 + 2 * j, lane] = z * pair[0, lane]
            out[8 + 2 * j, lane] = z * pair[1, lane]


@numba.njit(cache=True, nogil=True)
def write_motion(pair, speed, pressure, out, at):  # pragma: no cover  (compiled)
    """Terms with the speed of the sway and with the pressure.

    In a bent tree there are centrifugal forces, and damping (β acts on the current elements) and wind load
    change with the pose.
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
    """Terms of the speed of each coupled coordinate times the sway, and of the coordinate times the pressure.

    The damping of a branch changes as the tree bends, and its wind load as the branch itself bends.
    """
    count = coupled_of(limits)
    for j in range(count):
        largest, fastest = limits[3 + j], limits[3 + count + j]
        for lane in range(pair.shape[1]):
            far, fast = MODAL_REACH * of_lane(largest, lane), MODAL_REACH * of_lane(fastest, lane)
            z = min(max(e[2 + j, lane], -far), far)
            w = min(max(v[2 + j, lane], -fast), fast)
            out[at + 4 * j, lane] = w * pair[0, lane]
            out[at + 4 * j + 1, lane] = w * pair[1, lane]
            out[at + 4 * j + 2, lane] = z * pressure[0, lane]
            out[at + 4 * j + 3, lane] = z * pressure[1, lane]


@numba.njit(cache=True, nogil=True)
def hold(pair, limit):  # pragma: no cover  (compiled)
    """Shorten every (x, y) to ``MODAL_REACH`` times the limit where it is longer."""
    for lane in range(pair.shape[1]):
        far = MODAL_REACH * of_lane(limit, lane)
        size = np.sqrt(pair[0, lane] * pair[0, lane] + pair[1, lane] * pair[1, lane])
        back = far / size if size > far else 1.0
        pair[0, lane] *= back
        pair[1, lane] *= back


@numba.njit(cache=True, nogil=True)
def write_sway(sway, values, out):  # pragma: no cover  (compiled)
    """Sway coordinates (2, lanes) of values (d, lanes)."""
    out[:] = 0.0
    for k in range(len(values)):
        x, y = sway[0, k], sway[1, k]
        for lane in range(values.shape[1]):
            out[0, lane] += of_lane(x, lane) * values[k, lane]
            out[1, lane] += of_lane(y, lane) * values[k, lane]


@numba.njit(cache=True, nogil=True)
def write_force_terms(sway, limits, half_s, e, v, pressure, ahead, pairs, out):  # pragma: no cover
    """All force terms at the middle of the next step, predicted from e and v.

    ``pressure`` (2, lanes) is the mean over the crown, Pa.

    ahead (d, lanes) and pairs (3, 2, lanes) are work arrays.
    """
    for k in range(len(e)):
        for lane in range(e.shape[1]):
            ahead[k, lane] = e[k, lane] + half_s * v[k, lane]
    write_sway(sway, ahead, pairs[0])
    write_sway(sway, v, pairs[1])
    pairs[2] = pressure
    for i in range(3):
        hold(pairs[i], limits[i])
    write_shape(pairs[0], ahead, limits, out)
    at = 7 + 2 * coupled_of(limits)
    write_motion(pairs[0], pairs[1], pairs[2], out, at)
    write_coupled(pairs[0], pairs[2], ahead, v, limits, out, at + 37)


@numba.njit(cache=True, nogil=True)
def write_pose_terms(limits, e, pressure, pair, out):  # pragma: no cover  (compiled)
    """Terms of the pose: e, the pressure, and products; pair is the sway of e and is clamped in place."""
    d = len(e)
    out[:d] = e
    out[d : d + 2] = pressure
    hold(pair, limits[0])
    write_shape(pair, e, limits, out[d + 2 :])
