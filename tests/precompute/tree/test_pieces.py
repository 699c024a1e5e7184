"""Colours of faces, pieces, choices by id and name, other objects and several trees."""

import io
import json

import numpy as np
import pytest
import trimesh
from galewood.formats.types import Material, RawPart
from galewood.options import ImportRequest
from galewood.tree.importer import read_tree
from galewood.tree.piece_mesh import pieces_glb
from galewood.tree.pieces.detection.colour import face_colours, hue_saturation_value
from galewood.tree.pieces.detection.pieces import find_pieces
from galewood.tree.pieces.detection.shape import measure
from galewood.tree.pieces.names import named_kind, named_other
from galewood.tree.pieces.painted import ranges_of
from galewood.tree.scan_ground import ground_faces
from galewood.util import MeshError
from PIL import Image

from tests.precompute.fixtures.labelled import shapes as shapes
from tests.precompute.fixtures.labelled.trees import labelled_file

SEED = 41


def square_at(u: float, v: float, size=0.05) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    corner = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    return corner, np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32), corner[:, :2] * size + (u, v)


def textured(uv_place, pixels, **material) -> RawPart:
    out = io.BytesIO()
    Image.fromarray(np.asarray(pixels, dtype=np.uint8)).save(out, "PNG")
    positions, faces, uv = square_at(*uv_place)
    pbr = {"baseColorTexture": {"index": "image 0"}, **material.pop("pbr", {})}
    json = {"pbrMetallicRoughness": pbr, **material}
    images = {"image 0": (out.getvalue(), "image/png")}
    return RawPart((), positions, faces, uv=uv, material=Material(json, images, {"image 0": {}}))


def halves(left, right) -> np.ndarray:
    return np.concatenate([np.tile(left, (8, 8, 1)), np.tile(right, (8, 8, 1))], axis=1)


def test_the_colour_is_that_under_the_face_not_the_mean_of_the_atlas():
    atlas = halves((90, 60, 40, 255), (60, 140, 40, 255))
    left, right = face_colours(textured((0.1, 0.3), atlas)), face_colours(textured((0.7, 0.3), atlas))
    assert left.rgb * 255 == pytest.approx(np.tile((90, 60, 40), (2, 1)), abs=0.6)
    assert right.rgb * 255 == pytest.approx(np.tile((60, 140, 40), (2, 1)), abs=0.6)


@pytest.mark.parametrize("mode", ["OPAQUE", "MASK", "BLEND"])
def test_alpha_is_that_under_the_face_in_every_mode(mode):
    atlas = halves((90, 60, 40, 255), (60, 140, 40, 0))
    assert face_colours(textured((0.1, 0.3), atlas, alphaMode=mode)).cut_out.tolist() == [0, 0]
    assert face_colours(textured((0.7, 0.3), atlas, alphaMode=mode)).cut_out.tolist() == [1, 1]


def test_factors_multiply_in_linear_light_and_textures_are_transformed():
    atlas = halves((255, 255, 255, 255), (0, 0, 0, 255))
    half = textured((0.1, 0.3), atlas, pbr={"baseColorFactor": [0.5, 0.5, 0.5, 1]})
    assert face_colours(half).rgb * 255 == pytest.approx(188, abs=1)  # sRGB of half the light: IEC 61966-2-1
    moved = {
        "baseColorTexture": {
            "index": "image 0",
            "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}},
        }
    }
    assert face_colours(textured((0.1, 0.3), atlas, pbr=moved)).rgb.max() == pytest.approx(0, abs=1e-6)


def test_white_is_no_colour_and_hues_are_those_of_the_colour_circle():
    positions, faces, _ = square_at(0, 0)
    assert not face_colours(RawPart((), positions, faces, colours=np.ones((4, 3)))).known
    hue, saturation, value = hue_saturation_value(np.array([(1.0, 0, 0), (0, 0.5, 0), (0, 0, 1), (1, 1, 0)]))
    assert hue.tolist() == [0, 120, 240, 60]
    assert saturation.tolist() == [1, 1, 1, 1]
    assert value.tolist() == [1, 0.5, 1, 1]


