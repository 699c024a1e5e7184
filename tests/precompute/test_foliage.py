"""Silhouettes of known area; foliage keeps its mass, area and shape."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from galewood.mesh.repair import Surface
from galewood.mesh.types import RenderPrimitive, TreeMesh
from galewood.model.binding import nearest_tets
from galewood.model.foliage import LEAF_MASS_KG_M2, MOST_LEAF_MASS, bind_foliage, render_binding
from galewood.model.silhouette import silhouette_area

from tests.precompute import tree_meshes as make
from tests.precompute.tet_meshes import Y_SEGMENTS, y_mesh

WOOD: Any = SimpleNamespace(density_kg_m3=900.0, drag_coefficient=0.5)


@pytest.fixture(scope="module")
def mesh():
    return y_mesh()


def tree(leaves: Surface | None = None) -> TreeMesh:
    wood = make.joined(*(make.tube(a, b, r, r) for a, b, r in Y_SEGMENTS))
    return make.as_tree(wood, leaves)


def leaf_cards(count=60, seed=11) -> Surface:
    random = np.random.default_rng(seed)
    return make.cards(random.uniform((-1, 3, -0.5), (1.5, 5, 0.5), (count, 3)), size=0.2)


def test_silhouette_of_an_opaque_and_a_half_transparent_ball():
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=4, radius=1.5)
    triangles = np.array(ball.triangles)
    exact = np.pi * 1.5**2
    assert silhouette_area(triangles, np.ones(len(triangles))) == pytest.approx(exact, rel=0.01)
    half = silhouette_area(
        triangles, np.full(len(triangles), 0.5)
    )  # front and back together transmit a quarter
    assert half == pytest.approx(0.75 * exact, rel=0.02)


def test_silhouette_of_a_wall_is_its_mean_projection():
    wall = make.cards([(0, 0, 0)], size=2.0)
    angles = np.arange(6) * np.pi / 6
    exact = 4.0 * np.abs(np.cos(angles)).mean()
    assert silhouette_area(wall.vertices[wall.faces], np.ones(2)) == pytest.approx(exact, rel=0.02)


def test_frontal_area_and_leaf_mass_are_conserved(mesh):
    leaves = leaf_cards()
    lumped = bind_foliage(tree(leaves), mesh, WOOD)
    assert lumped.mass_kg.sum() == pytest.approx(LEAF_MASS_KG_M2 * 60 * 0.04)
    top = lumped.report["silhouette_m2"] * WOOD.drag_coefficient
    assert 0.7 * top < lumped.drag_area_m2.sum() < top  # reduced by the height profile
    assert (lumped.mass_kg >= 0).all()
    assert (lumped.drag_area_m2 >= 0).all()
    assert mesh.vertices_m[lumped.fixed][:, 1].max() < 0.11


def test_leaf_mass_is_capped_and_bare_trees_have_none(mesh):
    heavy = bind_foliage(tree(make.cards([(0, 4, 0)] * 400, size=3.0)), mesh, WOOD)
    assert heavy.report["leaf_mass_capped"]
    assert heavy.mass_kg.sum() == pytest.approx(MOST_LEAF_MASS * heavy.report["wood_mass_kg"])
    assert bind_foliage(tree(), mesh, WOOD).mass_kg.sum() == 0


def test_leaves_that_are_left_out_load_nothing(mesh):
    whole = tree(leaf_cards())
    wood = replace(tree(), height_m=whole.height_m)
    left_out, without = bind_foliage(whole, mesh, WOOD, leaves=False), bind_foliage(wood, mesh, WOOD)
    in_leaf = bind_foliage(whole, mesh, WOOD)
    leaves_kg = in_leaf.report["leaf_mass_kg"]
    assert left_out.report["leaf_mass_kg"] == 0 < leaves_kg
    assert left_out.mass_kg.sum() == pytest.approx(in_leaf.mass_kg.sum() - leaves_kg)
    assert (left_out.drag_area_m2 == without.drag_area_m2).all()


def test_wood_follows_exactly_and_each_leaf_card_rigidly(mesh):
    whole = tree(leaf_cards())
    weights = render_binding(whole, mesh)
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


def test_leaf_is_bound_where_it_is_nearest_to_the_wood(mesh):
    leaves = make.cards([(0.22, 1.0, 0), (0.15, 4.1, 0.1)], size=0.1)
    weights = render_binding(tree(leaves), mesh)[-8:]
    at = weights @ mesh.vertices_m
    nearest = nearest_tets(leaves.vertices, mesh)
    for k in range(2):
        card = slice(4 * k, 4 * k + 4)
        gap = np.linalg.norm(at[card] - leaves.vertices[card], axis=1).min()
        assert gap == pytest.approx(nearest.distance_m[card].min(), abs=1e-6)  # stored with 32 bits


def test_leaf_between_two_twigs_has_the_same_binding_after_reloading(mesh):
    """A reloaded mesh has 32-bit positions. Evaluations rejected such trees: their modes differed."""
    x, y = 0.35, 3.6
    whole = tree(make.cards([(x, y, 0.0), (-x, y, 0.0), (0.0, y, 0.0)] * 8, size=0.3))
    rounded = [
        replace(p, positions_m=p.positions_m.astype(np.float32).astype(float)) for p in whole.primitives
    ]
    again = replace(whole, primitives=rounded)
    assert abs(render_binding(whole, mesh) - render_binding(again, mesh)).max() == 0


def test_crown_as_large_as_the_tree_is_not_rigid(mesh):
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=2, radius=1.4)
    crown = Surface(np.array(ball.vertices) + np.array([0, 3.6, 0]), np.array(ball.faces, dtype=np.int32))
    primitive = RenderPrimitive("leaves_0", "leaves", crown.vertices, crown.faces)
    whole = TreeMesh([primitive], crown.vertices, crown.faces, 5.0, None, {})
    moved = render_binding(whole, mesh) @ (mesh.vertices_m * (1.0, 0, 0))
    assert np.ptp(moved[:, 0]) > 0.5
