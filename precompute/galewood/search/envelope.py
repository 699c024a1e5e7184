"""Drops candidates that win under no pressure: a conservative lower envelope of the costs.

Candidate j of state c costs E_j + λ g(f − f_j) under the pressure f (Eq. 16 over 1 − w, λ = w / (1 − w)). It
can win only near f_j, as the successor costs at most λ. That square is covered by boxes, subdivided as
needed. If each box has a rival that is cheaper everywhere in it, j is dropped
(docs/design/0001-exact-search.md).
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math

import numba
import numpy as np

STEEPEST = 2.0 * math.exp(-0.5)
"""Largest slope of g_j − g_k per σ: that of each Gaussian is at most exp(−1/2) / σ."""
SMALLEST_BOX = 1.0 / 12.0
"""Smallest half-width of a box, in σ: if that is not decisive, the candidate stays."""
NEAR = 1.4
"""Rivals are the successor and the candidates within this distance, in σ."""
DEPTH = 64
"""Capacity of the stack of boxes."""


@numba.njit(cache=True, nogil=True)
def _beats(gap, near_j, k_at, apart, x, z, reach, leverage):  # pragma: no cover  (compiled)
    """Compare rival k with j in a box (centre x, z, half-diagonal ``reach``, in σ).

    Returns 1 if k is cheaper in the whole box, 2 if only at its centre, 0 if not even there. gap: E_j − E_k;
    near_j: 1 − g_j at the centre.
    """
    kx, kz = x - k_at[0], z - k_at[1]
    better = math.exp(-0.5 * (kx * kx + kz * kz)) - near_j
    change = reach * min(apart, STEEPEST)  # the Hessian of g has norm 1/σ² at most
    if gap + leverage[0] * (better - change) > 0.0 and gap + leverage[1] * (better - change) > 0.0:
        return 1
    return 2 if gap + leverage[0] * better > 0.0 and gap + leverage[1] * better > 0.0 else 0


@numba.njit(cache=True, nogil=True)
def _may_win(error, j_at, errors, at, apart, count, radius, leverage, margin):  # pragma: no cover  (compiled)
    """Whether record j may win somewhere within ``radius`` (σ) against ``count`` rivals."""
    stack = np.empty((DEPTH, 3))
    stack[0] = j_at[0], j_at[1], radius
    depth, last = 1, 0
    while depth > 0:
        depth -= 1
        x, z, half = stack[depth]
        reach = half * math.sqrt(2.0)
        if math.hypot(x - j_at[0], z - j_at[1]) - reach > radius:
            continue
        jx, jz = x - j_at[0], z - j_at[1]
        near_j = math.exp(-0.5 * (jx * jx + jz * jz))
        centre_beaten = beaten = False
        for i in range(count):
            k = (last + i) % count  # start with the rival that won the last box
            gap = error - errors[k] - margin
            found = _beats(gap, near_j, at[k], apart[k], x, z, reach, leverage)
            if found == 1:
                beaten, last = True, k
                break
            centre_beaten = centre_beaten or found == 2
        if beaten:
            continue
        if not centre_beaten or half < SMALLEST_BOX or depth + 4 > DEPTH:
            return True
        for s in range(4):
            side_x = 0.5 * half if s % 2 else -0.5 * half
            side_z = 0.5 * half if s // 2 else -0.5 * half
            stack[depth] = x + side_x, z + side_z, 0.5 * half
            depth += 1
    return False


@numba.njit(cache=True, nogil=True)
def keep_winners(c, row, pressure, calm, sigma, leverage, components, margin, kept, count):
    """Drop candidates from ``kept`` that win nowhere; return the number that remains.

    c: the state, whose successor is kept[0] and not the end of a trajectory; row (z,): mismatches; leverage:
    w / (1 − w) at both ends of the range of w. Candidates of the other air than that of the state belong to
    separate queries and stay, except those of moving air for a state of still air.
    """  # pragma: no cover  (compiled)
    errors, at = np.empty(count), np.empty((count, 2))
    for s in range(count):
        errors[s] = row[kept[s]] / components
        at[s] = pressure[kept[s], 0] / sigma, pressure[kept[s], 1] / sigma
    rivals = np.empty(count)
    rival_at, apart = np.empty((count, 2)), np.empty(count)
    stays = np.ones(count, np.bool_)
    for s in range(1, count):
        if calm[kept[s]] and not calm[c]:
            continue
        if errors[s] <= margin:
            continue  # may win at any distance
        room = (errors[s] - margin) / leverage[1]
        if room >= 1.0:
            stays[s] = False
            continue
        n = 0
        for k in range(count):
            dx, dz = at[k, 0] - at[s, 0], at[k, 1] - at[s, 1]
            squared = dx * dx + dz * dz
            if k == s or (k > 0 and squared > NEAR * NEAR):
                continue
            if calm[c] or not calm[kept[k]]:
                rivals[n], apart[n] = errors[k], math.sqrt(squared)
                rival_at[n] = at[k]
                n += 1
        radius = math.sqrt(-2.0 * math.log(room))
        stays[s] = _may_win(errors[s], at[s], rivals, rival_at, apart, n, radius, leverage, margin)
    remain = 0
    for s in range(count):
        if stays[s]:
            kept[remain] = kept[s]
            remain += 1
    return remain
