"""Stiffness that limbs need to carry their own weight: a real tree stands, however thin its limbs are drawn.

The tangent of a loaded tree is K + K_σ, where K_σ is the geometric stiffness of the weight (`prestress.py`).
Linearised buckling, −K_σ v = ν K v, gives the load factors ν, weight over buckling load, one for each way in
which the tree can give way: it falls if any of them exceeds one. Then either the stiffness of a limb is
wrong (it grows with the fourth power of a radius that was drawn or scanned), or its weight. The limbs that
hold most of the elastic energy of such a mode get the stiffness (1 + ν) K. Under its weight, such a limb is
then as stiff in this mode as it is drawn: (1 + ν) K v + K_σ v = K v. All other limbs keep their stiffness,
and all limbs keep their weight.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from galewood.solid.fem.elements.assembly import ElementSystem
from galewood.solid.fem.elements.elasticity import PAIRS
from galewood.solid.fem.elements.quadratic import combination
from galewood.util import Floats, Int32s

MAX_BUCKLING_RATIO = 0.7
"""Largest weight over buckling load of a supported tree; above it, hardly any stiffness is left."""
STIFFENING_MARGIN = 1.02
"""Of the stiffening that reaches it, so that it is reached in few rounds."""
LIMB_ENERGY_SHARE = 0.8
"""Share of a mode's elastic energy in the limbs that are stiffened for it."""
MODE_COUNT = 24
MAX_ROUNDS = 30
MAX_STIFFENING_FACTOR = 1e4
"""Largest factor; a limb that needs more is damaged input."""


class Support(NamedTuple):
    """Stiffness factors (m,) of the elements, at least one, and whether the tree then stands."""

    factor: Floats
    stands: bool
    rounds: int
    load_factor: float
    """Weight over buckling load before."""


def supporting_factors(system: ElementSystem, prestress: Floats, limb: Int32s) -> Support:
    """The stiffness of whole limbs (m,) with which the tree carries its weight.

    prestress (m,10) N/m is that of the given shape under its weight (`rest_prestress`); its forces do not
    depend on the stiffness. The blocks and the prestress of the system are changed.
    """
    factor = np.ones(len(limb))
    blocks = system.blocks.reshape(-1, 10, 3, 3).copy()
    geometric = _geometric(system, prestress)
    first = 0.0
    for number in range(MAX_ROUNDS):
        system.set_blocks(blocks * factor[:, None, None, None])
        load, shapes = _load_factors(system, geometric)
        first = first or float(load[0])
        if load[0] <= MAX_BUCKLING_RATIO:
            return Support(factor, True, number, first)
        needed = _factors(load) if number == 0 else STIFFENING_MARGIN * load / MAX_BUCKLING_RATIO
        factor = np.minimum(factor * _on_limbs(system, load, needed, shapes, limb), MAX_STIFFENING_FACTOR)
    return Support(factor, False, MAX_ROUNDS, first)


def _geometric(system: ElementSystem, prestress: Floats) -> csc_matrix:
    """K_σ of the free nodes."""
    blocks, foundation = system.blocks.reshape(-1, 10, 3, 3).copy(), system.foundation
    system.set_prestress(prestress)
    system.set_blocks(0 * blocks)
    system.foundation = None
    matrix = _tangent(system)
    system.foundation = foundation
    system.set_prestress(0 * prestress)
    system.set_blocks(blocks)
    return matrix


def _tangent(system: ElementSystem) -> csc_matrix:
    zero = np.zeros_like(system.rest)
    system.assemble(zero, zero, 1.0, np.zeros(len(zero)), zero.copy())
    return system.solver.to_scipy(system.values)


def _load_factors(system: ElementSystem, geometric: csc_matrix) -> tuple[Floats, Floats]:
    """The largest load factors (k,), descending, and their shapes (k,N,3), in the system's internal order."""
    stiffness = _tangent(system)
    system.solver.factorise(system.values)
    size = 3 * system.free

    def flexibility(b: Floats) -> Floats:
        y = np.array(b, np.float64).reshape(-1, 3)
        system.solver.solve(y)
        return y.ravel()

    inverse = LinearOperator((size, size), matvec=flexibility, dtype=np.float64)  # pyright: ignore[reportCallIssue]
    count = min(MODE_COUNT, size - 1)
    start, loose = np.random.default_rng(0).normal(size=size), 1e-4
    options: dict[str, Any] = {"M": stiffness, "Minv": inverse, "which": "LA", "v0": start, "tol": loose}
    try:
        load, vectors = eigsh(-geometric, count, **options)
    except ArpackNoConvergence as some:  # the largest come first
        load, vectors = some.eigenvalues, some.eigenvectors
    falling = np.argsort(-load)
    shapes = np.zeros((len(load), *system.rest.shape))
    shapes[:, : system.free] = vectors[:, falling].T.reshape(len(load), -1, 3)
    return load[falling], shapes


def _factors(load: Floats) -> Floats:
    """Stiffness factors (k,) for modes of these load factors: 1 + ν for those that fall."""
    return np.where(load > 1, 1 + load, STIFFENING_MARGIN * load / MAX_BUCKLING_RATIO)


def _on_limbs(system: ElementSystem, load: Floats, needed: Floats, shapes: Floats, limb: Int32s) -> Floats:
    """Factors (m,): those needed by each mode whose load factor is too large, on the limbs that hold it."""
    factor = np.ones(int(limb.max()) + 1)
    for one, least, shape in zip(load, needed, shapes, strict=True):
        if one <= MAX_BUCKLING_RATIO:
            break
        energy = np.bincount(limb, _energy(system, shape), len(factor))
        most = np.argsort(-energy)
        before = np.concatenate([[0.0], np.cumsum(energy[most])[:-1]]) / energy.sum()
        holding = most[before < LIMB_ENERGY_SHARE]
        factor[holding] = np.maximum(factor[holding], least)
    return factor[limb]


def _energy(system: ElementSystem, shape: Floats) -> Floats:
    """Twice the elastic energy (m,) of the elements in a shape (N,3), J."""
    moved = shape[system.elements]
    blocks = system.blocks.reshape(-1, 10, 3, 3)
    total = np.zeros(len(moved))
    for i, j, coefficient, block in _terms(system.quadratic):
        weight = coefficient if i == j else 2.0 * coefficient
        total += weight * np.einsum("ea,eab,eb->e", moved[:, i], blocks[:, block], moved[:, j])
    return total


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
