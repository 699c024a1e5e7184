"""Batched linear elements compared with a plain numpy implementation, one element at a time."""

import numpy as np
import pytest
from galewood.solid.fem.elements.assembly import ElementSystem
from galewood.solid.fem.elements.elasticity import PAIRS, gradients, moduli, stiffness_blocks
from galewood.wood.species import wood_of_species

from tests.precompute.fixtures.tet_meshes import grid_mesh

SEED = 5
COUNTS = (1, 7, 8, 9, 43)


def loose_system(count: int, rng: np.random.Generator) -> ElementSystem:
    """The first elements of a grid with random stiffness factors and prestress and a few fixed nodes."""
    mesh = grid_mesh(lambda points: points[:, 0] > -9, (0, 0, 0), (2, 2, 2), 1.0)
    tets = mesh.tets[:count].astype(np.int32)
    vertices = mesh.vertices_m + rng.uniform(-0.1, 0.1, mesh.vertices_m.shape)
    used = np.unique(tets)
    tets, vertices = np.searchsorted(used, tets).astype(np.int32), vertices[used]
    grad, volume = gradients(vertices[tets])
    fibre = rng.normal(size=(count, 3))
    fibre /= np.linalg.norm(fibre, axis=1)[:, None]
    axial, shear = stiffness_blocks(grad, volume, fibre, moduli(wood_of_species("maple")))
    blocks = axial * rng.uniform(0.2, 1, (count, 1, 1, 1)) + shear * rng.uniform(0.2, 1, (count, 1, 1, 1))
    stress = rng.normal(size=(count, 3, 3)) * 1e7
    stress += stress.transpose(0, 2, 1)
    prestress = np.stack(
        [np.einsum("ei,eij,ej->e", grad[:, a], stress, grad[:, b]) * volume for a, b in PAIRS], axis=1
    )
    fixed = np.arange(2, dtype=np.int32)
    return ElementSystem(vertices, tets, grad, blocks, fixed, prestress)


def plain_assembly(system: ElementSystem, u: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force (N,3) and stiffness (3N,3N) by polar decomposition with an SVD."""
    size = len(system.rest)
    force, matrix = np.zeros((size, 3)), np.zeros((size, 3, size, 3))
    for e, corners in enumerate(system.elements):
        left, _, right = np.linalg.svd(np.eye(3) + u[corners].T @ system.grad[e])
        turn = left @ right
        for p, (i, j) in enumerate(PAIRS):
            block = turn @ system.blocks[e, p].reshape(3, 3) @ turn.T
            for a, b, k in ((i, j, block), (j, i, block.T))[: 1 if i == j else 2]:
                n, m = corners[a], corners[b]
                apart = system.rest[m] + u[m] + w[m] - turn @ system.rest[m]
                force[n] += k @ apart + system.prestress[e, p] * w[m]
                matrix[n, :, m] += k + system.prestress[e, p] * np.eye(3)
    return force, matrix.reshape(3 * size, 3 * size)


@pytest.mark.parametrize("count", COUNTS)
def test_force_and_matrix_agree_with_plain_numpy(count: int) -> None:
    print(f"seed {SEED}")
    rng = np.random.default_rng(SEED)
    system = loose_system(count, rng)
    u, w = (rng.uniform(-size, size, system.rest.shape) for size in (0.15, 0.01))
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    u = (system.rest + u) @ turn.T - system.rest
    mass, out = rng.uniform(1, 2, len(u)), np.empty_like(u)
    system.assemble(u, w, 0.7, mass, out)
    force, matrix = plain_assembly(system, u, w)
    np.testing.assert_allclose(out, force, atol=1e-12 * np.abs(force).max())
    inner = 3 * system.free
    expected = 0.7 * matrix[:inner, :inner] + np.diag(np.repeat(mass[: system.free], 3))
    found = system.solver.to_scipy(system.values).toarray()
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


def test_flat_or_inverted_element_does_not_affect_its_batch() -> None:
    print(f"seed {SEED}")
    rng = np.random.default_rng(SEED)
    system = loose_system(43, rng)
    u, still = np.zeros_like(system.rest), np.zeros_like(system.rest)
    touched = system.elements[3]
    corner = touched[~np.isin(touched, np.delete(system.elements, 3, axis=0))]
    corner = corner[0] if len(corner) else touched[0]
    others = [n for n in touched if n != corner]
    normal = np.cross(*(system.rest[others[1:]] - system.rest[others[0]]))
    normal /= np.linalg.norm(normal)
    height = (system.rest[corner] - system.rest[others[0]]) @ normal
    for share in (1.0, 1.7):  # flat, then inverted
        u[corner] = -share * height * normal
        out = np.empty_like(u)
        system.force(u, still, out)
        alone = np.unique(system.elements[(system.elements != corner).all(axis=1)])
        untouched = np.setdiff1d(alone, system.elements[(system.elements == corner).any(axis=1)])
        assert np.isfinite(out).all() and len(untouched) > 9
        assert np.abs(out[untouched]).max(initial=0) <= 1e-9 * np.abs(out).max()
        assert np.abs(out.sum(axis=0)).max() <= 1e-9 * np.abs(out).max()


def test_stiffness_and_prestress_can_be_replaced() -> None:
    print(f"seed {SEED}")
    rng = np.random.default_rng(SEED)
    one, other = loose_system(9, np.random.default_rng(SEED)), loose_system(9, rng)
    blocks, prestress = other.blocks * 0.5, other.prestress * -0.25
    other.set_blocks(blocks.reshape(-1, 10, 3, 3))
    other.set_prestress(prestress)
    u, w = (rng.uniform(-0.05, 0.05, one.rest.shape) for _ in range(2))
    one.blocks, one.prestress = blocks, prestress
    force, _ = plain_assembly(one, u, w)
    found = np.empty_like(u)
    other.force(u, w, found)
    np.testing.assert_allclose(found, force, atol=1e-12 * np.abs(force).max())


def test_forces_around_no_nodes_are_empty() -> None:
    system = loose_system(9, np.random.default_rng(SEED))
    out = np.ones_like(system.rest)
    system.around(np.zeros(0, np.int32)).force(out, out, out)
    assert not out.any()


def test_forces_around_a_node_agree_with_the_full_assembly() -> None:
    print(f"seed {SEED}")
    rng = np.random.default_rng(SEED)
    system = loose_system(43, rng)
    u, still = rng.uniform(-0.1, 0.1, system.rest.shape), np.zeros_like(system.rest)
    whole, part = np.empty_like(u), np.empty_like(u)
    nodes = np.array([0, 3], np.int32)
    system.force(u, still, whole)
    system.around(nodes).force(u, still, part)
    np.testing.assert_allclose(part[nodes], whole[nodes], atol=1e-13 * np.abs(whole).max())
