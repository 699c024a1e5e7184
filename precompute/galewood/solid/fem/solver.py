"""Sparse Cholesky factorisation in 3 × 3 blocks for matrices with a constant pattern.

A tree-shaped mesh has almost no fill-in, so overhead dominates the cost. The elimination order, the pattern
of the factor and the destination of every update are computed once (`BlockCholesky`), and a factorisation is
one pass over plain arrays. All sums have a fixed order, so results are deterministic to the bit.
"""

from typing import Any

import numba
import numpy as np
from scipy.sparse import csc_matrix, eye_array
from scipy.sparse.linalg import splu

from galewood.util import Floats, Int32s, Ints

JIT: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "fastmath": {"contract"}}


class NotPositiveDefinite(ValueError):
    """The matrix is not positive definite (or the input is not finite)."""


class BlockCholesky:
    """Symbolic analysis of an n × n matrix of 3 × 3 blocks whose graph has the edges `pairs`.

    The matrix is given in elimination order and in this object's pattern: `values` (blocks, 9) holds the
    blocks of the lower triangle, row-major; `slots` returns the index of the block at (row, column).
    `pointer` and `rows` are compressed columns with the diagonal block first in each.
    """

    def __init__(self, n: int, pairs: Int32s) -> None:
        self.n = n
        self.order = minimum_degree(n, pairs)
        rank = np.empty(n, np.int32)
        rank[self.order] = np.arange(n, dtype=np.int32)
        self.rank = rank
        self.pointer, self.rows = _factor_pattern(n, rank[pairs])
        self._columns = np.repeat(np.arange(n, dtype=np.int64), np.diff(self.pointer))
        self._keys = self._columns * n + self.rows
        self._updates = _update_slots(self.pointer, self.rows)
        self._inverse = np.empty((n, 6))

    @property
    def blocks(self) -> int:
        """Number of blocks of the factor, including fill-in."""
        return len(self.rows)

    def slots(self, rows: Int32s, columns: Int32s) -> Int32s:
        """Indices in `values` of the blocks at (row ≥ column), both in elimination order.

        Raises KeyError if a block is not in the pattern.
        """
        keys = columns.astype(np.int64) * self.n + rows
        found = np.searchsorted(self._keys, keys)
        if np.any(found >= len(self._keys)) or np.any(
            self._keys[np.minimum(found, len(self._keys) - 1)] != keys
        ):
            raise KeyError("a block is outside the pattern of the factor")
        return found.astype(np.int32)

    def factorise(self, values: Floats) -> None:
        """Overwrite `values` with the factor. Raises NotPositiveDefinite."""
        failed = _factorise(self.pointer, self._updates, values, self._inverse)
        if failed >= 0:
            raise NotPositiveDefinite(f"pivot block {failed} of {self.n} is not positive definite")
        self._values = values

    def solve(self, b: Floats) -> None:
        """Solve in place; b (≥ n, 3) in elimination order, rows beyond n are unchanged."""
        _solve(self.pointer, self.rows, self._values, self._inverse, b)

    def solve_all(self, b: Floats) -> None:
        """Solve in place for several right-hand sides (≥ n, 3, L)."""
        _solve_all(self.pointer, self.rows, self._values, self._inverse, b)

    def to_scipy(self, values: Floats) -> csc_matrix:
        """The full symmetric matrix (3n × 3n) of assembled `values` that have not been factorised."""
        i, j = (3 * self.rows.astype(np.int64), 3 * self._columns)
        offset = np.arange(3)
        row = np.broadcast_to(i[:, None, None] + offset[:, None], (len(i), 3, 3)).ravel()
        column = np.broadcast_to(j[:, None, None] + offset, (len(i), 3, 3)).ravel()
        data = values[: self.blocks].reshape(-1, 3, 3).copy()
        data[self.rows == self._columns] /= 2
        half = csc_matrix((data.ravel(), (row, column)), shape=(3 * self.n, 3 * self.n))
        return csc_matrix(half + half.T)


