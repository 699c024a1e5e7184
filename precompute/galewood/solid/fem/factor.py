"""The factor of a tree's tangent stiffness at rest: displacement under small point forces, one solve each."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from galewood.solid.fem.model import FemModel
from galewood.solid.fem.solver import JIT
from galewood.util import Array, Floats, Int32s


@dataclass(frozen=True)
class TangentFactor:
    """Cholesky factor L of the tangent K = L Lᵀ in 3 × 3 blocks, n free nodes in elimination order.

    pointer (n + 1,) and rows (b,) are compressed columns, the diagonal block first. blocks (b, 9) are
    row-major; the diagonal block k holds the inverse of L_kk instead: i00, i10, i11, i20, i21, i22, 0, 0, 0.
    rank (N,) is the elimination number of each mesh node, n for clamped ones; mass_kg (n,) of the free nodes;
    limit_n (n,) is the force at each node under which some element reaches `BREAKING_STRAIN`.
    """

    pointer: Int32s
    rows: Int32s
    blocks: Floats
    rank: Int32s
    mass_kg: Floats
    limit_n: Floats

    @property
    def free(self) -> int:
        """n: number of free nodes."""
        return len(self.pointer) - 1

    def solve(self, load_n: Floats) -> Floats:
        """Displacement (n, 3), m, under forces (n, 3), N, both in elimination order."""
        u = np.ascontiguousarray(load_n, np.float64).copy()
        solve_factor(self.pointer, self.rows, self.blocks, u)
        return u


BREAKING_STRAIN = 0.03
"""Assumed: green wood bent beyond 1 to 3 % of strain breaks (unchecked)."""


def tangent_factor(model: FemModel) -> TangentFactor:
    """Factorise the tangent of a model at its gravity rest pose, gravity's softening included.

    Raises NotPositiveDefinite if the rest pose is unstable.
    """
    system = model.system()
    still = np.zeros_like(system.rest)
    system.assemble(still, still, 1.0, np.zeros(len(still)), still.copy())
    system.solver.factorise(system.values)
    pointer, rows = system.solver.pointer, system.solver.rows
    blocks = system.values[: len(rows)].copy()
    blocks[pointer[:-1]] = _inverse_of_diagonal(pointer, blocks)
    rank = np.minimum(system.rank, system.free).astype(np.int32)
    strain = _strain_per_newton(pointer, rows, blocks, system.elements, system.grad, system.free)
    limit_n = BREAKING_STRAIN / np.maximum(strain, 1e-30)
    mass_kg = model.mass_kg[system.order[: system.free]]
    return TangentFactor(pointer, rows, blocks, rank, mass_kg, limit_n)


def _inverse_of_diagonal(pointer: Int32s, blocks: Floats) -> Floats:
    """(n, 9) the inverse of the Cholesky factor of each diagonal block, packed."""
    inverse = np.linalg.inv(_lower(blocks[pointer[:-1]]))
    packed = np.zeros((len(inverse), 9))
    packed[:, :6] = inverse[:, [0, 1, 1, 2, 2, 2], [0, 0, 1, 0, 1, 2]]
    return packed


def _lower(blocks: Floats) -> Floats:
    """(n, 3, 3) Cholesky factors of diagonal blocks (n, 9), which the solver leaves as Schur complements."""
    square = blocks.reshape(-1, 3, 3)
    symmetric = np.tril(square) + np.tril(square, -1).transpose(0, 2, 1)
    return np.asarray(np.linalg.cholesky(symmetric), np.float64)


@numba.njit(**JIT)
def solve_factor(pointer: Array, rows: Array, v: Array, b: Floats) -> None:
    """Forward and backward substitution in place; b (n, 3)."""
    n = len(pointer) - 1
    for k in range(n):
        p = pointer[k]
        y0 = v[p, 0] * b[k, 0]
        y1 = v[p, 1] * b[k, 0] + v[p, 2] * b[k, 1]
        y2 = v[p, 3] * b[k, 0] + v[p, 4] * b[k, 1] + v[p, 5] * b[k, 2]
        b[k, 0] = y0
        b[k, 1] = y1
        b[k, 2] = y2
        for q in range(p + 1, pointer[k + 1]):
            i = rows[q]
            b[i, 0] -= v[q, 0] * y0 + v[q, 1] * y1 + v[q, 2] * y2
            b[i, 1] -= v[q, 3] * y0 + v[q, 4] * y1 + v[q, 5] * y2
            b[i, 2] -= v[q, 6] * y0 + v[q, 7] * y1 + v[q, 8] * y2
    for k in range(n - 1, -1, -1):
        p = pointer[k]
        y0, y1, y2 = b[k, 0], b[k, 1], b[k, 2]
        for q in range(p + 1, pointer[k + 1]):
            i = rows[q]
            y0 -= v[q, 0] * b[i, 0] + v[q, 3] * b[i, 1] + v[q, 6] * b[i, 2]
            y1 -= v[q, 1] * b[i, 0] + v[q, 4] * b[i, 1] + v[q, 7] * b[i, 2]
            y2 -= v[q, 2] * b[i, 0] + v[q, 5] * b[i, 1] + v[q, 8] * b[i, 2]
        b[k, 0] = v[p, 0] * y0 + v[p, 1] * y1 + v[p, 3] * y2
        b[k, 1] = v[p, 2] * y1 + v[p, 4] * y2
        b[k, 2] = v[p, 5] * y2


@numba.njit(**JIT)
def _strain_per_newton(
    pointer: Int32s, rows: Int32s, v: Floats, elements: Int32s, grad: Floats, free: int
) -> Floats:
    """(n,) 1/N: largest strain of any element per newton at each free node, in any direction.

    The norm of the strain tensors under unit forces along the three axes, which bounds every direction.
    """
    found = np.zeros(free)
    u = np.empty((free, 3))
    squares = np.empty(len(elements))
    for j in range(free):
        squares[:] = 0.0
        for axis in range(3):
            u[:] = 0.0
            u[j, axis] = 1.0
            solve_factor(pointer, rows, v, u)
            for e in range(len(elements)):
                if j in elements[e]:  # the dent at the point itself
                    continue
                g00 = g01 = g02 = g10 = g11 = g12 = g20 = g21 = g22 = 0.0
                for a in range(4):
                    i = elements[e, a]
                    if i >= free:
                        continue
                    x, y, z = u[i, 0], u[i, 1], u[i, 2]
                    dx, dy, dz = grad[e, a, 0], grad[e, a, 1], grad[e, a, 2]
                    g00 += x * dx
                    g01 += x * dy
                    g02 += x * dz
                    g10 += y * dx
                    g11 += y * dy
                    g12 += y * dz
                    g20 += z * dx
                    g21 += z * dy
                    g22 += z * dz
                shear = (g01 + g10) ** 2 + (g02 + g20) ** 2 + (g12 + g21) ** 2
                squares[e] += g00 * g00 + g11 * g11 + g22 * g22 + 0.5 * shear
        found[j] = np.sqrt(squares.max())
    return found
