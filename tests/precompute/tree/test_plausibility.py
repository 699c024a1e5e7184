"""Faults that files of strangers showed, as small generated files."""

from typing import Any

import numpy as np
import pytest
from galewood.formats import RawPart
from galewood.options import ImportRequest
from galewood.tree.axis import CONVENTION_REASON, CONVENTIONS, decided
from galewood.tree.importer import read_tree
from galewood.tree.pieces.classified_part import ClassifiedPart, without_strays
from galewood.tree.pieces.detection.division import _apart
from galewood.tree.surface import Bodies

from tests.precompute.fixtures.labelled.looks import LEAVES, OTHER, WOOD, Look, linear
from tests.precompute.fixtures.labelled.shapes import together
from tests.precompute.fixtures.packs.geometry import blob, branching, lathe, limb, quads
from tests.precompute.fixtures.packs.writers import Piece, write_nested_glb

SEED = 83
BROWN, GREEN = Look(factor=linear((101, 67, 33))), Look(factor=linear((78, 140, 50)))
TRUNK = [(0.05, 0.0), (0.04, 0.3), (0.03, 0.6)]


def faces_of(pieces: list[Piece]) -> tuple[dict[str, int], dict[str, Any]]:
    """How many faces of each kind are drawn, and the report."""
    tree = read_tree(write_nested_glb(pieces, (), False, ""), "model.glb", ImportRequest(height_m=8.0))
    counts: dict[str, int] = {}
    for primitive in tree.primitives:
        counts[primitive.kind] = counts.get(primitive.kind, 0) + len(primitive.faces)
    return counts, tree.report


@pytest.mark.parametrize("name", ["Leaves", "grassland_tree_01", "evergreen_mat", "Bark"])
def test_a_name_that_the_whole_tree_has_does_not_decide(name):
    rng = np.random.default_rng(SEED)
    stem, crown = lathe([(0, 0), *TRUNK, (0, 0.62)], 8), blob(rng, (0, 0.75, 0), 0.25)
    pieces = [Piece(name, name, WOOD, stem, BROWN), Piece(name, name, LEAVES, crown, GREEN)]
    assert faces_of(pieces)[0] == {"wood": len(stem.faces), "leaves": len(crown.faces)}


def test_a_crown_is_not_cut_by_a_body_that_stands_beside_it():
    rng = np.random.default_rng(SEED)
    crown = blob(rng, (0, 1, 0), (1.0, 0.8, 1.0), 8, 12)
    data = write_nested_glb([Piece("", "", LEAVES, crown, GREEN)], (), False, "")
    part = read_tree(data, "crown.glb", ImportRequest(height_m=2.0)).primitives[0]
    whole = ClassifiedPart(
        part_of(part.positions_m, part.faces), "leaves", "", np.zeros(len(part.positions_m), np.int32)
    )
    low = float(part.positions_m[:, 1].min())
    bodies = Bodies(np.zeros((0, 3)), np.array([[0.8, low, 0.0]]))
    kept = without_strays([whole], np.array([[0.0, low, 0.0], [0.0, low + 0.5, 0.0]]), bodies)
    assert sum(len(one.part.faces) for one in kept) == len(part.faces)


def part_of(positions: np.ndarray, faces: np.ndarray) -> RawPart:
    return RawPart(labels=(), positions=positions, faces=faces)


def test_regions_of_one_colour_that_do_not_touch_are_divided():
    label = np.array([1] * 10 + [0] * 10 + [1] * 9 + [0])  # crown, trunk, ground, and a speck
    pairs = np.column_stack([np.arange(29), np.arange(1, 30)])
    area = np.array([1.0] * 29 + [0.01])
    found = _apart(label.astype(np.int32), pairs, area)
    assert len(set(found)) == 3
    assert found[0] != found[10] != found[20] != found[0]
    assert found[29] == found[10]  # too small for a piece of its own


def test_a_trunk_with_many_branches_is_no_strip():
    rng = np.random.default_rng(SEED)
    path = [(0, y, 0) for y in np.linspace(0, 1, 8)]
    stem = limb(path, np.linspace(0.02, 0.006, 8), 8)
    twigs = [
        limb([(0, y, 0), (0.12 * np.cos(a), y + 0.02, 0.03 * np.sin(a))], [0.004, 0.001], 4)
        for y, a in zip(np.linspace(0.3, 0.95, 30), rng.uniform(0, 6.28, 30), strict=True)
    ]
    whole = together(stem, *twigs)
    counts, report = faces_of([Piece("", "", WOOD, whole, Look())])
    assert counts == {"wood": len(whole.faces)}
    assert not [one for one in report["pieces"] if one["kind"] == "other"]


def test_low_branches_of_the_bark_are_no_fence_and_no_rocks():
    rng = np.random.default_rng(SEED)
    limbs, tips = [lathe([(0, 0), *TRUNK, (0, 0.62)], 8)], []
    for k in range(8):
        a = 0.8 * k
        more, ends = branching(rng, (0, 0.06 + 0.02 * k, 0), (np.cos(a), 0.05, np.sin(a)), 0.25, 0.012, 2, 5)
        limbs += more
        tips += ends
    wood = together(*limbs)
    pieces = [
        Piece("Tree", "bark04", WOOD, wood, BROWN),
        Piece("Tree", "m2", LEAVES, quads(rng, tips, 0.1), GREEN),
    ]
    counts, _ = faces_of(pieces)
    assert counts["wood"] == len(wood.faces)


def test_a_file_without_wood_asks():
    rng = np.random.default_rng(SEED)
    counts, report = faces_of([Piece("", "", LEAVES, blob(rng, (0, 0.3, 0), (0.5, 0.3, 0.5)), GREEN)])
    assert "wood" not in counts
    assert any("No wood was found" in question for question in report["questions"])


def test_a_gltf_that_seems_upside_down_asks():
    weights = {
        CONVENTION_REASON: {a: CONVENTIONS["glb"].get(a, 0.0) for a in ("y", "z", "x", "-y", "-z", "-x")}
    }
    weights["shape"] = dict.fromkeys(weights[CONVENTION_REASON], 0.0) | {"-y": 12.0}
    choice = decided(weights, "glb")  # pyright: ignore[reportArgumentType]
    assert choice.value == "-y" and choice.unsure


def test_turf_below_the_tree_is_left_out():
    rng = np.random.default_rng(SEED)
    stem, crown = lathe([(0, 0), *TRUNK, (0, 0.62)], 8), blob(rng, (0, 0.75, 0), 0.25)
    turf = lathe([(0, 0.004), (0.2, 0.003), (0.4, 0.0)], 12)
    pieces = [
        Piece("a", "a", WOOD, stem, BROWN),
        Piece("b", "b", LEAVES, crown, GREEN),
        Piece("c", "c", OTHER, turf, GREEN),
    ]
    counts, report = faces_of(pieces)
    assert counts == {"wood": len(stem.faces), "leaves": len(crown.faces)}
    assert [one["what"] for one in report["pieces"] if one["kind"] == "other"] == ["ground"]
