"""Linear tetrahedra fitted to quadratic ones on the same mesh.

Linear tets lock in bending by a factor that depends on the mesh. Under the same smooth loads, each element should hold
the energy it holds in the quadratic mesh; where it holds less, it is too stiff. Fixed-point rounds scale each
element by the ratio of the energies, averaged over its patch.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from precompute.assembly import ElementSystem
from precompute.elasticity import PAIRS
from precompute.quadratic import elevate

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


class Fit(NamedTuple):
    """Factors (m,) on the axial and on the shear stiffness of each element, and how the fit went."""

    axial: Floats
    shear: Floats
    report: dict[str, Any]

    def apply(self, axial: Floats, shear: Floats) -> Floats:
        """The fitted stiffness blocks (m,10,3,3)."""
        return self.axial[:, None, None, None] * axial + self.shear[:, None, None, None] * shear


def fit_factors(
    vertices_m: Floats,
    tets: Ints,
    grad: Floats,
    axial: Floats,
    shear: Floats,
    fixed: Ints,
    *,
    loads: int = 24,
    rounds: int = 8,
    seed: int = 0,
) -> Fit:
    """Fit the factors of linear tets to the quadratic mesh under random smooth static loads."""
    force = smooth_loads(vertices_m, loads, seed)
    target = _quadratic_energies(vertices_m, tets, grad, axial + shear, fixed, force)
    patch = _patch_mean(tets, len(vertices_m))
    factor = np.ones(len(tets))
    aim = (patch @ target).sum(axis=1)
    change = np.inf
    for _ in range(rounds):
        blocks = factor[:, None, None, None] * (axial + shear)
        u = _static(ElementSystem(vertices_m, tets, grad, blocks, fixed), force)
        has = (patch @ element_energies(blocks, tets, u)).sum(axis=1)
        ratio = has / aim
        factor *= ratio
        change = float(np.median(np.abs(ratio - 1)))
    return Fit(factor, factor, {"rounds": rounds, "last_change": change})


def smooth_loads(vertices_m: Floats, count: int, seed: int) -> Floats:
    """(count,n,3) random fields of force, smooth over a fraction of the tree's height."""
    rng = np.random.default_rng(seed)
    height = float(np.ptp(vertices_m[:, 1]))
    wave = rng.normal(size=(count, 4, 3)) * (2 * np.pi / height)
    phase = rng.uniform(0, 2 * np.pi, (count, 4))
    direction = rng.normal(size=(count, 4, 3))
    angle = np.einsum("cwk,nk->cwn", wave, vertices_m) + phase[:, :, None]
    return np.einsum("cwn,cwk->cnk", np.cos(angle), direction)


def element_energies(blocks: Floats, tets: Ints, u: Floats) -> Floats:
    """(m,loads) twice the energy of linear elements, blocks (m,10,3,3), under displacements u (loads,n,3)."""
    local = u[:, tets]
    energy = np.zeros((len(tets), len(u)))
    for p, (i, j) in enumerate(PAIRS):
        term = np.einsum("lei,eij,lej->el", local[:, :, i], blocks[:, p], local[:, :, j], optimize=True)
        energy += term if i == j else 2 * term
    return energy


def _quadratic_energies(
    vertices_m: Floats, tets: Ints, grad: Floats, blocks: Floats, fixed: Ints, force: Floats
) -> Floats:
    nodes, elements = elevate(vertices_m, tets)
    system = ElementSystem(nodes, elements, grad, blocks, fixed)
    wide = np.zeros((len(force), len(nodes), 3))
    wide[:, : len(vertices_m)] = force
    u = _static(system, wide)
    return quadratic_energies(blocks, elements, u)


def quadratic_energies(blocks: Floats, elements: Ints, u: Floats) -> Floats:
    """(m,loads) twice the energy of quadratic elements, integrated exactly from their strains at four points."""
    from precompute.quadratic import combination

    c = combination()
    local = u[:, elements]
    energy = np.zeros((len(elements), len(u)))
    # Σ_ab u_a K_ab u_b with K_ab = Σ c K_ij: gather the nodal terms of each linear block first.
    for p in range(len(c.rows)):
        a, b = int(c.rows[p]), int(c.columns[p])
        for t in range(int(c.start[p]), int(c.start[p + 1])):
            first, second = (b, a) if c.transposed[t] else (a, b)
            term = np.einsum(
                "lei,eij,lej->el", local[:, :, first], blocks[:, c.block[t]], local[:, :, second]
            )
            energy += c.coefficient[t] * (term if a == b else 2 * term)
    return energy


def _static(system: ElementSystem, force: Floats) -> Floats:
    """Small-strain displacements (loads,N,3) of the rest shape under forces (loads,N,3)."""
    zero = np.zeros_like(system.rest)
    system.assemble(zero, zero, 1.0, np.zeros(len(zero)), zero.copy())
    system.solver.factorise(system.values)
    u = np.zeros_like(force)
    for load, out in zip(force, u, strict=True):
        inner = np.ascontiguousarray(load[system.order])
        system.solver.solve(inner)
        inner[system.free :] = 0
        out[system.order] = inner
    return u


def _patch_mean(tets: Ints, vertices: int) -> csr_matrix:
    """(m,m) averaging over the elements that share a vertex, weighted by how many they share."""
    ones = np.ones(tets.size)
    touch = csr_matrix(
        (ones, (np.repeat(np.arange(len(tets)), 4), tets.ravel())), shape=(len(tets), vertices)
    )
    return csr_matrix(touch @ touch.T)