def test_measures_of_simple_shapes_are_exact():
    rng = np.random.default_rng(SEED)
    pipe = shapes.tube([(0, 0, 0), (0, 10, 0)], 0.5, 96, closed=False)
    sphere = shapes.ball(rng, (0, 0, 0), 1.0, 0.0, 5)
    card = shapes.cards(rng, [(0, 0, 0)], 1.0)
    corners = np.concatenate([s.vertices[s.faces] for s in (pipe, sphere, card)])
    piece = np.repeat([0, 1, 2], [len(s.faces) for s in (pipe, sphere, card)]).astype(np.int32)
    found = measure(corners, piece, 3, np.zeros(len(piece)))
    # an open cylinder has the volume of its cone wedges: two thirds of a closed one, from its centre
    assert found.thickness[0] == pytest.approx(4 * (np.pi * 0.25 * 10 * 2 / 3) / (np.pi * 10), rel=2e-3)
    assert found.thickness[1] == pytest.approx(4 / 3, rel=5e-3)
    assert found.thickness[2] == pytest.approx(0, abs=1e-12)
    assert found.coherence == pytest.approx([0, 0, 1], abs=1e-9)
    assert found.normals[0] == pytest.approx([0.5, 0.5, 0], abs=1e-3)
    assert found.normals[1] == pytest.approx([1 / 3] * 3, abs=1e-3)
    assert found.normals[2] == pytest.approx([1, 0, 0], abs=1e-9)
    assert found.extents[0] == pytest.approx([10, 1, 1], rel=2e-2)


def test_a_connected_surface_of_two_colours_is_two_pieces_and_spots_divide_nothing():
    file = labelled_file("vertex_colours_welded", SEED)
    tree = read_tree(file.data, file.filename)
    for kind in ("wood", "leaves"):
        assert (
            sum(p["faces"] for p in tree.report["parts"] if p["kind"] == kind) == (file.labels == kind).sum()
        )
    ball = shapes.ball(np.random.default_rng(SEED), (0, 0, 0), 1.0, 0.0, 4)
    spots = np.where(
        np.random.default_rng(SEED).random((len(ball.vertices), 1)) < 0.5, (0.2, 0.5, 0.1), (0.4, 0.2, 0.1)
    )
    assert len(find_pieces([RawPart((), ball.vertices, ball.faces, colours=spots)])) == 1


def test_choices_by_id_change_only_their_piece_and_ids_stay():
    file = labelled_file("pot", SEED)
    plain = read_tree(file.data, file.filename).report
    pot = next(p for p in plain["pieces"] if p.get("what") == "pot")
    crown = next(p for p in plain["pieces"] if p["kind"] == "leaves")
    chosen = ImportRequest(wood_parts=[pot["id"]], drop=[crown["id"]])
    report = read_tree(file.data, file.filename, chosen).report
    kinds = {p["id"]: (p["kind"], p["chosen"]) for p in report["pieces"]}
    assert kinds.pop(pot["id"]) == ("wood", True)
    assert kinds.pop(crown["id"]) == ("other", True)
    assert kinds == {p["id"]: (p["kind"], False) for p in plain["pieces"] if p["id"] in kinds}
    assert any("pot" in w for w in plain["warnings"])
    assert not any("pot" in w for w in report["warnings"])


def test_vertex_pieces_cover_the_drawn_vertices():
    file = labelled_file("two_trees", SEED)
    tree = read_tree(file.data, file.filename)
    for runs, primitive in zip(tree.report["vertex_pieces"], tree.primitives, strict=True):
        assert sum(runs[1::2]) == len(primitive.positions_m)
        kinds = {tree.report["pieces"][entry]["kind"] for entry in runs[::2] if entry >= 0}
        assert kinds == {primitive.kind}


def test_another_tree_of_the_file_can_be_chosen():
    file = labelled_file("two_trees", SEED)
    first, second = (read_tree(file.data, file.filename, ImportRequest(tree=n)) for n in (1, 2))
    assert [t["taken"] for t in second.report["trees"]] == [False, True]
    assert first.height_m > second.height_m
    assert second.height_m == pytest.approx(second.report["trees"][1]["height_m"], rel=1e-2)
    with pytest.raises(MeshError, match="no tree 3"):
        read_tree(file.data, file.filename, ImportRequest(tree=3))


def test_an_unknown_piece_is_refused_with_those_that_exist():
    file = labelled_file("pot", SEED)
    for options in (
        ImportRequest(drop=["9.9"]),
        ImportRequest(leaves=["moss"]),
        ImportRequest(wood_parts=["7.0"]),
    ):
        with pytest.raises(MeshError) as caught:
            read_tree(file.data, file.filename, options)
        assert caught.value.code == "no-such-piece"
        assert "0.0" in caught.value.hint


def test_a_bush_of_foliage_only_is_refused_with_a_hint():
    crown = shapes.ball(np.random.default_rng(SEED), (0, 1, 0), 1.0, 0.1, 3)
    text = ["o bush"] + ["v " + " ".join(map(str, v)) for v in crown.vertices]
    data = "\n".join(text + ["f " + " ".join(str(i + 1) for i in f) for f in crown.faces]).encode()
    with pytest.raises(MeshError, match="No wood was found") as caught:
        read_tree(data, "bush.obj", ImportRequest(complete=False))
    assert "--complete" in caught.value.hint


