"""Compiled kernels of bent rods (`bending.py`): their balance of moments, its derivative and its solution.

``shape`` is (parent, along, bending, twisting) of `Rods`.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math

import numba
import numpy as np

TOLERANCE_RAD = 1e-9
"""Largest step of a rotation at which the balance is reached."""
FARTHEST_STEP_RAD = 0.4
"""Longest step of Newton's method: rotations are not linear."""
MOST_STEPS = 60
"""Newton steps for one load."""


@numba.njit(cache=True, nogil=True)
def carried_loads(parent, load):  # pragma: no cover  (compiled)
    """(n, 3) sum of the loads outboard of each rod, N."""
    total = load.copy()
    for i in range(len(parent) - 1, 0, -1):
        for k in range(3):
            total[parent[i], k] += total[i, k]
    return total


@numba.njit(cache=True, nogil=True)
def _cross(a, b, out):  # pragma: no cover  (compiled)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        out[k] = a[i] * b[j] - a[j] * b[i]


@numba.njit(cache=True, nogil=True)
def _times(a, v, out):  # pragma: no cover  (compiled)
    """Product of a matrix (3, 3) and a vector (3,)."""
    for i in range(3):
        out[i] = a[i, 0] * v[0] + a[i, 1] * v[1] + a[i, 2] * v[2]


