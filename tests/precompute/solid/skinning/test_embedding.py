"""Render vertices follow the tetrahedra that they are embedded in; pieces of foliage and twigs stay rigid."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.solid.skinning import nearest_tets, render_embedding
from galewood.solid.skinning.embedding import nearest_of_pieces
from galewood.tree.repair import Surface
from galewood.tree.types import RenderPrimitive, TreeMesh

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.tet_meshes import leaf_cards, y_mesh, y_tree_mesh


@pytest.fixture(scope="module")
def mesh():
    return y_mesh()


def test_wood_follows_exactly_and_each_leaf_card_rigidly(mesh):
    whole = y_tree_mesh(leaf_cards())
    weights = render_embedding(whole, mesh)
    assert np.allclose(np.asarray(weights.sum(axis=1)).ravel(), 1)
    seed = 2
    gradient = np.random.default_rng(seed).normal(size=(3, 3)) * 0.1
    moved = weights @ (mesh.vertices_m @ gradient.T)
    wood = whole.primitives[0].positions_m
    inside = nearest_tets(wood, mesh).distance_m < 1e-9
    assert inside.mean() > 0.2
    assert np.allclose(moved[: len(wood)][inside], wood[inside] @ gradient.T), f"seed {seed}"
    leaves = moved[len(wood) :].reshape(-1, 4, 3)
    assert np.allclose(leaves, leaves[:, :1]), f"seed {seed}"


def test_a_leaf_is_embedded_where_it_is_nearest_to_the_wood(mesh):
    leaves = make.cards([(0.22, 1.0, 0), (0.15, 4.1, 0.1)], size=0.1)
    weights = render_embedding(y_tree_mesh(leaves), mesh)[-8:]
    at = weights @ mesh.vertices_m
    nearest = nearest_tets(leaves.vertices, mesh)
    for k in range(2):
        card = slice(4 * k, 4 * k + 4)
        gap = np.linalg.norm(at[card] - leaves.vertices[card], axis=1).min()
        assert gap == pytest.approx(nearest.distance_m[card].min(), abs=1e-6)  # stored with 32 bits


def test_a_leaf_between_two_twigs_is_embedded_alike_after_reloading(mesh):
    """A reloaded mesh has 32-bit positions. Evaluations rejected such trees: their modes differed."""
    x, y = 0.35, 3.6
    whole = y_tree_mesh(make.cards([(x, y, 0.0), (-x, y, 0.0), (0.0, y, 0.0)] * 8, size=0.3))
    rounded = [
        replace(p, positions_m=p.positions_m.astype(np.float32).astype(float)) for p in whole.primitives
    ]
    again = replace(whole, primitives=rounded)
    assert abs(render_embedding(whole, mesh) - render_embedding(again, mesh)).max() == 0


def test_crown_as_large_as_the_tree_is_not_rigid(mesh):
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=2, radius=1.4)
    crown = Surface(np.array(ball.vertices) + np.array([0, 3.6, 0]), np.array(ball.faces, dtype=np.int32))
    primitive = RenderPrimitive("leaves_0", "leaves", crown.vertices, crown.faces)
    whole = TreeMesh([primitive], crown.vertices, crown.faces, 5.0, None, {})
    moved = render_embedding(whole, mesh) @ (mesh.vertices_m * (1.0, 0, 0))
    assert np.ptp(moved[:, 0]) > 0.5


def test_a_twig_follows_its_base_even_where_it_pierces_another_limb():
    distance_m = np.array([3e-17, 0.1, 0.0, 0.2, 0.05, 0.04])
    piece = np.array([0, 0, 0, 0, 1, 1])
    assert nearest_of_pieces(distance_m, piece).tolist() == [0, 5]
