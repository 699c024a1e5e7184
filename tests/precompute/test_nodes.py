"""Nodes: vertices that move alike share a node, and none deviates from it beyond the tolerance."""

import numpy as np
import scipy.sparse
from galewood.reduction.nodes import largest_motion_m, make_nodes, render_basis


def bending(v: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices up a pole and a basis that bends it in two directions."""
    rng = np.random.default_rng(seed)
    height = rng.uniform(0, 10, v)
    basis = np.zeros((v, 3, 2))
    basis[:, 0, 0] = basis[:, 2, 1] = (height / 10) ** 2
    return basis, np.stack([0 * height, height, 0 * height], axis=1)


def test_no_vertex_deviates_beyond_the_tolerance() -> None:
    basis, vertices = bending(3000, 1)
    nodes = make_nodes(basis, vertices, np.array([0.5, 0.2]), 0.005)
    rows = (nodes.basis[nodes.vertex_node] - basis) * np.array([0.5, 0.2])
    assert np.linalg.norm(rows.reshape(len(basis), -1), axis=1).max() <= 0.0076
    assert len(nodes.rest_m) < 200
    assert nodes.vertex_node.max() < len(nodes.rest_m)


def test_the_number_of_nodes_is_limited() -> None:
    basis, vertices = bending(3000, 2)
    assert len(make_nodes(basis, vertices, np.ones(2), 1e-9, max_nodes=50).rest_m) <= 50


def test_a_stiff_pole_that_hardly_moves_still_bends() -> None:
    basis, vertices = bending(2000, 4)
    q_rms = np.array([1e-4, 0.5e-4])
    sway_m = largest_motion_m(basis, q_rms)
    highest = vertices[:, 1].max() / 10
    assert np.isclose(sway_m, np.hypot(*q_rms) * highest**2)
    nodes = make_nodes(basis, vertices, q_rms, 0.03 * sway_m)
    moved = np.linalg.norm(nodes.basis[nodes.vertex_node, 0, :], axis=1)
    assert len(nodes.rest_m) > 10
    assert moved[vertices[:, 1] < 1].max() < 0.05 < 0.9 < moved[vertices[:, 1] > 9.9].min()


def test_vertices_with_equal_motion_share_a_node() -> None:
    basis, vertices = bending(50, 3)
    twice = make_nodes(np.repeat(basis, 4, axis=0), np.repeat(vertices, 4, axis=0), np.ones(2), 1e-6)
    assert (twice.vertex_node.reshape(50, 4) == twice.vertex_node.reshape(50, 4)[:, :1]).all()
    assert twice.max_error_m < 1e-6


def test_render_basis_is_the_weighted_mean_of_its_vertices() -> None:
    rng = np.random.default_rng(4)
    basis, weights = rng.normal(size=(6, 3, 2)), rng.dirichlet(np.ones(4), 10)
    holders = np.array([rng.choice(6, 4, replace=False) for _ in range(10)])
    binding = scipy.sparse.csr_matrix(
        (weights.ravel(), (np.repeat(np.arange(10), 4), holders.ravel())), (10, 6)
    )
    expected = np.einsum("vk,vkir->vir", weights, basis[holders])
    assert np.allclose(render_basis(binding, basis), expected)
