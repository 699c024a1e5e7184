"""Thickening, wrapping and meshing of shapes with known radius and volume."""

from typing import Any

import numpy as np
import pytest
from galewood.sandbox.limited_process import Limits, run_limited
from galewood.solid.tets.meshing import tetrahedralise
from galewood.solid.tets.polish import polished
from galewood.solid.tets.quality import (
    boundary_faces,
    largest_component,
    lost_extent,
    quality_report,
    restore_volume,
    tet_volumes,
)
from galewood.solid.tets.refine import refined
from galewood.solid.tets.thicken import inscribed_radius, surface_samples, thicken
from galewood.solid.tets.wrap import decimate, votes_for_inside, whole_part, wrap
from galewood.tree.repair import Surface, face_components, open_edges, volume
from galewood.util import MeshError

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.tet_meshes import grid_mesh, y_mesh


@pytest.fixture(scope="module")
def meshed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tets")
    tree = make.as_tree(make.y_tree())
    return tree, tetrahedralise(tree, target_tets=1500, cache_dir=folder), folder


def test_inscribed_radius_of_a_tube_and_of_a_triangular_prism():
    for sides, apothem in ((24, 0.1 * np.cos(np.pi / 24)), (3, 0.1 * np.cos(np.pi / 3))):
        tube = make.tube((0, 0, 0), (0, 2, 0), 0.1, 0.1, sides=sides)
        points, normals, face = surface_samples(tube)
        radius = inscribed_radius(tube, points, normals, face, 0.5)
        middle = np.abs(points[:, 1] - 1.0) < 0.6
        assert np.median(radius[middle]) == pytest.approx(apothem, rel=0.06)


@pytest.mark.parametrize("sides", [3, 4, 12])
def test_thin_tubes_are_thickened_to_the_floor_and_thick_ones_unchanged(sides):
    thin, thick = (
        make.tube((0, 0, 0), (0, 3, 0), 0.01, 0.01, sides=sides),
        make.tube((1, 0, 0), (1, 3, 0), 0.2, 0.2, sides=32),
    )
    raised = thicken(make.joined(thin, thick), 0.05)
    count = len(thin.vertices)
    middle = (raised.surface.vertices[:count, 1] > 0.5) & (raised.surface.vertices[:count, 1] < 2.5)
    reached = np.hypot(*raised.surface.vertices[:count][middle][:, [0, 2]].T)
    assert (reached >= 0.05 * 0.99).all()
    assert (reached <= 0.05 / np.cos(np.pi / sides) * 1.15).all()
    assert np.abs(raised.surface.vertices[count:] - thick.vertices).max() < 1e-9
    near_thin = raised.sample_points[:, 0] < 0.5
    true_ratio = 0.01 * np.cos(np.pi / sides) / 0.05
    assert np.median(raised.sample_ratio[near_thin]) == pytest.approx(true_ratio, rel=0.1)
    assert (raised.sample_ratio[~near_thin] > 0.99).all()


def test_inside_agrees_with_the_exact_union_of_two_balls():
    seed = 5
    random = np.random.default_rng(seed)
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=3, radius=6.0)
    centres = np.array([[9.0, 9.0, 9.0], [14.0, 10.0, 9.5]])
    both = make.joined(
        *(Surface(np.array(ball.vertices) + c, np.array(ball.faces, dtype=np.int32)) for c in centres)
    )
    got = votes_for_inside(both.vertices[both.faces], (24, 20, 20)) >= 2
    points = random.integers(0, (24, 20, 20), (2000, 3))
    gap = np.linalg.norm(points[:, None] - centres, axis=2).min(axis=1)
    clear = np.abs(gap - 6.0) > 0.15  # the icosphere lies slightly inside the ball
    assert (got[tuple(points[clear].T)] == (gap[clear] < 6.0)).all(), f"seed {seed}"


def test_wrap_of_overlapping_tubes_is_one_closed_solid_of_the_right_volume():
    cross = make.joined(
        make.tube((0, -1, 0), (0, 1, 0), 0.2, 0.2, 32), make.tube((-1, 0, 0), (1, 0, 0), 0.2, 0.2, 32)
    )
    area = 32 / 2 * 0.2**2 * np.sin(2 * np.pi / 32)
    union = 2 * area * 2.0 - 16 / 3 * 0.2**3  # two tubes minus their intersection (Steinmetz solid)
    solid = wrap(cross, 0.03)
    assert face_components(solid.faces, len(solid.vertices))[0] == 1
    assert not len(open_edges(solid.faces))
    assert volume(solid) == pytest.approx(union, rel=0.02)
    coarse = decimate(solid, 1000)
    assert len(coarse.faces) <= 1000
    assert volume(coarse) == pytest.approx(union, rel=0.05)


def test_tree_mesh_is_connected_positive_and_complete(meshed):
    tree, mesh, _ = meshed
    assert 0.5 * 1500 < len(mesh.tets) < 1.5 * 1500
    assert (tet_volumes(mesh.vertices_m, mesh.tets) > 0).all()
    assert largest_component(mesh.vertices_m, mesh.tets)[2] == 0
    assert lost_extent(tree.wood_vertices_m, mesh.vertices_m) < 0.03
    assert ((mesh.radius_ratio > 0) & (mesh.radius_ratio <= 1)).all()
    union = mesh.report["volume_m3"]
    assert union == pytest.approx(volume(Surface(tree.wood_vertices_m, tree.wood_faces)), rel=0.15)
    assert not len(open_edges(boundary_faces(mesh.tets)))


