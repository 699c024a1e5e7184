"""Gradients of the modal step's force and drag by the state, for the fit (reverse-mode differentiation).

Each function adds to its outputs what a gradient by the terms, or by the force, means for the state they were
computed from. Where an argument of a polynomial is clamped, the gradient by it is zero.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import numba
import numpy as np

from galewood.constants import ISOTROPIC_DRAG, MODAL_REACH
from galewood.motion.modal.drag import TINY_PA
from galewood.motion.modal.tensors import coupled_of
from galewood.motion.modal.terms import hold, write_sway
from galewood.motion.wind import pressure_per_speed, speed_of_pressure


@numba.njit(cache=True, nogil=True)
def add_terms_gradient(
    sway, limits, half_s, e, v, pressure, by_terms, by_e, by_v
):  # pragma: no cover  (compiled)
    """Add to by_e, by_v (d, lanes) the gradient of Σ by_terms · terms, with by_terms (F, lanes).

    The terms are those of ``write_force_terms``; e, v (d, lanes), pressure (2, lanes) as there.
    """
    d, lanes = e.shape
    ahead = e + half_s * v
    free, pairs, by_pairs = np.empty((2, 2, lanes)), np.empty((3, 2, lanes)), np.zeros((2, 2, lanes))
    write_sway(sway, ahead, free[0])
    write_sway(sway, v, free[1])
    pairs[:2], pairs[2] = free, pressure
    for i in range(3):
        hold(pairs[i], limits[i])
    by_ahead = np.zeros((d, lanes))
    _add_sway_gradient(pairs, by_terms, 7 + 2 * coupled_of(limits), by_pairs)
    _add_coupled_gradient(pairs, ahead, v, limits, by_terms, by_pairs, by_ahead, by_v)
    for i in range(2):
        _release(free[i], MODAL_REACH * limits[i], by_pairs[i])
    for k in range(d):
        for lane in range(lanes):
            by_ahead[k, lane] += sway[0, k] * by_pairs[0, 0, lane] + sway[1, k] * by_pairs[0, 1, lane]
            by_e[k, lane] += by_ahead[k, lane]
            by_v[k, lane] += (
                half_s * by_ahead[k, lane]
                + sway[0, k] * by_pairs[1, 0, lane]
                + sway[1, k] * by_pairs[1, 1, lane]
            )


@numba.njit(cache=True, nogil=True)
def _add_sway_gradient(pairs, by_terms, at, by_pairs):  # pragma: no cover  (compiled)
    """By the sway (x, y) and its speed (u, v), of the terms that contain no other coordinate."""
    slow, pushed = at + 9, at + 19
    m = np.empty(7)  # gradient by the products of degree 2 and 3 of x and y, wherever they occur
    for lane in range(pairs.shape[2]):
        x, y, u, v = pairs[0, 0, lane], pairs[0, 1, lane], pairs[1, 0, lane], pairs[1, 1, lane]
        by_x = by_y = 0.0
        for k in range(7):
            m[k] = by_terms[k, lane]
        for side in range(2):
            w, p = pairs[1, side, lane], pairs[2, side, lane]
            a, b = slow + 5 * side, pushed + 9 * side
            by_x += w * by_terms[a, lane] + p * by_terms[b, lane]
            by_y += w * by_terms[a + 1, lane] + p * by_terms[b + 1, lane]
            of_speed = x * by_terms[a, lane] + y * by_terms[a + 1, lane]
            of_speed += x * x * by_terms[a + 2, lane] + x * y * by_terms[a + 3, lane]
            by_pairs[1, side, lane] += of_speed + y * y * by_terms[a + 4, lane]
            for k in range(3):
                m[k] += w * by_terms[a + 2 + k, lane]
            for k in range(7):
                m[k] += p * by_terms[b + 2 + k, lane]
        uu, uv, vv = by_terms[at, lane], by_terms[at + 1, lane], by_terms[at + 2, lane]
        uux, uuy, uvx = by_terms[at + 3, lane], by_terms[at + 4, lane], by_terms[at + 5, lane]
        uvy, vvx, vvy = by_terms[at + 6, lane], by_terms[at + 7, lane], by_terms[at + 8, lane]
        by_uv = uv + x * uvx + y * uvy
        by_pairs[1, 0, lane] += 2.0 * u * (uu + x * uux + y * uuy) + v * by_uv
        by_pairs[1, 1, lane] += 2.0 * v * (vv + x * vvx + y * vvy) + u * by_uv
        by_x += u * u * uux + u * v * uvx + v * v * vvx
        by_y += u * u * uuy + u * v * uvy + v * v * vvy
        by_x += 2.0 * x * m[0] + y * m[1] + 3.0 * x * x * m[3] + 2.0 * x * y * m[4] + y * y * m[5]
        by_y += x * m[1] + 2.0 * y * m[2] + x * x * m[4] + 2.0 * x * y * m[5] + 3.0 * y * y * m[6]
        by_pairs[0, 0, lane] += by_x
        by_pairs[0, 1, lane] += by_y


@numba.njit(cache=True, nogil=True)
def _add_coupled_gradient(
    pairs, ahead, v, limits, by_terms, by_pairs, by_ahead, by_v
):  # pragma: no cover  (compiled)
    """Of the terms with a coupled coordinate or its speed: by those, and by the sway."""
    count = coupled_of(limits)
    for j in range(count):
        far, fast = MODAL_REACH * limits[3 + j], MODAL_REACH * limits[3 + count + j]
        shape, moving = 7 + 2 * j, 7 + 2 * count + 37 + 4 * j
        for lane in range(pairs.shape[2]):
            x, y = pairs[0, 0, lane], pairs[0, 1, lane]
            z, w = min(max(ahead[2 + j, lane], -far), far), min(max(v[2 + j, lane], -fast), fast)
            zx, zy = by_terms[shape, lane], by_terms[shape + 1, lane]
            wx, wy = by_terms[moving, lane], by_terms[moving + 1, lane]
            by_pairs[0, 0, lane] += z * zx + w * wx
            by_pairs[0, 1, lane] += z * zy + w * wy
            if abs(ahead[2 + j, lane]) < far:
                pushed = pairs[2, 0, lane] * by_terms[moving + 2, lane]
                pushed += pairs[2, 1, lane] * by_terms[moving + 3, lane]
                by_ahead[2 + j, lane] += x * zx + y * zy + pushed
            if abs(v[2 + j, lane]) < fast:
                by_v[2 + j, lane] += x * wx + y * wy


@numba.njit(cache=True, nogil=True)
def _release(free, far, by_pair):  # pragma: no cover  (compiled)
    """Turn the gradient by a pair shortened by ``hold`` into that by the pair before, ``free``."""
    for lane in range(free.shape[1]):
        x, y = free[0, lane], free[1, lane]
        size = np.sqrt(x * x + y * y)
        if size > far:
            along = (x * by_pair[0, lane] + y * by_pair[1, lane]) / (size * size)
            by_pair[0, lane] = far / size * (by_pair[0, lane] - along * x)
            by_pair[1, lane] = far / size * (by_pair[1, lane] - along * y)


@numba.njit(cache=True, nogil=True)
def add_drag_gradient(
    point, inputs, outputs, rest, exponent, v, air, by_force, by_v
):  # pragma: no cover  (compiled)
    """Add to by_v (d, lanes) the gradient of Σ by_force · force, with the force of ``add_drag`` at v.

    by_force (d, lanes); the other arguments as there.
    """
    count, lanes = len(point), v.shape[1]
    moved = np.dot(inputs, v[: inputs.shape[1]])
    by_outputs = np.dot(outputs.T, by_force)
    by_moved = np.empty((3 * count, lanes))
    share_of = point[:, 0] / point[:, 0].sum()
    for lane in range(lanes):
        by_mean = 0.0
        for k in range(len(by_v)):
            by_mean -= ISOTROPIC_DRAG * rest[k] * v[k, lane] * by_force[k, lane]
        mean = 0.0
        for j in range(count):
            area, share = point[j, 0], point[j, 1]
            px, pz = air[j, lane], air[count + j, lane]
            wind_pa = np.sqrt(px * px + pz * pz)
            speed_ratio = speed_of_pressure(share * wind_pa, exponent) / max(wind_pa, TINY_PA)
            wx, wz = speed_ratio * px - moved[j, lane], speed_ratio * pz - moved[2 * count + j, lane]
            wy = -moved[count + j, lane]
            speed = np.sqrt(wx * wx + wy * wy + wz * wz)
            per_speed, power = pressure_per_speed(speed, exponent)
            mean += share_of[j] * per_speed
            gx, gy, gz = (
                area * by_outputs[j, lane],
                area * by_outputs[count + j, lane],
                area * by_outputs[2 * count + j, lane],
            )
            # the pressure over the speed grows with the power − 1 of the speed
            growth = (gx * wx + gy * wy + gz * wz + share_of[j] * by_mean) * (power - 1.0) * per_speed
            growth = growth / (speed * speed) if speed > 0.0 else 0.0
            by_moved[j, lane] = -(per_speed * gx + growth * wx)
            by_moved[count + j, lane] = -(per_speed * gy + growth * wy)
            by_moved[2 * count + j, lane] = -(per_speed * gz + growth * wz)
        for k in range(len(by_v)):
            by_v[k, lane] -= ISOTROPIC_DRAG * rest[k] * mean * by_force[k, lane]
    by_v[: inputs.shape[1]] += np.dot(inputs.T, by_moved)
