"""Branches from the surface of the wood alone, and the motion of a tree of beams along them."""

import numpy as np
import pytest
from galewood.check.verify.beams import pole_frequencies
from galewood.check.verify.specimens import forms_of, read_frame
from galewood.options import ImportRequest
from galewood.pipeline.sampling import MAX_SWAY_SHARE
from galewood.pipeline.tables import BuildOptions
from galewood.pipeline.tables.from_beams import beam_table
from galewood.solid.beams import frame_frequencies, frame_matrices, frame_modes
from galewood.solid.model.beam_tree import beam_model, frame_of
from galewood.solid.skeleton import outline_of
from galewood.solid.skeleton.bridges import bridges
from galewood.tree.importer import read_tree
from galewood.wood.species import wood_of_species

from tests.precompute.fixtures.shared_tets import small_tree_glb
from tests.precompute.fixtures.tree_meshes import FORK_M, joined, tube, y_tree
from tests.precompute.solid.test_beams import SPECIES

WOOD = wood_of_species("maple")


def height_of_clamp(points_m):
    return 0.02 * float(np.ptp(points_m[:, 1]))


@pytest.mark.parametrize("direction", [(0, 1, 0), (1, 2, -1)])
def test_a_tube_is_one_branch_along_its_axis(direction):
    end = 4.0 * np.array(direction) / np.linalg.norm(direction)
    surface = tube((0, 0, 0), end, 0.1, 0.05, sides=24, rings=12)
    outline = outline_of(surface.vertices, surface.faces)
    assert outline.branch.max() == 0
    assert (outline.parent == np.arange(-1, len(outline.parent) - 1)).all()
    along = outline.points_m @ end / 4.0
    away = np.linalg.norm(outline.points_m - along[:, None] * end / 4.0, axis=1)
    inner = (along > 0.3) & (along < 3.7)
    assert away[inner].max() < 0.01
    np.testing.assert_allclose(outline.radius_m[inner], 0.1 - 0.05 * along[inner] / 4.0, rtol=0.03)
    assert along.max() == pytest.approx(4.0, abs=0.02)


def test_a_tube_has_the_frequencies_of_beam_theory():
    surface = tube((0, 0, 0), (0, 4.0, 0), 0.05, 0.05, sides=32, rings=9)
    frame = frame_of(outline_of(surface.vertices, surface.faces))
    found = frame_frequencies(frame, WOOD, height_of_clamp(frame.points_m), 4)
    clamped_m = frame.points_m[frame.points_m[:, 1] <= height_of_clamp(frame.points_m), 1].max()
    area, moment = np.pi * 0.05**2, np.pi * 0.05**4 / 4
    exact = pole_frequencies(4.0 - clamped_m, WOOD.young_longitudinal_pa, WOOD.density_kg_m3, area, moment)
    np.testing.assert_allclose(found[[0, 2]], exact, rtol=0.02)
    np.testing.assert_allclose(found[[0, 2]], found[[1, 3]], rtol=1e-3)


@pytest.mark.parametrize("meeting_m", [1.2, 2.0, 2.03, 2.7])
def test_a_limb_of_two_capped_pieces_has_no_hinge_where_they_meet(meeting_m):
    """As scanned limbs are, one piece per segment: levels cut the tapered caps, not the limb."""
    cap_m, overlap_m = 0.06, 0.03
    low = tube((0, 0, 0), (0, meeting_m + overlap_m, 0), 0.05, 0.05, sides=24, rings=120)
    high = tube((0, meeting_m - overlap_m, 0), (0, 4.0, 0), 0.05, 0.05, sides=24, rings=120)
    low.vertices[:, [0, 2]] *= np.clip((meeting_m + overlap_m - low.vertices[:, [1]]) / cap_m, 0.05, 1)
    high.vertices[:, [0, 2]] *= np.clip((high.vertices[:, [1]] - meeting_m + overlap_m) / cap_m, 0.05, 1)
    whole = tube((0, 0, 0), (0, 4.0, 0), 0.05, 0.05, sides=24, rings=120)
    first_hz = []
    for surface in (joined(low, high), whole):
        frame = frame_of(outline_of(surface.vertices, surface.faces))
        first_hz.append(frame_frequencies(frame, WOOD, height_of_clamp(frame.points_m), 1)[0])
    assert first_hz[0] == pytest.approx(first_hz[1], rel=0.1)


def test_limbs_that_are_tubes_of_their_own_grow_from_the_trunk():
    surface = y_tree()
    outline = outline_of(surface.vertices, surface.faces)
    starts = np.flatnonzero(outline.branch[outline.parent] != outline.branch)[1:]
    assert outline.branch.max() + 1 == 2, "the trunk continues in one of its limbs"
    assert outline.points_m[outline.parent[starts], 1] == pytest.approx(FORK_M, abs=0.2)