@numba.njit(cache=True, nogil=True)
def _product(a, b, out):  # pragma: no cover  (compiled)
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@numba.njit(cache=True, nogil=True)
def _inverse(a, out):  # pragma: no cover  (compiled)
    for i in range(3):
        for j in range(3):
            k, h, m, n = (j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3
            out[i, j] = a[k, m] * a[h, n] - a[k, n] * a[h, m]
    determinant = a[0, 0] * out[0, 0] + a[0, 1] * out[1, 0] + a[0, 2] * out[2, 0]
    for i in range(3):
        for j in range(3):
            out[i, j] /= determinant


@numba.njit(cache=True, nogil=True)
def rest_moments(parent, along, carried):  # pragma: no cover  (compiled)
    """(n, 3) moments of the rods that balance the carried weight in the given shape."""
    held, whole = np.zeros_like(along), np.empty(3)
    for i in range(len(parent) - 1, 0, -1):
        _cross(along[i], carried[i], whole)
        for k in range(3):
            held[i, k] += 0.5 * whole[k]
            held[parent[i], k] += held[i, k] + 0.5 * whole[k]
    return held


@numba.njit(cache=True, nogil=True)
def _turn_between(inner, outer, out):  # pragma: no cover  (compiled)
    """Rotation vector of innerᵀ outer, a rotation by less than π."""
    trace = 0.0
    for i in range(3):
        for k in range(3):
            trace += inner[k, i] * outer[k, i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        out[i] = 0.0
        for r in range(3):
            out[i] += (inner[r, k] * outer[r, j] - inner[r, j] * outer[r, k]) / 2
    sine = math.sqrt(out[0] ** 2 + out[1] ** 2 + out[2] ** 2)
    if sine > 1e-12:
        stretch = math.atan2(sine, (trace - 1) / 2) / sine
        for i in range(3):
            out[i] *= stretch


@numba.njit(cache=True, nogil=True)
def _turn(v, share, out):  # pragma: no cover  (compiled)
    """Rotation matrix of a share of a rotation vector (Rodrigues)."""
    x, y, z = share * v[0], share * v[1], share * v[2]
    square = x * x + y * y + z * z
    angle = math.sqrt(square)
    a = 1.0 - square / 6 if angle < 1e-4 else math.sin(angle) / angle
    b = 0.5 - square / 24 if angle < 1e-4 else (1.0 - math.cos(angle)) / square
    out[0, 0], out[0, 1], out[0, 2] = 1 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y
    out[1, 0], out[1, 1], out[1, 2] = b * x * y + a * z, 1 - b * (x * x + z * z), b * y * z - a * x
    out[2, 0], out[2, 1], out[2, 2] = b * x * z - a * y, b * y * z + a * x, 1 - b * (x * x + y * y)


@numba.njit(cache=True, nogil=True)
def _elastic(along, bending, twisting, turned, stiff, moment):  # pragma: no cover  (compiled)
    """C / L (3, 3) of a rod, and its moment (3,) by the rotation vector between its ends; in its own axes."""
    square = along[0] ** 2 + along[1] ** 2 + along[2] ** 2
    length = math.sqrt(square)
    for i in range(3):
        for j in range(3):
            stiff[i, j] = (twisting - bending) * along[i] * along[j] / (square * length)
        stiff[i, i] += bending / length
    _times(stiff, turned, moment)


@numba.njit(cache=True, nogil=True)
def moments_and_places(shape, turns):  # pragma: no cover  (compiled)
    """(n, 3) elastic moments of the rods, in their own axes, and displacements of their outer ends."""
    parent, along, bending, twisting = shape
    moment, moved = np.zeros_like(along), np.zeros_like(along)
    turned, axis = np.empty(3), np.empty(3)
    stiff, half, middle = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for i in range(1, len(parent)):
        p = parent[i]
        _turn_between(turns[p], turns[i], turned)
        _elastic(along[i], bending[i], twisting[i], turned, stiff, moment[i])
        _turn(turned, 0.5, half)
        _product(turns[p], half, middle)
        _times(middle, along[i], axis)
        for k in range(3):
            moved[i, k] = moved[p, k] + axis[k] - along[i, k]
    return moment, moved


@numba.njit(cache=True, nogil=True)
def moved_by(parent, axis, turned):  # pragma: no cover  (compiled)
    """(n, 3) displacement of the points by small rotations (n, 3) of rods that point along axis (n, 3)."""
    moved, mean, across = np.zeros_like(axis), np.empty(3), np.empty(3)
    for i in range(1, len(parent)):
        for k in range(3):
            mean[k] = 0.5 * (turned[parent[i], k] + turned[i, k])
        _cross(mean, axis[i], across)
        for k in range(3):
            moved[i, k] = moved[parent[i], k] + across[k]
    return moved


@numba.njit(cache=True, nogil=True)
def moments_about(parent, axis, load):  # pragma: no cover  (compiled)
    """(n, 3) moments on the points by forces (n, 3) on them: the transpose of ``moved_by``."""
    carried, moment, across = carried_loads(parent, load), np.zeros_like(axis), np.empty(3)
    for i in range(1, len(parent)):
        _cross(axis[i], carried[i], across)
        for k in range(3):
            moment[i, k] += 0.5 * across[k]
            moment[parent[i], k] += 0.5 * across[k]
    return moment


@numba.njit(cache=True, nogil=True)
def newton(shape, clamped, held, carried, turns):  # pragma: no cover  (compiled)
    """Balance of moments by Newton's method, from the rotations `turns`, in place; whether it was reached."""
    parent = shape[0]
    small, before = np.empty((3, 3)), np.empty((3, 3))
    for _ in range(MOST_STEPS):
        diagonal, to_inner, to_outer, lack = tangent(shape, held, carried, turns)
        step = solved(parent, clamped, diagonal, to_inner, to_outer, lack)
        longest = 0.0
        for i in range(len(parent)):
            longest = max(longest, math.sqrt(step[i, 0] ** 2 + step[i, 1] ** 2 + step[i, 2] ** 2))
        if not longest < 1e6:
            return False
        share = min(1.0, FARTHEST_STEP_RAD / max(longest, 1e-300))
        for i in range(1, len(parent)):
            if clamped[i] == 0:
                _turn(step[i], share, small)
                before[:] = turns[i]
                _product(small, before, turns[i])
        if longest < TOLERANCE_RAD:
            return True
    return False


@numba.njit(cache=True, nogil=True)
def tangent(shape, held, carried, turns):  # pragma: no cover  (compiled)
    """Derivative of the moments by the rotations, and what the moments lack of their balance (n, 3).

    Blocks (n, 3, 3): of each point, and of each rod, by the rotation of its inner end (of the balance at the
    outer one) and the reverse.
    """
    parent, along, bending, twisting = shape
    n = len(parent)
    diagonal, to_inner, to_outer = np.zeros((n, 3, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3, 3))
    lack = np.zeros((n, 3))
    turned, own, moment, axis, across = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    stiff, half, middle, part = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for i in range(1, n):
        p = parent[i]
        _turn_between(turns[p], turns[i], turned)
        _elastic(along[i], bending[i], twisting[i], turned, stiff, own)
        _turn(turned, 0.5, half)
        _product(turns[p], half, middle)
        for k in range(3):
            own[k] += held[i, k]
        _times(middle, own, moment)
        _times(middle, along[i], axis)
        force = carried[i]
        _cross(axis, force, across)
        _product(middle, stiff, part)
        pull = axis[0] * force[0] + axis[1] * force[1] + axis[2] * force[2]
        for r in range(3):
            for c in range(3):
                stiffness = part[r, 0] * middle[c, 0] + part[r, 1] * middle[c, 1] + part[r, 2] * middle[c, 2]
                loaded = 0.25 * axis[r] * force[c]
                spun = 0.0
                if r == c:
                    loaded -= 0.25 * pull
                else:  # half of the matrix of the cross product with the moment
                    other = 3 - r - c
                    spun = -0.5 * moment[other] if (r + 1) % 3 == c else 0.5 * moment[other]
                diagonal[i, r, c] += stiffness - spun - loaded
                diagonal[p, r, c] += stiffness + spun - loaded
                to_inner[i, r, c] = -stiffness - spun - loaded
                to_outer[i, r, c] = -stiffness + spun - loaded
            lack[i, r] += 0.5 * across[r] - moment[r]
            lack[p, r] += 0.5 * across[r] + moment[r]
    return diagonal, to_inner, to_outer, lack


@numba.njit(cache=True, nogil=True)
def solved(parent, clamped, diagonal, to_inner, to_outer, lack):  # pragma: no cover  (compiled)
    """(n, 3) rotations by elimination from the tips to the root; the blocks and ``lack`` are overwritten."""
    n = len(parent)
    inverse, passed, product = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    change, step = np.empty(3), np.zeros((n, 3))
    for i in range(n - 1, 0, -1):
        if clamped[i]:
            continue
        p = parent[i]
        _inverse(diagonal[i], inverse)
        _product(to_outer[i], inverse, passed)
        _product(passed, to_inner[i], product)
        _times(passed, lack[i], change)
        for r in range(3):
            lack[p, r] -= change[r]
            for c in range(3):
                diagonal[p, r, c] -= product[r, c]
                diagonal[i, r, c] = inverse[r, c]
    for i in range(1, n):
        if clamped[i] == 0:
            _times(to_inner[i], step[parent[i]], change)
            for k in range(3):
                change[k] = lack[i, k] - change[k]
            _times(diagonal[i], change, step[i])
    return step
