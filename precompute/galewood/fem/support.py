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

from galewood.fem.assembly import ElementSystem
from galewood.fem.elasticity import PAIRS
from galewood.util import Floats, Int32s

STANDS = 0.7
"""Largest weight over buckling load of a tree that stands; above it, hardly any stiffness is left."""
HOLDING = 0.8
"""Share of a mode's elastic energy in the limbs that are stiffened for it."""
MODES = 24
ROUNDS = 30
STIFFEST = 1e4
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
    for number in range(ROUNDS):
        system.set_blocks(blocks * factor[:, None, None, None])
        load, shapes = _load_factors(system, geometric)
        first = first or float(load[0])
        if load[0] <= STANDS:
            return Support(factor, True, number, first)
        factor = np.minimum(factor * _needed(system, load, shapes, limb), STIFFEST)
    return Support(factor, False, ROUNDS, first)


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
    count = min(MODES, size - 1)
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


def _needed(system: ElementSystem, load: Floats, shapes: Floats, limb: Int32s) -> Floats:
    """Factors (m,) for the limbs that hold the modes whose load factor is too large."""
    factor = np.ones(int(limb.max()) + 1)
    for one, shape in zip(load, shapes, strict=True):
        if one <= STANDS:
            break
        energy = np.bincount(limb, _energy(system, shape), len(factor))
        most = np.argsort(-energy)
        before = np.concatenate([[0.0], np.cumsum(energy[most])[:-1]]) / energy.sum()
        holding = most[before < HOLDING]
        factor[holding] = np.maximum(factor[holding], 1.0 + one)
    return factor[limb]


def _energy(system: ElementSystem, shape: Floats) -> Floats:
    """Twice the elastic energy (m,) of the elements' corners in a shape (N,3), J."""
    corner = shape[system.elements[:, :4]]
    blocks = system.blocks.reshape(-1, 10, 3, 3)
    total = np.zeros(len(corner))
    for p, (i, j) in enumerate(PAIRS):
        twice = 1.0 if i == j else 2.0
        total += twice * np.einsum("ea,eab,eb->e", corner[:, i], blocks[:, p], corner[:, j])
    return total
