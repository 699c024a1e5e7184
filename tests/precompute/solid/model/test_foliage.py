"""Silhouettes of known area; foliage keeps its mass and area."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from galewood.solid.model.foliage import (
    EVERGREEN_LEAF_MASS_KG_M2,
    LEAF_MASS_KG_M2,
    MOST_LEAF_MASS,
    bind_foliage,
)
from galewood.solid.model.silhouette import silhouette_area
from galewood.wood import wood_of_species

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.tet_meshes import leaf_cards, y_mesh, y_tree_mesh

WOOD: Any = SimpleNamespace(
    density_kg_m3=900.0, drag_coefficient=0.5, streamlined_exponent=1.64, evergreen=False
)


@pytest.fixture(scope="module")
def mesh():
    return y_mesh()


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
    lumped = bind_foliage(y_tree_mesh(leaves), mesh, WOOD)
    assert lumped.mass_kg.sum() == pytest.approx(LEAF_MASS_KG_M2 * 60 * 0.04)
    top = lumped.report["silhouette_m2"] * WOOD.drag_coefficient
    assert 0.7 * top < lumped.drag_area_m2.sum() < top  # reduced by the height profile
    assert (lumped.mass_kg >= 0).all()
    assert (lumped.drag_area_m2 >= 0).all()
    assert mesh.vertices_m[lumped.fixed][:, 1].max() < 0.11


def test_leaves_of_evergreens_are_heavier_per_area(mesh):
    shed, kept = (
        bind_foliage(y_tree_mesh(leaf_cards()), mesh, wood_of_species(name)) for name in ("larch", "spruce")
    )
    assert kept.mass_kg.sum() == pytest.approx(
        EVERGREEN_LEAF_MASS_KG_M2 / LEAF_MASS_KG_M2 * shed.mass_kg.sum()
    )


def test_leaf_mass_is_capped_and_bare_trees_have_none(mesh):
    heavy = bind_foliage(y_tree_mesh(make.cards([(0, 4, 0)] * 400, size=3.0)), mesh, WOOD)
    assert heavy.report["leaf_mass_capped"]
    assert heavy.mass_kg.sum() == pytest.approx(MOST_LEAF_MASS * heavy.report["wood_mass_kg"])
    assert bind_foliage(y_tree_mesh(), mesh, WOOD).mass_kg.sum() == 0


def test_leaves_that_are_left_out_load_nothing(mesh):
    whole = y_tree_mesh(leaf_cards())
    wood = replace(y_tree_mesh(), height_m=whole.height_m)
    left_out, without = bind_foliage(whole, mesh, WOOD, leaves=False), bind_foliage(wood, mesh, WOOD)
    in_leaf = bind_foliage(whole, mesh, WOOD)
    assert (in_leaf.streamlined_exponent, left_out.streamlined_exponent) == (1.64, 2.0)
    assert without.streamlined_exponent == 2.0
    leaves_kg = in_leaf.report["leaf_mass_kg"]
    assert left_out.report["leaf_mass_kg"] == 0 < leaves_kg
    assert left_out.mass_kg.sum() == pytest.approx(in_leaf.mass_kg.sum() - leaves_kg)
    assert (left_out.drag_area_m2 == without.drag_area_m2).all()
