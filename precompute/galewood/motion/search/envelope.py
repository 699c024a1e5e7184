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

MAX_SLOPE = 2.0 * math.exp(-0.5)
"""Largest slope of g_j − g_k per σ: that of each Gaussian is at most exp(−1/2) / σ."""
SMALLEST_BOX = 1.0 / 12.0
"""Smallest half-width of a box, in σ: if that is not decisive, the candidate stays."""
NEAR_SIGMA = 1.4
"""Rivals are the successor and the candidates within this distance, in σ."""
VECTOR_LANES = 8
BLOCK_RIVALS = 4 * VECTOR_LANES
"""Rivals that are compared at a time, as vectors of VECTOR_LANES numbers."""
STACK_BOXES = 64
"""Capacity of the stack of boxes; a radius has at most 9 subdivisions, each of which adds 3 boxes."""
_TERMS = np.array([(-1.0) ** n / math.factorial(n) for n in range(6)])
"""Taylor series of exp(−t) for small t."""
_REDUCTIONS = 7


@numba.njit(cache=True, nogil=True)
def _gaussian(exponent):  # pragma: no cover  (compiled)
    """exp(−exponent) for exponent ≥ 0, by sums and products only, so that loops over it become vector code.

    The error is below 10⁻¹¹, far less than the margin of the rules.
    """
    t = min(exponent, 32.0) * 0.5**_REDUCTIONS
    p = _TERMS[5]
    for n in range(4, -1, -1):
        p = p * t + _TERMS[n]
    for _ in range(_REDUCTIONS):
        p = p * p
    return p


@numba.njit(cache=True, nogil=True)
def _cheaper(rivals, first, last, x, z, near_j, reach):  # pragma: no cover  (compiled)
    """Compare j with the rivals [first, last) in a box: centre (x, z) and half-diagonal ``reach`` in σ.

    rivals: see ``_may_win``; near_j: 1 − g_j at the centre. Returns the numbers of rivals that are cheaper in
    the whole box, and at its centre.
    """
    k_x, k_z = rivals[0, first:last], rivals[1, first:last]
    need, slope = rivals[2, first:last], rivals[3, first:last]
    everywhere, centre = 0, 0
    for k in range(last - first):  # vector code: no branches, and the number is not a constant
        dx, dz = x - k_x[k], z - k_z[k]
        lead = (_gaussian(0.5 * (dx * dx + dz * dz)) - near_j) - need[k]
        everywhere += lead > reach * slope[k]  # the Hessian of g has norm 1/σ² at most
        centre += lead > 0.0
    return everywhere, centre


@numba.njit(cache=True, nogil=True)
def _settle(rivals, count, start, x, z, near_j, reach):  # pragma: no cover  (compiled)
    """Compare j with ``count`` rivals in a box, beginning with those from ``start`` on; see ``_cheaper``.

    Returns (1 if some rival is cheaper in the whole box, 2 if one is cheaper only at the centre, otherwise 0;
    the new ``start``: the rivals that settled a box are the first to compare in the next).
    """
    total, first = 0, start
    while True:
        everywhere, centre = _cheaper(rivals, first, min(first + BLOCK_RIVALS, count), x, z, near_j, reach)
        if everywhere:
            return 1, first
        total += centre
        first = first + BLOCK_RIVALS if first + BLOCK_RIVALS < count else 0
        if first == start:
            return 2 if total else 0, start