def minimum_degree(n: int, pairs: Int32s) -> Int32s:
    """Elimination order (order[k] = k-th eliminated node) by SuperLU's multiple minimum degree."""
    graph = csc_matrix((np.full(len(pairs), -1.0), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    graph.data[:] = -1.0
    laplacian = csc_matrix(graph + graph.T + (2.0 * n) * eye_array(n))
    factor = splu(
        laplacian, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    return np.argsort(factor.perm_c, kind="stable").astype(np.int32)


def _factor_pattern(n: int, pairs: Int32s) -> tuple[Int32s, Int32s]:
    """Compressed columns of the factor: each column's entries merged with those of its elimination-tree
    children.
    """
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    sorter = np.argsort(low, kind="stable")
    bounds = np.searchsorted(low[sorter], np.arange(n + 1))
    return _merged_columns(bounds, high[sorter].astype(np.int32))


@numba.njit(**JIT)
def _merged_columns(bounds: Ints, high: Int32s) -> tuple[Int32s, Int32s]:
    """Pointer (n + 1,) and rows, ascending in each column; ``bounds`` (n + 1,) divide ``high``."""
    n = len(bounds) - 1
    pointer, rows = np.zeros(n + 1, np.int32), np.empty(n + 4 * len(high), np.int32)
    child, sibling, seen = np.full(n, -1), np.full(n, -1), np.full(n, -1)
    for k in range(n):
        end = pointer[k]
        if end + n > len(rows):
            rows = np.concatenate((rows, np.empty(len(rows) + n, np.int32)))
        rows[end] = k
        end += 1
        seen[k] = k
        for r in high[bounds[k] : bounds[k + 1]]:
            if seen[r] != k:
                seen[r] = k
                rows[end] = r
                end += 1
        below = child[k]
        while below >= 0:
            for q in range(pointer[below] + 2, pointer[below + 1]):  # the first two are itself and k
                r = rows[q]
                if seen[r] != k:
                    seen[r] = k
                    rows[end] = r
                    end += 1
            below = sibling[below]
        rows[pointer[k] + 1 : end].sort()
        pointer[k + 1] = end
        if end > pointer[k] + 1:
            parent = rows[pointer[k] + 1]
            sibling[k] = child[parent]
            child[parent] = k
    return pointer, rows[: pointer[n]].copy()


@numba.njit(**JIT)
def _update_slots(pointer: Int32s, rows: Int32s) -> Int32s:
    """Destination of each update: for column k and rows b ≤ a in it, the slot of block (a, b)."""
    total = 0
    for k in range(len(pointer) - 1):
        count = pointer[k + 1] - pointer[k] - 1
        total += count * (count + 1) // 2
    slots = np.empty(total, np.int32)
    t = 0
    for k in range(len(pointer) - 1):
        for b in range(pointer[k] + 1, pointer[k + 1]):
            target = pointer[rows[b]]
            for a in range(b, pointer[k + 1]):
                while rows[target] != rows[a]:
                    target += 1
                slots[t] = target
                t += 1
    return slots


@numba.njit(**JIT)
def _factorise(pointer: Int32s, updates: Int32s, v: Floats, inverse: Floats) -> int:
    """Right-looking block Cholesky in place; the inverse of each diagonal factor is stored in `inverse`.

    Returns the first column with a non-positive pivot, or −1.
    """
    t = 0
    for k in range(len(pointer) - 1):
        p = pointer[k]
        end = pointer[k + 1]
        d = v[p, 0]
        if not d > 0.0:
            return k
        i00 = 1.0 / np.sqrt(d)
        l10 = v[p, 3] * i00
        l20 = v[p, 6] * i00
        d = v[p, 4] - l10 * l10
        if not d > 0.0:
            return k
        i11 = 1.0 / np.sqrt(d)
        l21 = (v[p, 7] - l20 * l10) * i11
        d = v[p, 8] - l20 * l20 - l21 * l21
        if not d > 0.0:
            return k
        i22 = 1.0 / np.sqrt(d)
        i10 = -l10 * i00 * i11
        i21 = -l21 * i11 * i22
        i20 = -(l20 * i00 + l21 * i10) * i22
        inverse[k, 0] = i00
        inverse[k, 1] = i10
        inverse[k, 2] = i11
        inverse[k, 3] = i20
        inverse[k, 4] = i21
        inverse[k, 5] = i22
        for q in range(p + 1, end):
            for r in range(0, 9, 3):
                a0 = v[q, r]
                a1 = v[q, r + 1]
                a2 = v[q, r + 2]
                v[q, r] = a0 * i00
                v[q, r + 1] = a0 * i10 + a1 * i11
                v[q, r + 2] = a0 * i20 + a1 * i21 + a2 * i22
        for b in range(p + 1, end):
            b0 = v[b, 0]
            b1 = v[b, 1]
            b2 = v[b, 2]
            b3 = v[b, 3]
            b4 = v[b, 4]
            b5 = v[b, 5]
            b6 = v[b, 6]
            b7 = v[b, 7]
            b8 = v[b, 8]
            for a in range(b, end):
                s = updates[t]
                t += 1
                for r in range(0, 9, 3):
                    a0 = v[a, r]
                    a1 = v[a, r + 1]
                    a2 = v[a, r + 2]
                    v[s, r] -= a0 * b0 + a1 * b1 + a2 * b2
                    v[s, r + 1] -= a0 * b3 + a1 * b4 + a2 * b5
                    v[s, r + 2] -= a0 * b6 + a1 * b7 + a2 * b8
    return -1


@numba.njit(**JIT)
def _solve(pointer: Int32s, rows: Int32s, v: Floats, inverse: Floats, b: Floats) -> None:
    """Forward and backward substitution in place."""
    n = len(pointer) - 1
    for k in range(n):
        y0 = inverse[k, 0] * b[k, 0]
        y1 = inverse[k, 1] * b[k, 0] + inverse[k, 2] * b[k, 1]
        y2 = inverse[k, 3] * b[k, 0] + inverse[k, 4] * b[k, 1] + inverse[k, 5] * b[k, 2]
        b[k, 0] = y0
        b[k, 1] = y1
        b[k, 2] = y2
        for q in range(pointer[k] + 1, pointer[k + 1]):
            i = rows[q]
            b[i, 0] -= v[q, 0] * y0 + v[q, 1] * y1 + v[q, 2] * y2
            b[i, 1] -= v[q, 3] * y0 + v[q, 4] * y1 + v[q, 5] * y2
            b[i, 2] -= v[q, 6] * y0 + v[q, 7] * y1 + v[q, 8] * y2
    for k in range(n - 1, -1, -1):
        y0 = b[k, 0]
        y1 = b[k, 1]
        y2 = b[k, 2]
        for q in range(pointer[k] + 1, pointer[k + 1]):
            i = rows[q]
            y0 -= v[q, 0] * b[i, 0] + v[q, 3] * b[i, 1] + v[q, 6] * b[i, 2]
            y1 -= v[q, 1] * b[i, 0] + v[q, 4] * b[i, 1] + v[q, 7] * b[i, 2]
            y2 -= v[q, 2] * b[i, 0] + v[q, 5] * b[i, 1] + v[q, 8] * b[i, 2]
        b[k, 0] = inverse[k, 0] * y0 + inverse[k, 1] * y1 + inverse[k, 3] * y2
        b[k, 1] = inverse[k, 2] * y1 + inverse[k, 4] * y2
        b[k, 2] = inverse[k, 5] * y2


@numba.njit(**JIT)
def _solve_all(pointer: Int32s, rows: Int32s, v: Floats, inverse: Floats, b: Floats) -> None:
    """`_solve` for right-hand sides side by side (n, 3, L): each block of the factor is read once."""
    n, sides = len(pointer) - 1, b.shape[2]
    for k in range(n):
        for s in range(sides):
            y0 = inverse[k, 0] * b[k, 0, s]
            y1 = inverse[k, 1] * b[k, 0, s] + inverse[k, 2] * b[k, 1, s]
            y2 = inverse[k, 3] * b[k, 0, s] + inverse[k, 4] * b[k, 1, s] + inverse[k, 5] * b[k, 2, s]
            b[k, 0, s] = y0
            b[k, 1, s] = y1
            b[k, 2, s] = y2
        for q in range(pointer[k] + 1, pointer[k + 1]):
            i = rows[q]
            for c in range(3):
                v0, v1, v2 = v[q, 3 * c], v[q, 3 * c + 1], v[q, 3 * c + 2]
                for s in range(sides):
                    b[i, c, s] -= v0 * b[k, 0, s] + v1 * b[k, 1, s] + v2 * b[k, 2, s]
    for k in range(n - 1, -1, -1):
        for q in range(pointer[k] + 1, pointer[k + 1]):
            i = rows[q]
            for c in range(3):
                v0, v1, v2 = v[q, c], v[q, 3 + c], v[q, 6 + c]
                for s in range(sides):
                    b[k, c, s] -= v0 * b[i, 0, s] + v1 * b[i, 1, s] + v2 * b[i, 2, s]
        for s in range(sides):
            y0, y1, y2 = b[k, 0, s], b[k, 1, s], b[k, 2, s]
            b[k, 0, s] = inverse[k, 0] * y0 + inverse[k, 1] * y1 + inverse[k, 3] * y2
            b[k, 1, s] = inverse[k, 2] * y1 + inverse[k, 4] * y2
            b[k, 2, s] = inverse[k, 5] * y2
