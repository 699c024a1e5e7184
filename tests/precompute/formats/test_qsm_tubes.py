"""Tubes around scanned branches: closed, of the right size and place, and as stiff as beams."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.check.verify.beams import pole_frequencies
from galewood.formats import alpha_coverage
from galewood.formats.qsm.branches import branch_lines, chained
from galewood.formats.qsm.reading import MOST_BRANCHES, SPACINGS
from galewood.options import ImportRequest
from galewood.solid.beams import Frame, frame_frequencies
from galewood.solid.model import beam_model
from galewood.tree.importer import read_tree
from galewood.tree.repair import Surface, face_components, signed_volumes
from galewood.tree.types import TreeMesh
from galewood.wood import wood_of_species

from tests.precompute.fixtures import cylinder_models as make

LEAFLESS = ImportRequest(add_leaves=False)
SEEDS = (1, 2, 3)


def read(model, options=LEAFLESS) -> TreeMesh:
    return read_tree(make.archi(model), "a.csv", options)


def volume_m3(tree: TreeMesh) -> float:
    count, of_face = face_components(tree.wood_faces, len(tree.wood_vertices_m))
    return float(signed_volumes(Surface(tree.wood_vertices_m, tree.wood_faces), of_face, count).sum())


def test_a_pole_has_the_volume_and_size_of_its_cylinders() -> None:
    model = make.pole()
    tree = read(model)
    assert volume_m3(tree) == pytest.approx(float(model.volume_m3.sum()), rel=0.01)
    assert tree.height_m == pytest.approx(6.0, abs=0.05)
    assert tree.wood_vertices_m[:, 1].min() == pytest.approx(0.0, abs=1e-9)
    assert tree.report["repairs"]["pieces"] == 1


def test_a_tapered_pole_sways_as_beam_theory_says() -> None:
    wood = wood_of_species("ash")
    found = beam_model(read(make.pole()), wood).frequencies_hz
    area, moment = np.pi * 0.08**2, np.pi * 0.08**4 / 4
    exact = pole_frequencies(6.0, wood.young_longitudinal_pa, wood.density_kg_m3, area, moment, 0.5)
    np.testing.assert_allclose(found[[0, 2]], exact, rtol=0.05)
    np.testing.assert_allclose(found[[1, 3]], exact, rtol=0.05)


def frequency_of_beams(points, radius, links) -> float:
    """Lowest frequency of beams that are clamped at the first point, z up."""
    upright = np.asarray(points)[:, [0, 2, 1]]
    frame = Frame(upright, np.asarray(links), np.asarray(radius), np.zeros(len(links), bool))
    return float(frame_frequencies(frame, wood_of_species("ash"), 0.0, 1)[0])


@pytest.mark.parametrize("seed", SEEDS)
def test_the_line_through_a_crooked_stem_sways_like_its_cylinders(seed: int) -> None:
    """Joining and smoothing neither shortens the stem nor makes it stiffer by more than a few per cent."""
    print(f"seed {seed}")
    random = np.random.default_rng(seed)
    place = np.column_stack([random.normal(size=(61, 2)) * 0.012, np.linspace(0, 6, 61)])
    place[0] = 0.0
    stem = make.chain(place, np.linspace(0.06, 0.02, 60) * random.uniform(0.95, 1.05, 60))
    exact = frequency_of_beams(place, stem.radius_m, [(k, k + 1) for k in range(60)])
    line = branch_lines(stem, chained(stem), SPACINGS[0])[0]
    one, other = line.radius_m[:-1], line.radius_m[1:]
    radius = np.sqrt((one**2 + one * other + other**2) / 3)
    found = frequency_of_beams(line.points_m, radius, [(k, k + 1) for k in range(len(radius))])
    assert found == pytest.approx(exact, rel=0.03)


def test_a_branch_that_is_thicker_than_its_limb_keeps_its_volume() -> None:
    model = make.y_model()
    wide = replace(model, radius_m=np.where(np.arange(7) > 3, 0.1, model.radius_m))
    lines = branch_lines(wide, chained(wide), SPACINGS[0])
    trunk, limb = sorted(lines, key=lambda line: float(np.ptp(line.points_m[:, 0])))
    assert limb.radius_m[0] <= trunk.nearest(limb.points_m[0])[1] + 1e-9
    assert limb.radius_m[1:].max() == pytest.approx(0.1)


def test_a_branch_begins_inside_the_limb_that_bears_it() -> None:
    tree = read(make.y_model())
    count, of_face = face_components(tree.wood_faces, len(tree.wood_vertices_m))
    assert count == 2
    limb = tree.wood_vertices_m[np.unique(tree.wood_faces[of_face == 1])]
    trunk = tree.wood_vertices_m[np.unique(tree.wood_faces[of_face == 0])]
    if limb[:, 1].min() < trunk[:, 1].min():
        limb = trunk
    base = limb[np.argsort(limb[:, 1])[:3]]
    assert (np.hypot(base[:, 0], base[:, 2]) < 0.09).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_tree_is_made_of_closed_pieces(seed: int) -> None:
    print(f"seed {seed}")
    tree = read(make.random_model(seed), ImportRequest(add_leaves=False, min_radius_mm=0))
    faces = tree.wood_faces
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, shared = np.unique(edges, axis=0, return_counts=True)
    assert (shared == 2).all()
    count, of_face = face_components(faces, len(tree.wood_vertices_m))
    assert (signed_volumes(Surface(tree.wood_vertices_m, faces), of_face, count) > 0).all()
    repairs = tree.report["repairs"]
    assert count == repairs["pieces"] == tree.report["qsm"]["branches"]
    assert not any(value for name, value in repairs.items() if name != "pieces")


def test_a_tree_far_from_the_origin_is_the_same() -> None:
    near, far = (read(make.moved(make.y_model(), by)) for by in (0.0, np.array([4e5, 5e6, 253.0])))
    np.testing.assert_allclose(near.primitives[0].positions_m, far.primitives[0].positions_m, atol=1e-6)
    assert (near.primitives[0].faces == far.primitives[0].faces).all()
    assert volume_m3(near) == pytest.approx(volume_m3(far), rel=1e-6)


def test_radii_are_scaled_to_the_diameter_at_breast_height() -> None:
    plain, wide = read(make.y_model()), read(make.y_model(), ImportRequest(add_leaves=False, dbh_cm=36.0))
    assert wide.report["qsm"]["dbh_cm"] == pytest.approx(36.0)
    assert wide.report["qsm"]["wood_volume_m3"] == pytest.approx(4 * plain.report["qsm"]["wood_volume_m3"])
    assert wide.report["qsm"]["height_m"] == pytest.approx(4.0)


def test_a_given_height_scales_the_whole_tree() -> None:
    qsm = read(make.y_model(), ImportRequest(add_leaves=False, height_m=8.0)).report["qsm"]
    assert (qsm["height_m"], qsm["dbh_cm"]) == (pytest.approx(8.0), pytest.approx(40.0))


def test_thin_branches_are_dropped() -> None:
    tree = read(make.y_model(), ImportRequest(add_leaves=False, min_radius_mm=60))
    assert tree.report["qsm"]["dropped"]["thin_branches"] == 1
    assert tree.report["repairs"]["pieces"] == 1


def test_noise_in_the_radii_keeps_the_volume() -> None:
    random = np.random.default_rng(5)
    model = make.pole(count=60)
    noisy = make.chain(
        np.vstack([model.start_m, model.end_m[-1:]]), model.radius_m * random.uniform(0.7, 1.3, 60)
    )
    assert volume_m3(read(noisy)) == pytest.approx(float(noisy.volume_m3.sum()), rel=0.02)


def test_many_short_cylinders_stay_within_the_number_of_faces() -> None:
    random = np.random.default_rng(2)
    place = np.column_stack(
        [np.cumsum(random.normal(size=(8001, 2)) * 1e-3, axis=0), np.linspace(0, 20, 8001)]
    )
    tree = read(make.chain(place, np.linspace(0.2, 0.02, 8000)))
    assert len(tree.wood_faces) <= 60_000


def test_leaves_hang_at_the_ends_of_branches() -> None:
    tree = read(make.y_model(), ImportRequest())
    leaves = [part for part in tree.primitives if part.kind == "leaves"]
    assert len(leaves) == 1 and leaves[0].material is not None
    assert leaves[0].material.json["name"] == "leaves"
    assert leaves[0].normals is not None and leaves[0].uv is not None
    corner = leaves[0].positions_m[leaves[0].faces]
    area = (
        np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum() / 2
    )
    leafy = area * alpha_coverage(leaves[0].material)
    assert leafy == pytest.approx(4000 * np.pi / 4 * 0.18**2, rel=1e-6)
    assert [part.kind for part in read(make.y_model()).primitives] == ["wood"]


def test_leaves_hang_along_the_thin_part_of_a_branch_and_at_its_tip() -> None:
    """A pole is thinner than 2 cm over its upper third: the sprigs begin there, not lower."""
    leaves = read(make.pole(base_m=0.05, tip_m=0.005), ImportRequest()).primitives[1]
    assert leaves.uv is not None
    base = leaves.positions_m[leaves.uv[:, 1] == 1]  # the stalks
    assert base[:, 1].min() > 3.0
    assert 3.5 < np.median(base[:, 1]) < 5.5
    thick = read(make.pole(), ImportRequest()).primitives[1]
    assert thick.positions_m[:, 1].min() > 4.0  # at the tip alone


def test_a_tree_of_very_many_branches_comes_with_a_warning() -> None:
    for count, many in ((400, False), (2500, True)):
        tree = read(make.random_model(4, count), ImportRequest(add_leaves=False, min_radius_mm=0))
        assert (tree.report["qsm"]["branches"] > 300) == many
        assert any("so many branches" in warning for warning in tree.report["warnings"]) == many


@pytest.mark.parametrize("seed", SEEDS)
def test_a_scan_keeps_as_many_branches_as_can_be_simulated(seed: int) -> None:
    """The radius at which it is cut is chosen; a given one is used as it is."""
    print(f"seed {seed}")
    model = make.random_model(seed, 2500)
    chosen = read(model).report["qsm"]
    kept = chosen["branches"] - chosen["dropped"]["thin_branches"]
    assert 0.5 * MOST_BRANCHES < kept <= MOST_BRANCHES
    assert chosen["min_radius_mm"] > 10
    given = ImportRequest(add_leaves=False, min_radius_mm=chosen["min_radius_mm"])
    assert read(model, given).report["qsm"]["dropped"] == chosen["dropped"]
    finer = read(model, ImportRequest(add_leaves=False, min_radius_mm=5)).report["qsm"]
    assert finer["min_radius_mm"] == 5
    assert finer["branches"] - finer["dropped"]["thin_branches"] > kept
    assert read(make.y_model()).report["qsm"]["min_radius_mm"] == 10
