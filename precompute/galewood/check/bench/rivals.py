"""General sparse direct solvers that the FEM step's own factorisation is compared with.

Each rival is used as its documentation recommends for a symmetric positive definite matrix whose pattern
stays the same: whatever depends on the pattern alone is done once, at construction. The matrix arrives in the
rival's own storage format; the conversion is not timed, in the rival's favour.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from time import thread_time
from typing import Any, Protocol

import numpy as np
import scipy.sparse
from scipy.sparse.linalg import splu

from galewood.util import Floats

TRIAL_COUNT = 5


class Rival(Protocol):
    """A solver analysed for one pattern."""

    def prepare(self, matrix: scipy.sparse.csc_matrix) -> Any:
        """The matrix (n, n) in the solver's own storage format (not timed)."""
        ...

    def solve(self, prepared: Any, b: Floats) -> Floats:
        """Factorise a prepared matrix numerically and solve for b (n,), which stays as it is (timed)."""
        ...


class Splu:
    """SuperLU through `scipy.sparse.linalg.splu` in symmetric mode without pivoting.

    splu repeats the symbolic analysis on every call. With "NATURAL" the matrix keeps its present order, which
    is a minimum-degree order already, so that splu does not search for one. Small supernodes (relax=1) are
    fastest here.
    """

    def __init__(self, matrix: scipy.sparse.csc_matrix, ordering: str) -> None:
        self._ordering = ordering

    def prepare(self, matrix: scipy.sparse.csc_matrix) -> Any:
        return matrix

    def solve(self, prepared: Any, b: Floats) -> Floats:
        factor = splu(
            prepared,
            permc_spec=self._ordering,
            diag_pivot_thresh=0.0,
            relax=1,
            options={"SymmetricMode": True},
        )
        return factor.solve(b)


class Qdldl:
    """QDLDL, the LDLᵀ solver of OSQP: symbolic analysis once (AMD order), numeric update and solve per step.

    Only the upper triangle is stored.
    """

    def __init__(self, matrix: scipy.sparse.csc_matrix) -> None:
        import qdldl

        self._solver: Any = qdldl.Solver(self.prepare(matrix), upper=True)

    def prepare(self, matrix: scipy.sparse.csc_matrix) -> Any:
        return scipy.sparse.triu(matrix, format="csc")

    def solve(self, prepared: Any, b: Floats) -> Floats:
        self._solver.update(prepared, upper=True)
        return np.asarray(self._solver.solve(b), np.float64)


class Cholmod:
    """CHOLMOD through cvxopt: symbolic analysis once, numeric factorisation and solve per step.

    Simplicial and supernodal factorisation (options 0 and 2), in CHOLMOD's AMD order and in the matrix's own
    minimum-degree order, are tried at construction, and the fastest is kept.
    """

    def __init__(self, matrix: scipy.sparse.csc_matrix) -> None:
        self._cholmod: Any = import_module("cvxopt.cholmod")
        prepared, b = self.prepare(matrix), np.ones(len(matrix.indptr) - 1)
        choices = [(kind, order) for kind in (0, 2) for order in (None, self._dense(np.arange(len(b))))]

        def seconds(choice: tuple[int, Any]) -> float:
            self._analyse(prepared, *choice)
            return min(_seconds(lambda: self.solve(prepared, b)) for _ in range(TRIAL_COUNT))

        self._analyse(prepared, *min(choices, key=seconds))

    def _analyse(self, prepared: Any, supernodal: int, order: Any) -> None:
        self._cholmod.options["supernodal"] = supernodal
        self._factor: Any = (
            self._cholmod.symbolic(prepared) if order is None else self._cholmod.symbolic(prepared, p=order)
        )

    def prepare(self, matrix: scipy.sparse.csc_matrix) -> Any:
        from cvxopt import spmatrix

        lower = scipy.sparse.tril(matrix, format="coo")
        row, column = self._dense(lower.row), self._dense(lower.col)
        return spmatrix(self._dense(lower.data), row, column, matrix.shape)

    def solve(self, prepared: Any, b: Floats) -> Floats:
        self._cholmod.numeric(prepared, self._factor)
        x = self._dense(b)
        self._cholmod.solve(self._factor, x)
        return np.asarray(x, np.float64).ravel()

    @staticmethod
    def _dense(values: Any) -> Any:
        from cvxopt import matrix

        array = np.asarray(values)
        return matrix(array.astype(np.int64) if array.dtype.kind == "i" else array)


RIVALS: dict[str, Callable[[scipy.sparse.csc_matrix], Rival]] = {
    "splu": lambda matrix: Splu(matrix, "MMD_AT_PLUS_A"),
    "splu, ordered beforehand": lambda matrix: Splu(matrix, "NATURAL"),
    "QDLDL": Qdldl,
    "CHOLMOD": Cholmod,
}


def available_rivals(matrix: scipy.sparse.csc_matrix) -> tuple[dict[str, Rival], list[str]]:
    """The installed rivals, analysed for the pattern of a matrix (n, n), and the names of the others."""
    found: dict[str, Rival] = {}
    missing: list[str] = []
    for name, make in RIVALS.items():
        try:
            found[name] = make(matrix)
        except ImportError:
            missing.append(name)
    return found, missing


def _seconds(call: Callable[[], object]) -> float:
    begin = thread_time()
    call()
    return thread_time() - begin
