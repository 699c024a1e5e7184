"""Names that say nothing, evidence from all sources, and what is asked instead of decided silently."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.formats import FileContent, read_parts
from galewood.options import ImportRequest
from galewood.tree.importer import classify_content, read_tree
from galewood.tree.pieces.names import named_kind, named_other
from galewood.tree.pieces.other_objects import Others
from galewood.tree.repair import Surface
from galewood.tree.species_names import guess_species, named_habit
from galewood.tree.surface import _chained, solid_wood
from galewood.tree.unit import choose_scale

from tests.precompute.fixtures.labelled.looks import OTHER, Look, Part
from tests.precompute.fixtures.labelled.parts import broadleaf, trunk
from tests.precompute.fixtures.labelled.shapes import Shape, ball, box, cards, in_ball, together, tube
from tests.precompute.fixtures.labelled.trees import STYLES, LabelledFile, labelled_file
from tests.precompute.fixtures.labelled.writers import write_obj
from tests.precompute.fixtures.packs.files import pack_file

SEED = 71
MOST_CHANGED = 0.02
"""Share of the faces whose kind may depend on names, where textures or colours tell it."""


def kinds_of(content: FileContent) -> np.ndarray:
    _, _, found = classify_content(content, ImportRequest())
    return np.concatenate([np.array([found.groups[g].kind for g in row]) for row in found.group_of_face])


def with_neutral_names(content: FileContent) -> FileContent:
    """The same parts, called Object_0, Object_1, …; parts of equal names keep equal names."""
    number = {labels: k for k, labels in enumerate(dict.fromkeys(part.labels for part in content.parts))}
    parts = [replace(part, labels=(f"Object_{number[part.labels]}",)) for part in content.parts]
    return replace(content, parts=parts)


DEFAULT_NAMES = (
    "Plane Plane.001 plane_12 Cube Cube.003 Object_4 Object.001 Mesh_0 mesh.002 Node1 Material.001 Group_5 "
    "defaultMaterial lambert2 polySurface12 pCylinder3 RootNode Cylinder.002 Sketchfab_model Icosphere 001 "
    "initialShadingGroup BezierCurve.004"
)


@pytest.mark.parametrize("name", ["", *DEFAULT_NAMES.split()])
def test_default_names_of_modelling_tools_say_nothing(name):
    assert named_kind(name) is None
    assert named_other(name) is None


def test_names_that_only_resemble_default_ones_still_count():
    assert [named_kind(n) for n in ("Tree_roots", "Leaf_Plane", "Mesh_Bark", "branch.001")] == [
        "wood", "leaves", "wood", "wood",
    ]  # fmt: skip
    assert [named_other(n) for n in ("GroundPlane", "Object_rock", "Terrain.001")] == [
        "ground",
        "rock",
        "ground",
    ]


def assert_names_change_little(file: LabelledFile) -> None:
    content = read_parts(file.data, file.filename, ImportRequest())
    changed = kinds_of(content) != kinds_of(with_neutral_names(content))
    assert changed.mean() <= MOST_CHANGED, file.style


@pytest.mark.long
@pytest.mark.parametrize("style", sorted(s for s, (_, kind, _) in STYLES.items() if kind == "glb"))
def test_names_change_hardly_a_face_of_a_tree_with_telling_colours(style):
    assert_names_change_little(labelled_file(style, SEED))


@pytest.mark.parametrize("seed", range(200, 212))
def test_names_change_hardly_a_face_of_a_file_of_a_pack(seed):
    assert_names_change_little(pack_file(seed, coloured=True))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(1200, 1260))
def test_names_change_hardly_a_face_of_held_back_files(seed):
    assert_names_change_little(pack_file(seed, coloured=True))


@pytest.mark.parametrize(
    "name", ["Plane.001", "Object.001", "Ground_texture", "terrain leaves", "rock_material"]
)
def test_leaves_are_never_left_out_for_their_name(name):
    rng = np.random.default_rng(SEED)
    wood, middle, size = broadleaf(rng, 8.0)
    leaf = cards(rng, in_ball(rng, middle, size, 200), 0.1 * size)
    tree = read_tree(write_obj([Part("a", "", together(*wood)), Part(name, "", leaf)]), "tree.obj")
    assert sum(len(p.faces) for p in tree.primitives if p.kind == "leaves") == len(leaf.faces)


def test_what_is_named_ground_and_lies_there_is_ground():
    rng = np.random.default_rng(SEED)
    wood, middle, size = broadleaf(rng, 8.0)
    leaf = cards(rng, in_ball(rng, middle, size, 100), 0.15 * size)
    patch = box((3.0, -0.05, 0.0), (3.8, 0.0, 0.8))  # too small to be recognised by its shape
    parts = [Part("a", "", together(*wood)), Part("b", "", leaf), Part("Terrain", "", patch)]
    pieces = read_tree(write_obj(parts), "tree.obj", ImportRequest(up_axis="y")).report["pieces"]
    assert [p["what"] for p in pieces if p["kind"] == "other"] == ["ground"]


def test_most_of_the_leaves_are_never_left_out_with_certainty():
    file = labelled_file("grass_tufts", SEED)
    content = read_parts(file.data, file.filename, ImportRequest())
    _, _, found = classify_content(content, ImportRequest())
    leafy = np.where(found.pieces.rgb[:, 1] > found.pieces.rgb[:, 0], -3.0, 3.0)
    for rows, unsure in ((np.flatnonzero(leafy < 0), True), (np.flatnonzero(leafy < 0)[-3:], False)):
        others = Others(np.zeros(len(found.pieces)))
        marked = np.zeros(len(found.pieces), dtype=bool)
        marked[rows] = True
        others.mark(marked, "rock", "a test")
        others.doubt_lost_leaves(found.pieces, leafy)
        assert len(rows) and (others.odds[rows] < 1.0).all() == unsure


def test_what_is_left_out_is_asked_about_and_answers_end_the_question():
    file = labelled_file("garden_scene", SEED)
    report = read_tree(file.data, file.filename).report
    assert report["needs_review"]
    assert any("rock" in question and "grass" in question for question in report["questions"])
    accepted = read_tree(file.data, file.filename, ImportRequest(accept=True)).report
    assert accepted["questions"] == report["questions"] and not accepted["needs_review"]
    chosen = [p["id"] for p in report["pieces"] if p["kind"] == "other"]
    answered = read_tree(file.data, file.filename, ImportRequest(drop=chosen)).report
    assert answered["questions"] == [] and not answered["needs_review"]
    plain = labelled_file("factor_colours", SEED)
    assert read_tree(plain.data, plain.filename).report["questions"] == []


def test_every_piece_has_a_probability():
    file = labelled_file("pot", SEED)
    pieces = read_tree(file.data, file.filename).report["pieces"]
    assert all(0.5 <= piece["probability"] <= 1.0 for piece in pieces)
    assert all(piece["probability"] > 0.7 for piece in pieces if piece["sure"])


def bodies(*shapes: Shape):
    whole = together(*shapes)
    return solid_wood(Surface(whole.vertices, whole.faces))


def test_bodies_that_float_are_foliage_and_those_on_the_ground_another_tree():
    rng = np.random.default_rng(SEED)
    stem, cloud = trunk(rng, 2.0, radius=0.2), ball(rng, (0, 6, 0), 1.0)
    beside = trunk(rng, 1.0, radius=0.1, at=(6, 0, 0))
    wood, found, _, warnings = bodies(stem, cloud, beside)
    assert np.ptp(wood.vertices[:, 1]) == pytest.approx(2.0, abs=0.1)
    assert found.floating[:, 1].min() > 4
    assert found.grounded[:, 0].min() > 5
    assert sum("float apart" in words for words in warnings) == 1
    assert sum("2 separate bodies" in words for words in warnings) == 1


@pytest.mark.parametrize("style", ["five_tiers_of_pyramids", "five_tiers_open_plain", "tiers_of_discs_plain"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_every_tier_of_a_stylised_conifer_is_drawn(style, seed):
    file = labelled_file(style, seed)
    tree = read_tree(file.data, file.filename)
    assert sum(len(p.faces) for p in tree.primitives) == len(file.labels)


def chained_by_force(low: np.ndarray, high: np.ndarray, gap: float) -> np.ndarray:
    """The same groups by comparing all pairs until nothing changes."""
    group = np.arange(len(low))
    for _ in range(len(low)):
        for i in range(len(low)):
            apart = np.maximum(np.maximum(low - high[i], low[i] - high), 0.0)
            near = np.linalg.norm(apart, axis=1) <= gap
            group[near] = group[near].min()
    return group


def test_boxes_are_chained_as_by_comparing_all_pairs():
    rng = np.random.default_rng(SEED)
    for _ in range(20):
        low = rng.uniform(0, 4, (30, 3))
        high = low + rng.uniform(0, 0.6, (30, 3))
        fast, slow = _chained(low, high, 0.3), chained_by_force(low, high, 0.3)
        assert ((fast[:, None] == fast) == (slow[:, None] == slow)).all()


NAMED_SPECIES = {
    "maple": "Acer_platanoides.glb acer-campestre",
    "sycamore": "acer_pseudoplatanus_lod0",
    "plane": "Platanus_x_hispanica PlaneTree01 London-Plane-Tree",
    "birch": "Betula_pendula_02",
    "oak": "Quercus_robur",
    "poplar": "populus_tremula",
    "ash": "Fraxinus_excelsior big_ash_tree",
    "apricot": "prunus_persica",
    None: "Plane.001 crash racer",
}


@pytest.mark.parametrize(
    "text, species", [(text, species) for species, texts in NAMED_SPECIES.items() for text in texts.split()]
)
def test_species_are_named_with_underscores_and_in_latin(text, species):
    assert guess_species(None, text, [])[0] == species


def test_small_plants_keep_a_plausible_height():
    for name, kind in (
        ("Bush_01.glb", "bush"), ("my bonsai.obj", "bonsai"), ("PottedPlant", "pot plant"),
        ("potted-plant.glb", "pot plant"), ("oak.glb", None), ("ambush", None),
    ):  # fmt: skip
        assert named_habit(name) == kind
    for raw, habit, height_m, unsure in (
        (1.3, "bush", 1.3, False),
        (130.0, "bush", 1.3, True),
        (0.45, "bonsai", 0.45, False),
        (8.0, "bonsai", 0.5, True),
        (0.8, "pot plant", 0.8, False),
        (9.0, "pot plant", 9.0, False),  # a tree in a tub
        (0.002, "bush", 1.5, True),
        (1.3, None, 10.0, False),
    ):
        scale, choice = choose_scale(raw, None, ImportRequest(), habit)
        assert (raw * scale, choice.unsure) == (pytest.approx(height_m), unsure)


def test_a_bush_without_a_name_keeps_its_height_and_is_asked_about():
    """All leaves and no trunk: 1.3 m high it is a bush, not a tree of 10 m in another unit."""
    for raw, height_m, unsure in (
        (1.3, 1.3, True),
        (2.5, 2.5, False),
        (12.0, 12.0, False),
        (0.02, 1.5, True),
    ):
        scale, choice = choose_scale(raw, None, ImportRequest(), "bush", named=False)
        assert (raw * scale, choice.unsure) == (pytest.approx(height_m), unsure)
    spread = np.random.default_rng(7).normal(size=(300, 3))
    centres = 0.55 * spread / np.linalg.norm(spread, axis=1, keepdims=True) + np.array([0, 0.65, 0])
    shape = cards(np.random.default_rng(7), centres, 0.12)
    tree = read_tree(write_obj([Part("thing", "leaves", shape, Look(factor=(0.1, 0.3, 0.05, 1.0)))]), "a.obj")
    assert tree.height_m == pytest.approx(1.3, abs=0.25)
    assert tree.report["needs_review"] and "size" in " ".join(tree.report["questions"])


def test_patches_of_bark_and_the_arms_of_a_cactus_are_wood():
    for style in ("birch_with_patches", "cactus_with_arms"):
        file = labelled_file(style, SEED)
        tree = read_tree(file.data, file.filename)
        wood = sum(len(p.faces) for p in tree.primitives if p.kind == "wood")
        assert wood == (file.labels == "wood").sum()


def test_noise_of_photographs_does_not_join_trunk_and_crown():
    file = labelled_file("photographed_colours", SEED)
    tree = read_tree(file.data, file.filename)
    leaves = sum(len(p.faces) for p in tree.primitives if p.kind == "leaves")
    assert leaves == pytest.approx((file.labels == "leaves").sum(), rel=0.01)


def test_branches_that_hang_low_are_no_fence():
    rng = np.random.default_rng(SEED)
    wood, middle, size = broadleaf(rng, 8.0)
    hanging = [
        tube(path, (0.05, 0.03), 6)
        for x, z in ((1.2, 0.3), (-1.0, 0.8), (0.4, -1.3), (-0.7, -1.1))
        for path in ([(0, 2.4, 0), (x, 2.4, z)], [(x, 2.4, z), (1.5 * x, 0.35, 1.5 * z)])
    ]
    leaf = cards(rng, in_ball(rng, middle, size, 150), 0.12 * size)
    parts = [Part("", "", together(*wood, *hanging)), Part("", OTHER, leaf)]
    pieces = read_tree(write_obj(parts), "tree.obj", ImportRequest(up_axis="y")).report["pieces"]
    assert not [p for p in pieces if p["kind"] == "other"]