def test_wood_that_ends_low_in_the_crown_is_reported():
    file = labelled_file("conifer_tiers", SEED)
    warnings = read_tree(file.data, file.filename, ImportRequest(complete=False)).report["warnings"]
    assert any("The wood ends at" in w for w in warnings)


@pytest.mark.parametrize("name", ["Rinde", "Кора", "树皮", "écorce", "TreeBark_2", "corteccia", "tronco"])
def test_wood_is_named_in_many_languages(name):
    assert named_kind(name) == "wood"


@pytest.mark.parametrize("name", ["Blätter", "Листва", "树叶", "feuillage", "MapleLeaves", "hojas", "foglie"])
def test_leaves_are_named_in_many_languages(name):
    assert named_kind(name) == "leaves"


def test_other_objects_are_named_unless_a_part_of_a_tree_is_mentioned():
    assert [named_other(n) for n in ("Ground_01", "FlowerPot", "rock", "wooden_fence", "Cube")] == [
        "ground", None, "rock", None, None,
    ]  # fmt: skip


def test_the_ground_of_a_scan_is_found_and_a_bare_tree_has_none():
    rng = np.random.default_rng(SEED)
    ground = shapes.terrain(rng, 5, 0.05, 40)
    stem = shapes.tube(np.column_stack([np.zeros(60), np.linspace(0, 8, 60), np.zeros(60)]), 0.2, 24)
    both = shapes.together(ground, stem)
    found = ground_faces(both.vertices[both.faces])
    assert found is not None
    assert found[: len(ground.faces)].mean() > 0.98
    assert found[len(ground.faces) :].mean() < 0.02  # what is buried in the ground
    assert ground_faces(stem.vertices[stem.faces]) is None


def test_single_pieces_are_chosen_by_ranges_and_the_rest_keeps_its_id():
    file = labelled_file("pot", SEED)
    plain = read_tree(file.data, file.filename).report
    crowd = max((p for p in plain["pieces"] if p["kind"] == "wood"), key=lambda p: p["pieces"])
    part, first = crowd["id"].split(".")
    name = f"{part}.{int(first) + 1}-{int(first) + 1}"
    report = read_tree(file.data, file.filename, ImportRequest(drop=[name])).report
    painted = next(p for p in report["pieces"] if p.get("ranges"))
    rest = next(p for p in report["pieces"] if p["id"] == crowd["id"])
    assert (painted["kind"], painted["pieces"], painted["ranges"], painted["chosen"]) == (
        "other",
        1,
        [name],
        True,
    )
    assert (rest["kind"], rest["pieces"]) == ("wood", crowd["pieces"] - 1)
    assert rest["faces"] + painted["faces"] == crowd["faces"]
    # one piece of its group keeps what the whole group was made
    both = read_tree(file.data, file.filename, ImportRequest(leaves=[crowd["id"]], drop=[name])).report
    assert {p["id"]: p["kind"] for p in both["pieces"]}[crowd["id"]] == "leaves"
    with pytest.raises(MeshError) as caught:
        read_tree(file.data, file.filename, ImportRequest(drop=[f"{part}.900-901"]))
    assert caught.value.code == "no-such-piece"


def test_ranges_of_numbers():
    assert ranges_of(3, np.array([1, 2, 3, 7, 9, 10])) == ["3.1-3", "3.7-7", "3.9-10"]


def test_the_glb_of_all_pieces_names_the_piece_of_every_vertex():
    file = labelled_file("pot", SEED)
    report = read_tree(file.data, file.filename).report
    glb = pieces_glb(file.data, file.filename)
    scene = trimesh.load_scene(io.BytesIO(glb), file_type="glb")
    meshes = [mesh for mesh in scene.geometry.values() if isinstance(mesh, trimesh.Trimesh)]
    rows = [np.asarray(mesh.vertex_attributes["_PIECE"]).reshape(-1) for mesh in meshes]
    faces = sum(len(mesh.faces) for mesh in meshes)
    assert faces == sum(p["faces"] for p in report["pieces"])  # also the pot, which is left out
    listed = json.loads(glb[20 : 20 + int.from_bytes(glb[12:16], "little")])["extras"]["pieces"]
    assert set(np.concatenate(rows).astype(int)) == set(range(len(listed["kind"])))
    assert listed["kind"].count("other") == sum(p["pieces"] for p in report["pieces"] if p["kind"] == "other")
    for mesh, own in zip(meshes, rows, strict=True):
        assert (own[mesh.faces] == own[mesh.faces][:, :1]).all()


def test_trees_are_named_by_what_only_they_are_called():
    file = labelled_file("two_trees", SEED)
    trees = read_tree(file.data, file.filename).report["trees"]
    assert len(trees) == 2 and all(isinstance(tree["name"], str) for tree in trees)
    assert len({tree["name"] for tree in trees if tree["name"]}) == sum(bool(t["name"]) for t in trees)
