"""Tensors of one table for all lanes of a batch, or of one table for each lane.

The last axis of every array of a batch runs over its trees. Tensors have no such axis if the trees are of the
same table; then their products with arrays are products of matrices. If each tree has a table of its own, the
last axis of the tensors runs over the trees, too.
"""
# pyright: reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownLambdaType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import numba
import numpy as np
from numba.extending import overload


def of_lane(value, lane):
    """The number of a lane: of a tensor's row (lanes,), or the one that all lanes share."""
    return value[lane] if np.ndim(value) else value


@overload(of_lane)
def _of_lane(value, lane):  # pyright: ignore[reportUnusedFunction]
    if isinstance(value, numba.types.Array):
        return lambda value, lane: value[lane]
    return lambda value, lane: value


def write_product(matrix, columns, out):
    """Write matrix (rows, n) · columns (n, lanes) to out (rows, lanes)."""
    raise NotImplementedError("compiled code only")


@overload(write_product)
def _write_product(matrix, columns, out):  # pyright: ignore[reportUnusedFunction]
    if matrix.ndim == 2:
        return lambda matrix, columns, out: np.dot(matrix, columns, out)

    def of_each(matrix, columns, out):
        out[:] = 0.0
        _add_products(matrix, columns, out)

    return of_each


def add_product(matrix, columns, out):
    """Add matrix (rows, n) · columns (n, lanes) to out (rows, lanes)."""
    raise NotImplementedError("compiled code only")


@overload(add_product)
def _add_product(matrix, columns, out):  # pyright: ignore[reportUnusedFunction]
    if matrix.ndim == 3:
        return lambda matrix, columns, out: _add_products(matrix, columns, out)

    def of_all(matrix, columns, out):
        out += np.dot(matrix, columns)

    return of_all


@numba.njit(nogil=True, cache=True)
def _add_products(matrix, columns, out):  # pragma: no cover  (compiled)
    """Add the products of a matrix of each lane (rows, n, lanes)."""
    for row in range(len(out)):
        for k in range(len(columns)):
            for lane in range(out.shape[1]):
                out[row, lane] += matrix[row, k, lane] * columns[k, lane]
