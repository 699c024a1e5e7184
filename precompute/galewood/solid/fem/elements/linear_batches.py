"""Corotational assembly of linear tetrahedra in batches of eight, the SIMD width.

Each scalar of an element is stored in a row of eight, one for each element of its batch, in flat arrays: row
k of batch e starts at 8 (e · rows + k). Each inner loop applies one operation to all eight elements. Its trip
count is passed as an argument, because the compiler would unroll a constant loop before vectorising it.

Corners are sorted by descending number in the elimination order, so that every block falls below the
diagonal. Shape functions sum to one, so each row of an element's blocks sums to zero: only the six blocks of
the last three corners are rotated, and the four blocks of the first corner follow from them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from galewood.solid.fem.elements.elasticity import PAIRS
from galewood.solid.fem.elements.rotation import gram_schmidt, nearest_rotation
from galewood.solid.fem.solver import JIT
from galewood.util import Floats, Int32s

SIMD_WIDTH = 8
INLINED_JIT: dict[str, Any] = {**JIT, "inline": "always"}
"""Passing arrays to a function counts references; with a dozen calls per batch this took half of the time."""
SlotsOf = Callable[[Int32s, Int32s], Int32s]
"""Slots (k,) of the blocks in rows (k,) and columns (k,), rows ≥ columns; the unused slot outside the matrix.
"""
INNER_PAIRS = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3))
"""Corner pairs whose blocks are stored, in the order K11 … K33."""


@dataclass(frozen=True)
class LinearBatches:
    """Linear elements in kernel layout: batch after batch, row after row, eight elements wide.

    Rows per batch: corners 4, slots 10, gradients 9, edges from the first corner 9, strained 9 (how far each
    edge is strained in the given shape), blocks 54, prestress 6.
    The last batch is padded with elements of zero stiffness that map to the unused slot. `pick` and `flat`
    index the stored values among an element's ten blocks and ten prestress values.
    """

    corners: Int32s
    slots: Int32s
    gradients: Floats
    edges: Floats
    strained: Floats
    blocks: Floats
    prestress: Floats
    pick: NDArray[np.int64]
    flat: NDArray[np.int64]

    def with_blocks(self, blocks: Floats) -> LinearBatches:
        """The same elements with other stiffness (m,10,9)."""
        kept = np.take_along_axis(blocks.reshape(len(blocks), 90), self.pick, axis=1)
        return replace(self, blocks=_batched(kept))

    def with_prestress(self, prestress: Floats) -> LinearBatches:
        """The same elements with other prestress (m,10)."""
        return replace(self, prestress=_batched(np.take_along_axis(prestress, self.flat, axis=1)))

    def run(self, u: Floats, w: Floats, scale: float, matrix: bool, values: Floats, out: Floats) -> None:
        """Add forces (N,3) to `out` and, if `matrix`, scale · stiffness to `values` (s,9)."""
        shape = (self.corners, self.slots, self.gradients, self.edges, self.strained)
        _assemble(SIMD_WIDTH, *shape, self.blocks, self.prestress, u, w, scale, matrix, values, out)


def linear_batches(
    rest_m: Floats,
    elements: Int32s,
    grad: Floats,
    blocks: Floats,
    prestress: Floats,
    strain_m: Floats,
    slots_of: SlotsOf,
) -> LinearBatches:
    """Batches of elements (m,4), blocks (m,10,9), prestress (m,10), with nodes in elimination order.

    ``strain_m`` (m,4,3) is the strain of the given shape, as displacements of the corners.
    """
    order = np.argsort(-elements, axis=1, kind="stable")
    corners = np.take_along_axis(elements, order, axis=1)
    slots = np.stack([slots_of(corners[:, a], corners[:, b]) for a, b in PAIRS], axis=1)
    spare = int(slots_of(np.full(1, len(rest_m), np.int32), np.zeros(1, np.int32))[0])
    edges = rest_m[corners[:, 1:]] - rest_m[corners[:, :1]]
    corner = np.take_along_axis(strain_m, order[:, :, None], axis=1)
    strained = corner[:, 1:] - corner[:, :1]
    gradients = np.take_along_axis(grad, order[:, 1:, None], axis=1)
    pick, flat = _stored_indices(order)
    none: Floats = np.zeros(0)
    batches = LinearBatches(
        _batched(corners), _batched(slots, spare), _batched(gradients), _batched(edges - strained),
        _batched(strained), none, none, pick, flat,
    )  # fmt: skip
    return batches.with_blocks(blocks).with_prestress(prestress)


def _stored_indices(order: NDArray[np.intp]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices of the stored values among an element's ten blocks (m,54) and ten prestress values (m,6)."""
    number = np.zeros((4, 4), np.int64)
    for p, (a, b) in enumerate(PAIRS):
        number[a, b] = number[b, a] = p
    upright, across = np.arange(9), np.arange(9).reshape(3, 3).T.ravel()
    pick, flat = [], []
    for a, b in INNER_PAIRS:
        first, second = order[:, a], order[:, b]
        block = number[first, second]
        flat.append(block)
        pick.append(9 * block[:, None] + np.where((first <= second)[:, None], upright, across))
    return np.concatenate(pick, axis=1), np.stack(flat, axis=1)


