"""Checks of the elements: patch test, rigid motions, stiffness against scikit-fem."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from galewood.check.verify.bars import Bar, box_bar
from galewood.check.verify.checks import Check, absolute, skipped
from galewood.solid.fem import ElementSystem, elevate, gradients, moduli, stiffness_blocks
from galewood.util import Floats
from galewood.wood import Wood, wood_of_species

RANDOM_SEED = 7


def checks() -> Iterator[Check]:
    """All checks of this module."""
    bar = shaken_box()
    for element in ("linear", "quadratic"):
        system = element_system(bar, element)
        yield absolute(
            f"patch test, {element}: force inside under uniform strain", patch_error(system), 1e-12
        )
        yield absolute(f"rigid translation, {element}: force", rigid_error(system, turn=0.0), 1e-12)
        yield absolute(f"rigid rotation, {element}: force", rigid_error(system, turn=2.0), 1e-12)
    yield from _against_scikit_fem()


def shaken_box() -> Bar:
    """A box of 3 × 3 × 3 cells of tets whose inner vertices are randomly displaced."""
    bar = box_bar(size_m=(1.0, 1.0, 1.0), cells=(3, 3, 3))
    inside = _inside(bar.vertices_m)
    moved = bar.vertices_m.copy()
    moved[inside] += np.random.default_rng(RANDOM_SEED).uniform(-0.06, 0.06, (int(inside.sum()), 3))
    return replace(bar, vertices_m=moved)


def _inside(points: Floats) -> NDArray[np.bool_]:
    low, high = points.min(axis=0), points.max(axis=0)
    return ((points > low + 1e-6) & (points < high - 1e-6)).all(axis=1)


def element_system(bar: Bar, element: str) -> ElementSystem:
    """Elements of the bar in poplar wood with an oblique fibre direction; one node is fixed."""
    grad, volume = gradients(bar.vertices_m[bar.tets])
    fibre = np.tile([0.48, 0.6, 0.64], (len(bar.tets), 1))
    axial, shear = stiffness_blocks(grad, volume, fibre, moduli(wood_of_species("poplar")))
    nodes, elements = bar.vertices_m, bar.tets
    if element == "quadratic":
        nodes, elements = elevate(nodes, elements)
    return ElementSystem(nodes, elements, grad, axial + shear, np.zeros(1, np.int32))


def patch_error(system: ElementSystem) -> float:
    """Largest force on inner nodes under a linear displacement field, over the largest on the surface."""
    gradient = np.array([[0.010, -0.004, 0.003], [0.002, -0.006, 0.005], [-0.001, 0.007, 0.004]])
    field, still, force = system.rest @ gradient.T, np.zeros_like(system.rest), np.zeros_like(system.rest)
    system.force(still, field, force)
    inside = _inside(system.rest)
    return float(np.abs(force[inside]).max() / np.abs(force[~inside]).max())


def rigid_error(system: ElementSystem, turn: float) -> float:
    """Largest force after a rigid motion (rotation `turn` in rad), over stiffness times size of the body."""
    axis = np.array([1.0, -2.0, 0.5]) / np.linalg.norm([1.0, -2.0, 0.5])
    cross = np.cross(np.eye(3), axis)
    rotation = np.eye(3) + np.sin(turn) * cross + (1 - np.cos(turn)) * cross @ cross
    u = system.rest @ rotation.T + np.array([3.0, -1.0, 2.0]) - system.rest
    force = np.zeros_like(u)
    system.force(u, np.zeros_like(u), force)
    return float(np.abs(force).max() / (np.abs(system.blocks).max() * np.ptp(system.rest)))


def elasticity_tensor(wood: Wood, fibre: Floats) -> Floats:
    """(3, 3, 3, 3) elasticity tensor of a wood, Pa, derived independently of the block formulas."""
    m, eye, aa = moduli(wood), np.eye(3), np.outer(fibre, fibre)

    def both(a: Floats, b: Floats) -> Floats:
        return (np.einsum("ik,jl->ijkl", a, b) + np.einsum("il,jk->ijkl", a, b)) / 2

    outer = np.einsum("ij,kl->ijkl", eye, eye)
    mixed = np.einsum("ij,kl->ijkl", aa, eye) + np.einsum("ij,kl->ijkl", eye, aa)
    return (
        m.lam * outer
        + 2 * m.mu_t * both(eye, eye)
        + m.alpha * mixed
        + 2 * (m.mu_l - m.mu_t) * (both(eye, aa) + both(aa, eye))
        + m.beta * np.einsum("ij,kl->ijkl", aa, aa)
    )


def _against_scikit_fem() -> Iterator[Check]:
    for element in ("linear", "quadratic"):
        name = f"element stiffness against scikit-fem, {element}: eigenvalues"
        try:
            ours, theirs = stiffness_eigenvalues(element)
        except ImportError:
            yield skipped(name, "scikit-fem is not installed (a development dependency)")
            continue
        yield absolute(name, float(np.abs(ours - theirs).max() / theirs.max()), 1e-12)


def stiffness_eigenvalues(element: str) -> tuple[Floats, Floats]:
    """Eigenvalues of the stiffness of the distorted box: ours and scikit-fem's. Raises ImportError."""
    import skfem

    bar = shaken_box()
    system = element_system(replace(bar, tets=bar.tets[:40]), element)
    used = np.unique(system.elements)
    ours = np.asarray(np.linalg.eigvalsh(dense_stiffness(system, used)), np.float64)
    tensor = elasticity_tensor(wood_of_species("poplar"), np.array([0.48, 0.6, 0.64]))

    def energy(u: Any, v: Any, _: Any) -> Any:
        return np.einsum("ijkl,kl...,ij...->...", tensor, u.grad, v.grad)

    vertices, tets = np.unique(bar.tets[:40], return_inverse=True)
    mesh = skfem.MeshTet(bar.vertices_m[vertices].T, tets.reshape(-1, 4).T)
    kind = skfem.ElementTetP1() if element == "linear" else skfem.ElementTetP2()
    basis = skfem.Basis(mesh, skfem.ElementVector(kind), intorder=4)
    theirs = np.asarray(np.linalg.eigvalsh(skfem.BilinearForm(energy).assemble(basis).toarray()), np.float64)
    return ours, theirs


def dense_stiffness(system: ElementSystem, nodes: NDArray[np.integer[Any]]) -> Floats:
    """(3k, 3k) stiffness in the rest pose at k nodes, from the forces of unit displacements."""
    still, force = np.zeros_like(system.rest), np.zeros_like(system.rest)
    columns: list[Floats] = []
    for node in nodes:
        for axis in range(3):
            unit = np.zeros_like(system.rest)
            unit[node, axis] = 1.0
            system.force(still, unit, force)
            columns.append(force[nodes].ravel())
    return np.array(columns)