@numba.njit(cache=True, nogil=True)
def _may_win(j_at, rivals, count, radius, stack):  # pragma: no cover  (compiled)
    """Whether record j may win somewhere within ``radius`` (σ) against ``count`` rivals.

    rivals: (4, n), n a multiple of VECTOR_LANES: x and z in σ, the advantage g_j − g_k above which rival k is
    cheaper for every λ, and the largest slope of g_j − g_k.
    """
    stack[0, 0], stack[0, 1], stack[0, 2] = j_at[0], j_at[1], radius  # whole rows take long to compile
    depth, start = 1, 0
    while depth > 0:
        depth -= 1
        x, z, half = stack[depth, 0], stack[depth, 1], stack[depth, 2]
        jx, jz = x - j_at[0], z - j_at[1]
        reach, squared = half * math.sqrt(2.0), jx * jx + jz * jz
        if math.sqrt(squared) - reach > radius:
            continue
        found, start = _settle(rivals, count, start, x, z, _gaussian(0.5 * squared), reach)
        if found == 1:
            continue
        if found == 0 or half < SMALLEST_BOX or depth + 4 > STACK_BOXES:
            return True
        for s in range(4):
            side_x = 0.5 * half if s % 2 else -0.5 * half
            side_z = 0.5 * half if s // 2 else -0.5 * half
            stack[depth, 0], stack[depth, 1], stack[depth, 2] = x + side_x, z + side_z, 0.5 * half
            depth += 1
    return False


@numba.njit(cache=True, nogil=True)
def _rivals_of(s, errors, at, leverage, margin, squared, near, rivals):  # pragma: no cover  (compiled)
    """Write the rivals of candidate s to ``rivals`` (4, n), see ``_may_win``; return their number.

    They include s itself, and fill the last vector with rivals that are never cheaper, as s is not.
    """
    at_x, at_z = at[0], at[1]
    x, z, own = at_x[s], at_z[s], errors[s] - margin
    of_more, of_less = 1.0 / leverage[0], 1.0 / leverage[1]
    for k in range(len(errors)):
        dx, dz = at_x[k] - x, at_z[k] - z
        squared[k] = dx * dx + dz * dz
    near[0] = 0
    n = 1
    for k in range(1, len(errors)):
        near[n] = k
        n += squared[k] <= NEAR_SIGMA * NEAR_SIGMA
    for i in range(n):
        k = near[i]
        gap = errors[k] - own
        rivals[0, i], rivals[1, i] = at_x[k], at_z[k]
        rivals[2, i] = gap * (of_more if gap > 0.0 else of_less)
        rivals[3, i] = min(math.sqrt(squared[k]), MAX_SLOPE)
    rivals[2, n : n + VECTOR_LANES] = np.inf  # never cheaper: completes the last vector
    return (n + VECTOR_LANES - 1) // VECTOR_LANES * VECTOR_LANES


@numba.njit(cache=True, nogil=True)
def keep_winners(c, row, air, weighing, margin, kept, count):
    """Drop candidates from ``kept`` that win nowhere; return the number that remains.

    c: the state, whose successor is kept[0] and not the end of a trajectory; row (z,): mismatches; air and
    weighing: Air and Weighing of ``candidates``. Candidates of the other air than that of the state belong
    to separate queries and stay, except those of moving air for a state of still air.
    """  # pragma: no cover  (compiled)
    pressure, calm, _ = air
    components, sigma, leverage, _ = weighing
    errors, at = np.empty(count), np.empty((2, count))
    for s in range(count):
        k = kept[s]
        errors[s] = row[k] / components
        at[0, s], at[1, s] = pressure[k, 0] / sigma, pressure[k, 1] / sigma
        if calm[k] and not calm[c]:
            at[0, s] = np.inf  # nobody's rival
    rivals, stack = np.zeros((4, count + VECTOR_LANES)), np.empty((STACK_BOXES, 3))
    squared, near = np.empty(count), np.empty(count + 1, np.int64)
    remain = 1
    for s in range(1, count):
        room = (errors[s] - margin) / leverage[1]  # the largest g at which s can win
        stays = True  # also if it may win at any distance, or belongs to another query
        if at[0, s] < np.inf and errors[s] > margin:
            stays = False
            if room < 1.0:
                n = _rivals_of(s, errors, at, leverage, margin, squared, near, rivals)
                stays = _may_win(at[:, s], rivals, n, math.sqrt(-2.0 * math.log(room)), stack)
        kept[remain] = kept[s]
        remain += stays
    return remain