def test_mesh_is_cached_under_the_hash_of_its_input(meshed):
    tree, mesh, folder = meshed
    again = tetrahedralise(tree, target_tets=1500, cache_dir=folder)
    assert (again.vertices_m == mesh.vertices_m).all()
    assert (again.tets == mesh.tets).all()
    assert again.report == mesh.report
    assert len(list(folder.iterdir())) == 1


def test_volume_is_restored_by_a_uniform_offset(meshed):
    _, mesh, _ = meshed
    before = tet_volumes(mesh.vertices_m, mesh.tets).sum()
    grown = restore_volume(mesh.vertices_m, mesh.tets, 1.05 * before)
    after = tet_volumes(grown, mesh.tets)
    assert after.sum() == pytest.approx(1.05 * before, rel=1e-2)
    assert (after > 0).all()


def test_polishing_repairs_displaced_vertices_and_keeps_the_shape():
    seed, cell = 7, 0.1
    bar = grid_mesh(lambda points: np.ones(len(points), bool), (0, 0, 0), (0.6, 2.0, 0.6), cell)
    faces = boundary_faces(bar.tets)
    inner = np.setdiff1d(np.arange(len(bar.vertices_m)), faces)
    random = np.random.default_rng(seed)
    shaken = bar.vertices_m.copy()
    shaken[inner] += random.uniform(-0.3, 0.3, (len(inner), 3)) * cell
    assert (tet_volumes(shaken, bar.tets) > 0).all(), f"seed {seed}"
    before, moved = quality_report(shaken, bar.tets), polished(shaken, bar.tets, 0.2 * cell)
    after = quality_report(moved, bar.tets)
    assert after["shape_min"] > before["shape_min"] + 0.1, f"seed {seed}"
    assert (tet_volumes(moved, bar.tets) > 0).all()
    assert after["volume_m3"] == pytest.approx(2.0 * 0.36, rel=0.01)
    assert np.linalg.norm(moved - shaken, axis=1)[np.unique(faces)].max() <= 0.2 * cell * (1 + 1e-9)


def test_a_regular_tetrahedron_stays_where_it_is():
    corners = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    tets = np.array([[0, 1, 3, 2]], dtype=np.int32)
    assert tet_volumes(corners, tets)[0] > 0
    assert (polished(corners, tets, 1.0) == corners).all()


def test_splitting_long_edges_keeps_solid_surface_and_shapes():
    coarse = y_mesh(cell=0.11)
    vertices, tets = refined(coarse.vertices_m, coarse.tets, 3 * len(coarse.tets))
    assert 3 * len(coarse.tets) <= len(tets) < 3.2 * len(coarse.tets)
    volumes = tet_volumes(vertices, tets)
    assert (volumes > 0).all()
    assert volumes.sum() == pytest.approx(tet_volumes(coarse.vertices_m, coarse.tets).sum(), rel=1e-12)
    assert largest_component(vertices, tets)[2] == 0
    skin = Surface(vertices, boundary_faces(tets))
    assert not len(open_edges(skin.faces))
    assert volume(skin) == pytest.approx(volumes.sum(), rel=1e-12)
    worst = quality_report(coarse.vertices_m, coarse.tets)["shape_min"]
    assert quality_report(vertices, tets)["shape_min"] > 0.4 * worst


def test_meshes_with_enough_tets_are_not_split():
    coarse = y_mesh(cell=0.11)
    assert refined(coarse.vertices_m, coarse.tets, len(coarse.tets))[1] is coarse.tets


def test_a_part_behind_a_pinched_edge_counts_as_lost():
    corners = np.array([[0.0, 0, 0], [0, 1, 0], [1, 0.5, 0], [0.5, 0.5, 1], [-1, 0.5, 0], [-0.5, 0.5, 0.5]])
    tets = np.array([[0, 2, 1, 3], [0, 1, 4, 5]], dtype=np.int32)  # they share the edge 0-1 only
    size = tet_volumes(corners, tets)
    tets[size < 0] = tets[size < 0][:, [0, 1, 3, 2]]
    kept, share = whole_part(Surface(corners, boundary_faces(tets)))
    assert sorted(map(tuple, kept)) == sorted(map(tuple, corners[[0, 1, 2, 3]]))
    assert share == pytest.approx(np.abs(size).max() / np.abs(size).sum())


def test_mesher_crash_raises_mesh_error():
    bad: Any = {"vertices": np.zeros((4, 3)), "faces": np.array([[0, 1, 2], [1, 2, 3]], dtype=np.int32)}
    settings: Any = {
        "epsilon": np.float64(1e-3),
        "edge_length": np.float64(0.05),
        "stop_energy": np.float64(30.0),
    }
    settings["passes"] = np.array(2)
    with pytest.raises(MeshError) as caught:
        run_limited(
            "galewood.sandbox.tetwild:tetrahedralise_surface",
            bad | settings,
            Limits(cpu_s=30),
            what="Meshing",
        )
    assert caught.value.reason == "unsuitable"


@pytest.mark.parametrize("target", [10, 10**7])
def test_targets_out_of_range_are_rejected(target):
    with pytest.raises(MeshError, match="out of range"):
        tetrahedralise(make.as_tree(make.y_tree()), target_tets=target)
