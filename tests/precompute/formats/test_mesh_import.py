"""All formats yield the same tree; axis, unit and wood are detected, reported and can be overridden."""

import numpy as np
import pytest
from galewood.options import ImportRequest
from galewood.tree.importer import read_tree, render_glb
from galewood.tree.repair import Surface, agree_windings, cap, face_outwards, open_edges, volume, weld

from tests.precompute.fixtures import tree_meshes as make

Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


def rotated(surface: Surface, rotation=Z_UP, scale=1.0) -> Surface:
    return Surface(surface.vertices @ rotation.T * scale, surface.faces)


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.glb", make.glb_bytes(make.y_tree())),
        ("a.gltf", make.gltf_bytes(make.gltf_document(make.y_tree()))),
        ("quantised.gltf", make.gltf_bytes(make.gltf_document(make.y_tree(), quantised=True))),
        ("a.obj", make.obj_bytes(make.y_tree())),
        ("a.ply", make.ply_bytes(make.y_tree())),
        ("a.stl", make.stl_bytes(make.y_tree())),
        ("misnamed.obj", make.glb_bytes(make.y_tree())),
        ("z_up.obj", make.obj_bytes(rotated(make.y_tree()))),
        ("z_up_centimetres.stl", make.stl_bytes(rotated(make.y_tree(), scale=100.0))),
        ("millimetres.obj", make.obj_bytes(rotated(make.y_tree(), np.eye(3), scale=1000.0))),
    ],
)
def test_every_format_axis_and_unit_gives_the_same_tree(name, data):
    expected = make.y_tree()
    tree = read_tree(data, name)
    top = np.ptp(expected.vertices[:, 1])
    assert tree.height_m == pytest.approx(top, rel=2e-4)
    assert np.ptp(tree.wood_vertices_m, axis=0) == pytest.approx(np.ptp(expected.vertices, axis=0), rel=1e-3)
    assert tree.wood_vertices_m[:, 1].min() == pytest.approx(0.0, abs=1e-6)
    solid = Surface(tree.wood_vertices_m, tree.wood_faces)
    assert volume(solid) == pytest.approx(volume(expected), rel=1e-3)
    assert not len(open_edges(solid.faces))


def test_assumptions_are_reported_and_can_be_overridden():
    data = make.obj_bytes(rotated(make.y_tree(), scale=3.0e-3))
    tree = read_tree(data, "aspen.obj")
    assert (tree.species, tree.height_m) == ("poplar", 12.0)
    assert tree.report["unit"]["assumed"] and tree.report["up_axis"] == tree.report["up_axis"] | {
        "value": "z"
    }
    assert len(tree.report["warnings"]) == 2
    told = read_tree(data, "aspen.obj", ImportRequest(species="maple", height_m=7.0, up_axis="z"))
    assert (told.species, told.height_m) == ("maple", pytest.approx(7.0))
    assert told.report["warnings"] == []


def test_obj_groups_distinguish_wood_from_leaves_and_options_override_them():
    wood, leaves = make.y_tree(), make.cards([(1.6, 4.6, 0), (0.5, 3.2, 0)])
    both = make.joined(wood, leaves)
    text = make.obj_bytes(both).decode().split("\n")
    at = [i for i, line in enumerate(text) if line.startswith("f ")]
    text.insert(at[len(wood.faces)], "g canopy")
    text.insert(at[0], "g stuff")
    data = "\n".join(text).encode()
    tree = read_tree(data, "a.obj")
    assert [(p.kind, len(p.faces)) for p in tree.primitives] == [("wood", len(wood.faces)), ("leaves", 4)]
    swapped = read_tree(data, "a.obj", ImportRequest(wood_parts=["stuff", "canopy"]))
    assert [p.kind for p in swapped.primitives] == ["wood", "wood"]


def test_unnamed_leaf_cards_are_recognised_by_shape():
    both = make.joined(make.y_tree(), make.cards([(1.6, 4.6, 0), (0.5, 3.2, 0)]))
    tree = read_tree(make.ply_bytes(both), "scan.ply")
    assert [(p.kind, len(p.faces)) for p in tree.primitives if p.kind == "leaves"] == [("leaves", 4)]
    reasons = " ".join(p["reason"] for p in tree.report["parts"])
    assert "flat cards" in reasons
    assert "standing on the ground" in reasons


def test_render_glb_keeps_vertex_order_and_can_be_read():
    tree = read_tree(make.glb_bytes(make.y_tree(), make.cards([(1.6, 4.6, 0)])), "a.glb")
    again = read_tree(render_glb(tree), "b.glb")
    assert [p.name for p in again.primitives] == ["wood_0", "leaves_0"]
    for one, two in zip(tree.primitives, again.primitives, strict=True):
        assert np.allclose(one.positions_m, two.positions_m, atol=1e-6)
        assert (one.faces == two.faces).all()


def test_repair_welds_reorients_and_closes():
    expected = volume(make.y_tree())
    opened = make.y_tree(closed=False)
    split = Surface(
        opened.vertices[opened.faces].reshape(-1, 3), np.arange(3 * len(opened.faces)).reshape(-1, 3)
    )
    seed = 7
    turn = np.random.default_rng(seed).random(len(split.faces)) < 0.4
    split.faces[turn] = split.faces[turn][:, ::-1]
    faces, count = agree_windings(weld(split).faces)
    assert count > 0, f"seed {seed}"
    closed, loops = cap(Surface(weld(split).vertices, faces))
    outward, _ = face_outwards(closed)
    assert loops == 6
    assert not len(open_edges(outward.faces))
    assert volume(outward) == pytest.approx(expected, rel=1e-9)


def test_inside_out_wood_is_reversed_and_reported():
    flipped = Surface(make.y_tree().vertices, make.y_tree().faces[:, ::-1])
    tree = read_tree(make.obj_bytes(flipped), "a.obj")
    assert tree.report["repairs"]["pieces_turned_inside_out"] == 3
    assert volume(Surface(tree.wood_vertices_m, tree.wood_faces)) > 0


def test_larger_of_two_trees_is_kept_with_a_warning():
    small = Surface(make.y_tree().vertices * 0.7 + (6.0, 0, 0), make.y_tree().faces)
    tree = read_tree(make.obj_bytes(make.joined(small, make.y_tree())), "two.obj", ImportRequest(up_axis="y"))
    assert np.ptp(tree.wood_vertices_m[:, 0]) < 4.0
    assert sum(len(p.faces) for p in tree.primitives) == len(make.y_tree().faces)
    assert any("2 trees; tree 1 is imported" in w for w in tree.report["warnings"])
