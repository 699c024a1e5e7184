"""Element stiffness compared with its tensor form, scikit-fem and exact integrals."""

import numpy as np
import pytest
from galewood.check.verify.element_checks import (
    elasticity_tensor,
    element_system,
    patch_error,
    rigid_error,
    shaken_box,
    stiffness_eigenvalues,
)
from galewood.solid.fem.elements.elasticity import PAIRS, gradients, moduli, stiffness_blocks
from galewood.solid.fem.elements.quadratic import combination, elevate, midside_parents, node_mass_shares
from galewood.wood.species import wood_of_species

SEED = 11


def _random_tet() -> np.ndarray:
    print(f"seed {SEED}")
    corners = np.random.default_rng(SEED).normal(size=(1, 4, 3))
    return corners if np.linalg.det(corners[0, 1:] - corners[0, :1]) > 0 else corners[:, [1, 0, 2, 3]]


def test_blocks_are_the_tensor_contracted_with_the_gradients() -> None:
    corners = _random_tet()
    fibre = np.array([[0.0, 0.6, 0.8]])
    grad, volume = gradients(corners)
    axial, shear = stiffness_blocks(grad, volume, fibre, moduli(wood_of_species("apricot")))
    tensor = elasticity_tensor(wood_of_species("apricot"), fibre[0])
    for p, (i, j) in enumerate(PAIRS):
        expected = volume[0] * np.einsum("ijkl,j,l->ik", tensor, grad[0, i], grad[0, j])
        np.testing.assert_allclose(
            (axial + shear)[0, p], expected, rtol=1e-12, atol=1e-6 * np.abs(expected).max()
        )


def test_engineering_constants_are_recovered_from_the_tensor() -> None:
    wood, fibre = wood_of_species("maple"), np.array([0.0, 0.0, 1.0])
    tensor = elasticity_tensor(wood, fibre)
    voigt = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    stiffness = np.array([[tensor[*a, *b] for b in voigt] for a in voigt])
    compliance = np.linalg.inv(stiffness)
    assert np.isclose(1 / compliance[2, 2], wood.young_longitudinal_pa)
    assert np.isclose(1 / compliance[0, 0], wood.young_transverse_pa)
    assert np.isclose(1 / compliance[3, 3], wood.shear_longitudinal_pa)
    assert np.isclose(1 / compliance[5, 5], wood.shear_transverse_pa)
    assert np.isclose(-compliance[0, 2] / compliance[2, 2], wood.poisson_longitudinal)
    assert np.isclose(-compliance[0, 1] / compliance[0, 0], wood.poisson_transverse)


def test_both_parts_of_the_stiffness_are_positive_semidefinite() -> None:
    grad, volume = gradients(_random_tet())
    for part in stiffness_blocks(
        grad, volume, np.array([[0.6, 0.0, 0.8]]), moduli(wood_of_species("poplar"))
    ):
        full = np.zeros((4, 3, 4, 3))
        for p, (i, j) in enumerate(PAIRS):
            full[i, :, j], full[j, :, i] = part[0, p], part[0, p].T
        eigenvalues = np.linalg.eigvalsh(full.reshape(12, 12))
        assert eigenvalues.min() > -1e-12 * eigenvalues.max()


@pytest.mark.parametrize("element", ["linear", "quadratic"])
def test_patch_and_rigid_motions(element: str) -> None:
    system = element_system(shaken_box(), element)
    assert patch_error(system) < 1e-12
    assert rigid_error(system, turn=0.0) < 1e-12
    assert rigid_error(system, turn=3.0) < 1e-12


@pytest.mark.parametrize("element", ["linear", "quadratic"])
def test_stiffness_agrees_with_scikit_fem(element: str) -> None:
    ours, theirs = stiffness_eigenvalues(element)
    np.testing.assert_allclose(ours, theirs, atol=1e-12 * theirs.max())


def test_quadratic_combination_is_complete_and_mass_shares_sum_to_one() -> None:
    c = combination()
    assert (len(c.rows), int(c.start[-1])) == (55, len(c.coefficient))
    assert np.isclose(node_mass_shares().sum(), 1)
    assert np.allclose(node_mass_shares()[:4], 1 / 36)


def test_elevated_mesh_shares_its_midside_nodes() -> None:
    bar = shaken_box()
    nodes, elements = elevate(bar.vertices_m, bar.tets)
    parents = midside_parents(len(bar.vertices_m), elements)
    np.testing.assert_allclose(nodes[len(bar.vertices_m) :], bar.vertices_m[parents].mean(axis=1))
    assert len(np.unique(parents, axis=0)) == len(parents)