def test_a_crossing_limb_grows_from_its_base_and_not_from_the_crossing():
    trunk = tube((0, 0, 0), (0, 5, 0), 0.15, 0.1, sides=16, rings=40)
    low = tube((0, 2, 0), (2, 2.6, 0), 0.06, 0.03, rings=20)
    high = tube((0, 3.5, 0), (1.5, 2.3, 0.02), 0.05, 0.02, rings=20)  # its tip touches the lower limb
    surface = joined(trunk, low, high)
    pairs = bridges(surface.vertices, surface.faces)
    first = np.cumsum([0, len(trunk.vertices), len(low.vertices)])
    part = np.searchsorted(first, pairs, side="right") - 1
    assert sorted(map(tuple, part.tolist())) == [(1, 0), (2, 0)]
    assert np.abs(surface.vertices[pairs[:, 0], 0]).max() < 0.15


def test_separate_bodies_without_any_contact_are_connected():
    surface = joined(
        tube((0, 0, 0), (0, 3, 0), 0.1, 0.1), tube((0, 3.4, 0), (0, 5, 0), 0.08, 0.02),
        tube((1.5, 3, 0), (2.5, 4, 0), 0.05, 0.02),
    )  # fmt: skip
    outline = outline_of(surface.vertices, surface.faces)
    assert (outline.parent[1:] >= 0).all() and (outline.parent[1:] < np.arange(1, len(outline.parent))).all()
    assert outline.points_m[:, 1].max() > 4.9


FORMS = forms_of(SPECIES)


@pytest.mark.parametrize("name", FORMS)
def test_a_species_moves_like_the_frame_of_its_generator(name):
    """The outline comes from the drawn surface, the other frame from the generator's exact skeleton."""
    tree = read_tree(
        (SPECIES / f"{name}.glb").read_bytes(), f"{name}.glb", ImportRequest(species=FORMS[name][0])
    )
    wood = wood_of_species(FORMS[name][0])
    found = frame_of(outline_of(tree.wood_vertices_m, tree.wood_faces))
    exact = read_frame(SPECIES / f"{name}.skeleton.json")
    clamped_m = height_of_clamp(found.points_m)
    first = [frame_frequencies(frame, wood, clamped_m, 2) for frame in (found, exact)]
    np.testing.assert_allclose(first[0], first[1], rtol=0.05)
    assert found.volume_m3() == pytest.approx(exact.volume_m3(), rel=0.05)


def test_modes_of_a_frame_are_orthonormal_in_its_mass():
    surface = y_tree()
    frame = frame_of(outline_of(surface.vertices, surface.faces))
    modes = frame_modes(frame, WOOD, 0.1, 8)
    _, mass = frame_matrices(frame, WOOD)
    shapes = modes.shapes.reshape(8, -1)
    np.testing.assert_allclose(shapes @ (mass @ shapes.T), np.eye(8), atol=1e-8)


def test_the_embedding_turns_vertices_rigidly_with_their_beam():
    tree = read_tree(small_tree_glb(), "tree.glb", ImportRequest(species="maple"))
    model = beam_model(tree, WOOD)
    assert np.asarray(model.embedding.sum(axis=1)).ravel() == pytest.approx(1.0)
    # a rigid rotation of all particles about the origin rotates every vertex
    points = frame_of(outline_of(tree.wood_vertices_m, tree.wood_faces)).points_m
    arm_m = 0.02 * tree.height_m
    particles = (points[:, None] + np.concatenate([np.zeros((1, 3)), arm_m * np.eye(3)])).reshape(-1, 3)
    spin = np.array([[0, -0.2, 0.1], [0.2, 0, -0.3], [-0.1, 0.3, 0]])
    places = np.concatenate([p.positions_m for p in tree.primitives if p.kind == "wood"])
    moved = model.embedding[: len(places)] @ (particles @ spin.T)
    np.testing.assert_allclose(moved, places @ spin.T, atol=1e-9)


def test_the_steady_sway_is_proportional_to_the_pressure():
    tree = read_tree(small_tree_glb(), "tree.glb", ImportRequest(species="maple"))
    model = beam_model(tree, WOOD)
    assert model.sway_m(200.0) == pytest.approx(2 * model.sway_m(100.0))
    assert model.sway_m(100.0) > 0


def test_beams_that_would_bend_too_far_get_a_weaker_design_wind():
    tree = read_tree(small_tree_glb(), "tree.glb", ImportRequest(species="maple"))
    asked, frequency_hz = 60.0, 0.05
    options = BuildOptions(design_speed_m_s=asked, first_frequency_hz=frequency_hz)
    metadata = beam_table(tree, options, b"").metadata
    limp = WOOD.scaled(beam_model(tree, WOOD).factor_for(frequency_hz))
    speed_m_s = metadata["design_speed_m_s"]
    assert speed_m_s < asked
    share = beam_model(tree, limp).steady_sway_m(speed_m_s) / tree.height_m
    assert share == pytest.approx(MAX_SWAY_SHARE, rel=1e-6)
    assert metadata["provenance"]["stage"] == "beams" and metadata["provenance"]["preliminary"]
