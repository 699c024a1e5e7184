"""The up axis of trees in every orientation: found, or asked for, but never wrong without a word."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.formats.reading import read_parts
from galewood.formats.types import RawPart
from galewood.options import ImportRequest
from galewood.tree.axis import AXES, choose_up_axis, to_y_up
from galewood.tree.importer import read_tree
from galewood.tree.joined_parts import joined_parts
from galewood.tree.pieces.detection.pieces import find_pieces
from galewood.tree.upright import ground, section_thickness

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.labelled.shapes import terrain, together, tube
from tests.precompute.fixtures.labelled.trees import labelled_file

SEED = 71
FORMATS = ("obj", "ply", "stl", "glb")


def parts_y_up(style: str) -> list[RawPart]:
    file = labelled_file(style, SEED)
    back = to_y_up(file.up)
    read = read_parts(file.data, file.filename, ImportRequest()).parts
    return [replace(p, positions=p.positions @ back.T, normals=None) for p in read]


def as_written(parts: list[RawPart], file_format: str) -> list[RawPart]:
    """What is left of the parts in a file of another format: an OBJ without its MTL, a PLY or STL of all."""
    if file_format == "glb":
        return parts
    if file_format == "obj":
        return [RawPart(p.labels, p.positions, p.faces) for p in parts]
    start = np.cumsum([0] + [len(p.positions) for p in parts])
    faces = np.concatenate([p.faces + int(o) for p, o in zip(parts, start, strict=False)])
    return [RawPart((), np.concatenate([p.positions for p in parts]), faces)]


@pytest.mark.parametrize("style", ["bonsai_in_pot", "dead_tree", "columnar_crown_plain", "rocks"])
def test_no_orientation_is_wrong_without_a_word(style):
    parts = parts_y_up(style)
    asked = 0
    for file_format in FORMATS:
        written = as_written(parts, file_format)
        for axis in AXES:
            turn = to_y_up(axis).T  # +Y to the axis
            turned = joined_parts([replace(p, positions=p.positions @ turn.T) for p in written])
            vertices = np.concatenate([p.positions for p in turned])
            start = np.cumsum([0] + [len(p.positions) for p in turned])
            faces = np.concatenate([p.faces + int(o) for p, o in zip(turned, start, strict=False)])
            up = choose_up_axis(vertices, faces, find_pieces(turned), file_format, ImportRequest())
            assert up.unsure or up.value == axis, (style, file_format, axis, up)
            asked += up.unsure
    assert asked < len(FORMATS) * len(AXES)


def test_every_axis_is_turned_to_y_without_mirroring():
    for axis in AXES:
        unit = np.zeros(3)
        unit["xyz".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0
        assert (to_y_up(axis) @ unit).tolist() == [0, 1, 0]
        assert np.linalg.det(to_y_up(axis)) == pytest.approx(1)


def test_a_careless_glb_is_turned_or_asked_for():
    """A Z-up tree in a GLB, which should be Y-up."""
    mesh = make.y_tree()
    lying = replace(mesh, vertices=mesh.vertices @ to_y_up("z"))
    upright = read_tree(make.glb_bytes(mesh), "tree.glb").report["up_axis"]
    report = read_tree(make.glb_bytes(lying), "tree.glb").report
    assert (upright["value"], upright["assumed"]) == ("y", False)
    assert report["up_axis"]["unsure"] or report["up_axis"]["value"] == "z"
    told = [*report["warnings"], *report["questions"]]
    assert any("The up axis is assumed" in words or "Unsure about the up axis" in words for words in told)


def test_a_tree_on_its_head_can_be_turned():
    mesh = make.y_tree()
    turned = replace(mesh, vertices=mesh.vertices * (1.0, -1.0, -1.0))
    tree = read_tree(make.obj_bytes(turned), "tree.obj", ImportRequest(up_axis="-y"))
    plain = read_tree(make.obj_bytes(mesh), "tree.obj", ImportRequest(up_axis="y"))
    assert tree.wood_vertices_m == pytest.approx(plain.wood_vertices_m, abs=1e-9)


def test_the_section_of_a_tube_has_its_diameter():
    pipe = tube([(0, 0, 0), (0, 5, 0), (0, 10, 0)], [0.5, 0.4, 0.3], 96)
    corners = pipe.vertices[pipe.faces]
    piece = np.zeros(len(corners), dtype=np.int32)
    assert section_thickness(corners, piece, 2.5) == pytest.approx(0.9, rel=2e-3)
    assert section_thickness(corners[:, ::-1], piece, 7.5) == pytest.approx(0.7, rel=2e-3)
    assert section_thickness(corners, piece, 11.0) == 0.0


def test_rough_ground_shows_the_way_up():
    """Grass and noise of a scanner make most faces of its ground steep; all together they still face up."""
    rng = np.random.default_rng(SEED)
    rough = terrain(rng, 8.0, 0.25, cells=90)
    stem = tube(np.column_stack([np.zeros(12), np.linspace(0, 9, 12), np.zeros(12)]), np.full(12, 0.2), 9)
    both = together(rough, stem)
    corners = both.vertices[both.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[: len(rough.faces)]
    assert np.median(np.abs(normal[:, 1]) / np.linalg.norm(normal, axis=1)) < 0.6
    seen = {axis: ground(corners @ to_y_up(axis).T) for axis in AXES}
    assert seen == {axis: float(axis == "y") for axis in AXES}
    assert not any(ground(stem.vertices[stem.faces] @ to_y_up(axis).T) for axis in AXES)
