"""Skeletons of shapes with known axes, radii and branches."""

import numpy as np
import pytest
from galewood.pipeline.pictures.build_pictures import skeleton_png
from galewood.solid.skeleton.extraction import extract_skeleton, sampled_elements
from galewood.solid.skeleton.levels import cut_sections, geodesic_distance, inner_faces
from galewood.solid.skeleton.roots import root_vertices
from galewood.solid.skeleton.tree import branches, reach

from tests.precompute.fixtures.tet_meshes import Y_SEGMENTS, grid_mesh, near_segment, y_mesh


@pytest.fixture(scope="module")
def y_tree():
    mesh = y_mesh()
    return mesh, extract_skeleton(mesh)


def test_sections_of_a_bar_have_its_area_and_centre():
    bar = grid_mesh(lambda p: np.ones(len(p), bool), (0, 0, 0), (0.2, 2.0, 0.3), 0.05)
    height = bar.vertices_m[:, 1]
    sections = cut_sections(bar.vertices_m, bar.tets, height, inner_faces(bar.tets), 0.173)
    assert len(sections.level) == 12
    assert np.allclose(sections.area_m2, (0, 0.06, 0), atol=1e-12)
    assert np.allclose(sections.centre_m[:, 1], (sections.level + 0.5) * 0.173)
    assert np.allclose(sections.centre_m[:, [0, 2]], (0.1, 0.15), atol=0.02)


def test_geodesic_distance_is_between_straight_and_edge_lengths():
    bar = grid_mesh(lambda p: np.ones(len(p), bool), (0, 0, 0), (0.2, 2.0, 0.3), 0.05)
    roots = root_vertices(bar.vertices_m, bar.tets)
    distance = geodesic_distance(bar.vertices_m, bar.tets, roots, inner_faces(bar.tets))
    height = bar.vertices_m[:, 1]
    assert (distance >= height - 1e-12).all()
    assert (distance <= height + 1e-9).all()  # attained, as the grid has vertical edges


def test_y_has_three_limbs_with_their_directions_and_radii(y_tree):
    mesh, skeleton = y_tree
    assert skeleton.branch.max() + 1 == 2  # the trunk continues into its longer limb
    assert (skeleton.parent[1:] < np.arange(1, len(skeleton.parent))).all()
    centre = mesh.vertices_m[mesh.tets].mean(axis=1)
    away = np.linalg.norm(centre - (0, 2.7, 0), axis=1) > 0.7
    for start, end, radius in Y_SEGMENTS:
        along = (np.array(end) - start) / np.linalg.norm(np.array(end) - start)
        own = near_segment(centre, start, end, 0.6 * radius) & away
        own &= np.linalg.norm(centre - end, axis=1) > 0.35  # the grid resolves rounded ends in steps
        angle = np.degrees(np.arccos(np.clip(skeleton.tet_fibre[own] @ along, -1, 1)))
        assert np.median(angle) < 3
        assert np.percentile(angle, 90) < 8
        points = near_segment(skeleton.points_m, start, end, 0.5 * radius)
        points &= np.linalg.norm(skeleton.points_m - (0, 2.7, 0), axis=1) > 0.7
        points &= np.linalg.norm(skeleton.points_m - end, axis=1) > 0.3
        assert np.median(skeleton.radius_m[points]) == pytest.approx(radius, rel=0.12)


def test_every_tet_has_a_unit_fibre_a_branch_and_a_point(y_tree):
    mesh, skeleton = y_tree
    assert np.allclose(np.linalg.norm(skeleton.tet_fibre, axis=1), 1)
    assert (skeleton.tet_branch == skeleton.branch[skeleton.tet_point]).all()
    gap = np.linalg.norm(
        mesh.vertices_m[mesh.tets].mean(axis=1) - skeleton.points_m[skeleton.tet_point], axis=1
    )
    assert gap.max() < 0.5


def test_sampled_elements_are_nested_distinct_and_free(y_tree):
    mesh, skeleton = y_tree
    many = sampled_elements(mesh, skeleton, 435)
    assert len(set(many.tolist())) == 435
    for count in (1, 35, 135):
        assert (sampled_elements(mesh, skeleton, count) == many[:count]).all()
    fixed = root_vertices(mesh.vertices_m, mesh.tets)
    assert not np.isin(mesh.tets[many[:135]], fixed).any()
    with pytest.raises(ValueError, match="cannot sample"):
        sampled_elements(mesh, skeleton, len(mesh.tets) + 1)


def test_twig_hanging_to_the_ground_is_not_a_root():
    def holds(points):
        trunk = near_segment(points, (0, 0, 0), (0, 3, 0), 0.25)
        branch = near_segment(points, (0, 2.6, 0), (1.2, 2.6, 0), 0.1)
        twig = near_segment(points, (1.2, 2.6, 0), (1.2, 0, 0), 0.07)
        return (points[:, 1] > 0) & (trunk | branch | twig)

    mesh = grid_mesh(holds, (-0.3, 0, -0.3), (1.4, 3.3, 0.3), 0.05)
    roots = mesh.vertices_m[root_vertices(mesh.vertices_m, mesh.tets)]
    assert roots[:, 0].max() < 0.4
    assert roots[:, 1].max() <= 0.02 * 3.4
    skeleton = extract_skeleton(mesh)
    tips = np.setdiff1d(np.arange(len(skeleton.parent)), skeleton.parent)
    assert np.linalg.norm(skeleton.points_m[tips] - (1.2, 0, 0), axis=1).min() < 0.2


@pytest.mark.parametrize("touching", [False, True])
def test_fused_limbs_are_reported(touching):
    """Two limbs of one trunk whose ends fuse in the solid form one loop."""
    ends = ((0.03, 3.4, 0) if touching else (0.6, 3.4, 0), (-0.03, 3.4, 0) if touching else (-0.6, 3.4, 0))

    def holds(points):
        limbs = [near_segment(points, (0, 0, 0), (0, 1, 0), 0.2)]
        for side, end in zip((1, -1), ends, strict=True):
            limbs.append(near_segment(points, (0, 1, 0), (0.7 * side, 2.2, 0), 0.13))
            limbs.append(near_segment(points, (0.7 * side, 2.2, 0), end, 0.13))
        return (points[:, 1] > 0) & np.any(limbs, axis=0)

    skeleton = extract_skeleton(grid_mesh(holds, (-1, 0, -0.3), (1, 3.6, 0.3), 0.06))
    assert skeleton.report["meetings"] == int(touching)


def test_branches_follow_the_longest_reach():
    points = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 0], [1, 1, 0], [2, 1, 0], [3, 1, 0]], dtype=float)
    parent = np.array([-1, 0, 1, 1, 3, 4])
    assert reach(points, parent).tolist() == [4, 3, 0, 2, 1, 0]
    assert branches(points, parent).tolist() == [0, 0, 1, 0, 0, 0]


def test_skeleton_image_shows_the_tree(y_tree):
    import io

    from PIL import Image

    mesh, skeleton = y_tree
    image = Image.open(io.BytesIO(skeleton_png(mesh, skeleton, sampled_elements(mesh, skeleton, 35))))
    pixels = np.asarray(image.convert("RGB")).astype(int)
    trunk = np.abs(pixels - (242, 173, 63)).max(axis=2) < 12  # the colour of the trunk line
    rows, columns = np.nonzero(trunk)
    assert len(rows) > 500
    assert np.ptp(rows) > image.height / 3  # the trunk line extends over the height of the tree
    assert np.ptp(columns) > 0
