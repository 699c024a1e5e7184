"""Linearised buckling: how much of its buckling load a tree bears, and how it would give way.

The tangent of a loaded tree is K + K_σ, where K_σ is the geometric stiffness of the weight (`prestress.py`).
−K_σ v = ν K v gives the load factors ν, weight over buckling load, one for each way in which the tree can
give way. It falls if any of them exceeds one.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from galewood.solid.fem.elements.assembly import ElementSystem
from galewood.solid.fem.elements.elasticity import PAIRS
from galewood.solid.fem.elements.quadratic import combination
from galewood.solid.fem.solver import NotPositiveDefinite
from galewood.util import Floats

MODE_COUNT = 24
EIGENVALUE_TOLERANCE: Any = 1e-6  # scipy's type annotation requires an int


class Buckling(NamedTuple):
    """The largest load factors (k,), descending, and their shapes (k,N,3) in the system's internal order."""

    load: Floats
    shapes: Floats


def geometric_stiffness(system: ElementSystem, prestress: Floats) -> csc_matrix:
    """K_σ of the free nodes for a prestress (m,10), N/m; the system is left with its blocks and without
    prestress.
    """
    blocks, foundation = system.blocks.reshape(-1, 10, 3, 3).copy(), system.foundation
    system.set_prestress(prestress)
    system.set_blocks(0 * blocks)
    system.foundation = None
    matrix = _tangent(system)
    system.foundation = foundation
    system.set_prestress(0 * prestress)
    system.set_blocks(blocks)
    return matrix


def buckling(system: ElementSystem, geometric: csc_matrix) -> Buckling:
    """The ways to give way under a weight of this geometric stiffness, with the system's present blocks."""
    stiffness = _tangent(system)
    system.solver.factorise(system.values)
    size = 3 * system.free

    def flexibility(b: Floats) -> Floats:
        y = np.array(b, np.float64).reshape(-1, 3)
        system.solver.solve(y)
        return y.ravel()

    inverse = LinearOperator((size, size), matvec=flexibility, dtype=np.float64)  # pyright: ignore[reportCallIssue]
    start = np.random.default_rng(0).normal(size=size)
    options: dict[str, Any] = {"M": stiffness, "Minv": inverse, "which": "LA", "v0": start}
    try:
        load, vectors = eigsh(-geometric, min(MODE_COUNT, size - 1), tol=EIGENVALUE_TOLERANCE, **options)
    except ArpackNoConvergence as some:  # the largest come first
        load, vectors = some.eigenvalues, some.eigenvectors
        if not len(load):
            raise NotPositiveDefinite("no buckling load was found") from some
    falling = np.argsort(-load)
    shapes = np.zeros((len(load), *system.rest.shape))
    shapes[:, : system.free] = vectors[:, falling].T.reshape(len(load), -1, 3)
    return Buckling(load[falling], shapes)


def element_energies(system: ElementSystem, shape: Floats) -> Floats:
    """Twice the elastic energy (m,) of the elements in a shape (N,3), J."""
    moved = shape[system.elements]
    blocks = system.blocks.reshape(-1, 10, 3, 3)
    total = np.zeros(len(moved))
    for i, j, coefficient, block in _terms(system.quadratic):
        weight = coefficient if i == j else 2.0 * coefficient
        total += weight * np.einsum("ea,eab,eb->e", moved[:, i], blocks[:, block], moved[:, j])
    return total


def _tangent(system: ElementSystem) -> csc_matrix:
    zero = np.zeros_like(system.rest)
    system.assemble(zero, zero, 1.0, np.zeros(len(zero)), zero.copy())
    return system.solver.to_scipy(system.values)


def _terms(quadratic: bool) -> list[tuple[int, int, float, int]]:
    """Row, column, coefficient and linear block of each term of an element's stiffness; each pair once."""
    if not quadratic:
        return [(i, j, 1.0, block) for block, (i, j) in enumerate(PAIRS)]
    whole = combination()
    terms: list[tuple[int, int, float, int]] = []
    for pair, (a, b) in enumerate(zip(whole.rows.tolist(), whole.columns.tolist(), strict=True)):
        for t in range(whole.start[pair], whole.start[pair + 1]):
            row, column = (b, a) if whole.transposed[t] else (a, b)
            terms.append((row, column, float(whole.coefficient[t]), int(whole.block[t])))
    return terms