def _batched(rows: NDArray[Any], fill: float = 0) -> NDArray[Any]:
    """Rows (m, …) as a flat array of batches, with the last one padded."""
    width, batches = math.prod(rows.shape[1:]), -(-len(rows) // SIMD_WIDTH)
    wide = np.full((batches * SIMD_WIDTH, width), fill, rows.dtype)
    wide[: len(rows)] = rows.reshape(len(rows), width)
    return np.ascontiguousarray(wide.reshape(batches, SIMD_WIDTH, width).transpose(0, 2, 1)).ravel()


@numba.njit(**INLINED_JIT)
def _gather(simd_width: int, corners: Int32s, c: int, field: Floats, d: Floats) -> None:
    """d (9 rows) ← differences of a field (N,3) from the first corner."""
    for lane in range(simd_width):
        n0 = corners[c + lane]
        for a in range(3):
            n = corners[c + 8 * (a + 1) + lane]
            for i in range(3):
                d[8 * (3 * a + i) + lane] = field[n, i] - field[n0, i]


@numba.njit(**INLINED_JIT)
def _deformation(simd_width: int, d: Floats, grad: Floats, g: int, f: Floats, det: Floats) -> None:
    """f (9 rows) ← F = I + Σ d_a ∇λ_aᵀ, and its determinant."""
    for i in range(3):
        o = 24 * i
        for lane in range(simd_width):
            x, y, z = d[8 * i + lane], d[8 * i + 24 + lane], d[8 * i + 48 + lane]
            q = g + lane
            f[o + lane] = x * grad[q] + y * grad[q + 24] + z * grad[q + 48]
            f[o + 8 + lane] = x * grad[q + 8] + y * grad[q + 32] + z * grad[q + 56]
            f[o + 16 + lane] = x * grad[q + 16] + y * grad[q + 40] + z * grad[q + 64]
    for k in (0, 32, 64):
        for lane in range(simd_width):
            f[k + lane] += 1.0
    for lane in range(simd_width):
        det[lane] = (
            f[lane] * (f[lane + 32] * f[lane + 64] - f[lane + 40] * f[lane + 56])
            + f[lane + 8] * (f[lane + 40] * f[lane + 48] - f[lane + 24] * f[lane + 64])
            + f[lane + 16] * (f[lane + 24] * f[lane + 56] - f[lane + 32] * f[lane + 48])
        )


@numba.njit(**INLINED_JIT)
def _newton(simd_width: int, r: Floats, step: Floats) -> None:
    """One iteration of Higham's R ← (R + R⁻ᵀ) / 2, and the squared norm of the update."""
    for i in range(simd_width):
        r0, r1, r2 = r[i], r[i + 8], r[i + 16]
        r3, r4, r5 = r[i + 24], r[i + 32], r[i + 40]
        r6, r7, r8 = r[i + 48], r[i + 56], r[i + 64]
        c0, c1, c2 = r4 * r8 - r5 * r7, r5 * r6 - r3 * r8, r3 * r7 - r4 * r6
        q = 0.5 / (r0 * c0 + r1 * c1 + r2 * c2)
        d0, d1, d2 = q * c0 - 0.5 * r0, q * c1 - 0.5 * r1, q * c2 - 0.5 * r2
        d3 = q * (r2 * r7 - r1 * r8) - 0.5 * r3
        d4 = q * (r0 * r8 - r2 * r6) - 0.5 * r4
        d5 = q * (r1 * r6 - r0 * r7) - 0.5 * r5
        d6 = q * (r1 * r5 - r2 * r4) - 0.5 * r6
        d7 = q * (r2 * r3 - r0 * r5) - 0.5 * r7
        d8 = q * (r0 * r4 - r1 * r3) - 0.5 * r8
        r[i], r[i + 8], r[i + 16] = r0 + d0, r1 + d1, r2 + d2
        r[i + 24], r[i + 32], r[i + 40] = r3 + d3, r4 + d4, r5 + d5
        r[i + 48], r[i + 56], r[i + 64] = r6 + d6, r7 + d7, r8 + d8
        step[i] = d0 * d0 + d1 * d1 + d2 * d2 + d3 * d3 + d4 * d4 + d5 * d5 + d6 * d6 + d7 * d7 + d8 * d8


@numba.njit(**INLINED_JIT)
def _rotations(simd_width: int, f: Floats, det: Floats, r: Floats, step: Floats) -> None:
    """r (9 rows) ← the rotations nearest to F; flat and inverted elements are handled individually."""
    for k in range(72):
        r[k] = f[k]
    for lane in range(simd_width):
        if not det[lane] > 1e-9:
            for k in range(9):
                r[8 * k + lane] = 1.0 if k % 4 == 0 else 0.0
    far = True
    rounds = 0
    while far and rounds < 20:
        _newton(simd_width, r, step)
        rounds += 1
        far = False
        for lane in range(simd_width):
            far = far or step[lane] > 1e-17
    for lane in range(simd_width):
        i = lane
        if not det[lane] > 1e-9:
            one = nearest_rotation((f[i] - 1.0, f[i + 8], f[i + 16], f[i + 24], f[i + 32] - 1.0, f[i + 40],
                                    f[i + 48], f[i + 56], f[i + 64] - 1.0))  # fmt: skip
        elif step[lane] > 1e-17:
            one = gram_schmidt(r[i], r[i + 8], r[i + 16], r[i + 24], r[i + 32], r[i + 40])
        else:
            continue
        for k, number in enumerate(one):
            r[8 * k + lane] = number


@numba.njit(**INLINED_JIT)
def _relative_displacement(
    simd_width: int,
    r: Floats,
    d: Floats,
    w: Floats,
    edges: Floats,
    strained: Floats,
    x: int,
    out: Floats,
) -> None:
    """out (9 rows) ← d + w + s + (I − R) X: the corners' displacement relative to the rotation.

    X are the unstrained edges, and X + s those of the given shape.
    """
    for a in range(3):
        o, e = 24 * a, x + 24 * a
        for i in range(simd_width):
            x0, x1, x2 = edges[e + i], edges[e + 8 + i], edges[e + 16 + i]
            s0, s1, s2 = strained[e + i], strained[e + 8 + i], strained[e + 16 + i]
            out[o + i] = d[o + i] + w[o + i] + s0 + ((1.0 - r[i]) * x0 - r[i + 8] * x1 - r[i + 16] * x2)
            out[o + 8 + i] = (
                d[o + 8 + i] + w[o + 8 + i] + s1 + ((1.0 - r[i + 32]) * x1 - r[i + 24] * x0 - r[i + 40] * x2)
            )
            out[o + 16 + i] = (
                d[o + 16 + i]
                + w[o + 16 + i]
                + s2
                + ((1.0 - r[i + 64]) * x2 - r[i + 48] * x0 - r[i + 56] * x1)
            )


@numba.njit(**INLINED_JIT)
def _rotate_block(simd_width: int, r: Floats, blocks: Floats, b: int, k: Floats, o: int) -> None:
    """k[o …] (9 rows) ← R K Rᵀ of one block."""
    for i in range(simd_width):
        r0, r1, r2 = r[i], r[i + 8], r[i + 16]
        r3, r4, r5 = r[i + 24], r[i + 32], r[i + 40]
        r6, r7, r8 = r[i + 48], r[i + 56], r[i + 64]
        k0, k1, k2 = blocks[b + i], blocks[b + i + 8], blocks[b + i + 16]
        k3, k4, k5 = blocks[b + i + 24], blocks[b + i + 32], blocks[b + i + 40]
        k6, k7, k8 = blocks[b + i + 48], blocks[b + i + 56], blocks[b + i + 64]
        a0, a1, a2 = r0 * k0 + r1 * k3 + r2 * k6, r0 * k1 + r1 * k4 + r2 * k7, r0 * k2 + r1 * k5 + r2 * k8
        b0, b1, b2 = r3 * k0 + r4 * k3 + r5 * k6, r3 * k1 + r4 * k4 + r5 * k7, r3 * k2 + r4 * k5 + r5 * k8
        c0, c1, c2 = r6 * k0 + r7 * k3 + r8 * k6, r6 * k1 + r7 * k4 + r8 * k7, r6 * k2 + r7 * k5 + r8 * k8
        k[o + i] = a0 * r0 + a1 * r1 + a2 * r2
        k[o + i + 8] = a0 * r3 + a1 * r4 + a2 * r5
        k[o + i + 16] = a0 * r6 + a1 * r7 + a2 * r8
        k[o + i + 24] = b0 * r0 + b1 * r1 + b2 * r2
        k[o + i + 32] = b0 * r3 + b1 * r4 + b2 * r5
        k[o + i + 40] = b0 * r6 + b1 * r7 + b2 * r8
        k[o + i + 48] = c0 * r0 + c1 * r1 + c2 * r2
        k[o + i + 56] = c0 * r3 + c1 * r4 + c2 * r5
        k[o + i + 64] = c0 * r6 + c1 * r7 + c2 * r8


@numba.njit(**INLINED_JIT)
def _apply(simd_width: int, k: Floats, o: int, flip: bool, d: Floats, b: int, f: Floats, a: int) -> None:
    """f_a += K d_b, or Kᵀ d_b if `flip`; K at k[o …], corners a, b counted from 1."""
    along, across = (8, 24) if flip else (24, 8)
    for i in range(3):
        t, q = 8 * (3 * a + i), o + along * i
        for lane in range(simd_width):
            f[t + lane] += (
                k[q + lane] * d[24 * b - 24 + lane]
                + k[q + across + lane] * d[24 * b - 16 + lane]
                + k[q + 2 * across + lane] * d[24 * b - 8 + lane]
            )


@numba.njit(**INLINED_JIT)
def _stress(simd_width: int, prestress: Floats, s: int, w: Floats, f: Floats) -> None:
    """f (12 rows) ← K_σ w of the last three corners; rows of K_σ sum to zero, so differences of w suffice."""
    for i in range(3):
        o = 8 * i
        for lane in range(simd_width):
            x, y, z = w[o + lane], w[o + 24 + lane], w[o + 48 + lane]
            q = s + lane
            f[o + 24 + lane] = prestress[q] * x + prestress[q + 8] * y + prestress[q + 16] * z
            f[o + 48 + lane] = prestress[q + 8] * x + prestress[q + 24] * y + prestress[q + 32] * z
            f[o + 72 + lane] = prestress[q + 16] * x + prestress[q + 32] * y + prestress[q + 40] * z


@numba.njit(**INLINED_JIT)
def _forces(simd_width: int, k: Floats, d: Floats, f: Floats) -> None:
    """f (12 rows) += K d; the first corner balances the others."""
    _apply(simd_width, k, 288, False, d, 1, f, 1)
    _apply(simd_width, k, 360, False, d, 2, f, 1)
    _apply(simd_width, k, 432, False, d, 3, f, 1)
    _apply(simd_width, k, 360, True, d, 1, f, 2)
    _apply(simd_width, k, 504, False, d, 2, f, 2)
    _apply(simd_width, k, 576, False, d, 3, f, 2)
    _apply(simd_width, k, 432, True, d, 1, f, 3)
    _apply(simd_width, k, 576, True, d, 2, f, 3)
    _apply(simd_width, k, 648, False, d, 3, f, 3)
    for i in range(0, 24, 8):
        for lane in range(simd_width):
            f[i + lane] = -f[i + 24 + lane] - f[i + 48 + lane] - f[i + 72 + lane]


@numba.njit(**INLINED_JIT)
def _complete(simd_width: int, k: Floats, prestress: Floats, s: int, scale: float) -> None:
    """All ten blocks in k (90 rows), 00 01 02 03 11 12 13 22 23 33, from the last six: shifted and scaled."""
    for p in range(6):
        o = 288 + 72 * p
        for c in range(0, 72, 8):
            raised = 1.0 if c % 32 == 0 else 0.0
            for lane in range(simd_width):
                k[o + c + lane] = scale * (k[o + c + lane] + raised * prestress[s + 8 * p + lane])
    for i in range(3):
        for j in range(3):
            o, t = 8 * (3 * i + j), 8 * (3 * j + i)
            for lane in range(simd_width):
                k[72 + o + lane] = -k[288 + o + lane] - k[360 + t + lane] - k[432 + t + lane]
                k[144 + o + lane] = -k[360 + o + lane] - k[504 + o + lane] - k[576 + t + lane]
                k[216 + o + lane] = -k[432 + o + lane] - k[576 + o + lane] - k[648 + o + lane]
    for o in range(0, 72, 8):
        for lane in range(simd_width):
            k[o + lane] = -k[72 + o + lane] - k[144 + o + lane] - k[216 + o + lane]


@numba.njit(**INLINED_JIT)
def _scatter(simd_width: int, k: Floats, slots: Int32s, first: int, flat_values: Floats) -> None:
    """Add the ten blocks to their slots; nine loads before nine stores, which may not be exchanged."""
    for p in range(10):
        for lane in range(simd_width):
            t, o = 9 * slots[first + 8 * p + lane], 72 * p + lane
            v0, v1, v2 = flat_values[t] + k[o], flat_values[t + 1] + k[o + 8], flat_values[t + 2] + k[o + 16]
            v3, v4 = flat_values[t + 3] + k[o + 24], flat_values[t + 4] + k[o + 32]
            v5, v6 = flat_values[t + 5] + k[o + 40], flat_values[t + 6] + k[o + 48]
            v7, v8 = flat_values[t + 7] + k[o + 56], flat_values[t + 8] + k[o + 64]
            flat_values[t], flat_values[t + 1], flat_values[t + 2] = v0, v1, v2
            flat_values[t + 3], flat_values[t + 4], flat_values[t + 5] = v3, v4, v5
            flat_values[t + 6], flat_values[t + 7], flat_values[t + 8] = v6, v7, v8


@numba.njit(**JIT)
def _assemble(
    simd_width: int,
    corners: Int32s,
    slots: Int32s,
    gradients: Floats,
    edges: Floats,
    strained: Floats,
    blocks: Floats,
    prestress: Floats,
    u: Floats,
    w: Floats,
    scale: float,
    matrix: bool,
    values: Floats,
    out: Floats,
) -> None:
    du, dw, d, r, deformed = np.empty(72), np.empty(72), np.empty(72), np.empty(72), np.empty(72)
    det, step, f, k = np.empty(8), np.empty(8), np.empty(96), np.empty(720)
    flat_values = values.reshape(-1)
    for e in range(len(corners) // 32):
        _gather(simd_width, corners, 32 * e, u, du)
        _gather(simd_width, corners, 32 * e, w, dw)
        _deformation(simd_width, du, gradients, 72 * e, deformed, det)
        _rotations(simd_width, deformed, det, r, step)
        _relative_displacement(simd_width, r, du, dw, edges, strained, 72 * e, d)
        for p in range(6):
            _rotate_block(simd_width, r, blocks, 432 * e + 72 * p, k, 288 + 72 * p)
        _stress(simd_width, prestress, 48 * e, dw, f)
        _forces(simd_width, k, d, f)
        for lane in range(simd_width):
            for a in range(4):
                n = corners[32 * e + 8 * a + lane]
                for i in range(3):
                    out[n, i] += f[8 * (3 * a + i) + lane]
        if matrix:
            _complete(simd_width, k, prestress, 48 * e, scale)
            _scatter(simd_width, k, slots, 80 * e, flat_values)
