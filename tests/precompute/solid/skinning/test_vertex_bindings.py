"""Wood, twigs, leaves and fronds are bound where they grow, and bend or keep their shape."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from galewood.solid.beams import Frame
from galewood.solid.skinning import (
    Distortion,
    MotionSamples,
    axis_of_frame,
    drawn_positions,
    make_skin,
    vertex_bindings,
)
from galewood.solid.skinning import surface_bindings as surface_bindings
from galewood.tree import arms_of
from galewood.tree.repair import Surface
from galewood.tree.types import RenderPrimitive, TreeMesh

from tests.precompute.fixtures import tree_meshes as make

ARM_M = 0.1


FRONDS, LENGTH_M, TRUNK_M = 6, 3.0, 8.0


def palm() -> tuple[TreeMesh, Frame]:
    """A trunk with arching ribs; a blade of 3 m along every rib, in one piece; a nut (a card) on each rib."""
    rib = np.linspace(0, 1, 16)
    lines = [np.stack([0 * rib, TRUNK_M * rib, 0 * rib], axis=1)]
    for number in range(FRONDS):
        angle = 2 * np.pi * number / FRONDS
        out, up = LENGTH_M * rib * 0.9, TRUNK_M + LENGTH_M * (0.6 * rib - 0.7 * rib**2)
        lines.append(np.stack([out * np.cos(angle), up, out * np.sin(angle)], axis=1))
    points, links, radius = (
        [lines[0]],
        [np.column_stack([np.arange(15), np.arange(1, 16)])],
        [np.full(15, 0.12)],
    )
    for number, line in enumerate(lines[1:]):
        first = 16 + 15 * number
        points.append(line[1:])
        links.append(np.column_stack([[15, *range(first, first + 14)], np.arange(first, first + 15)]))
        radius.append(np.full(15, 0.02))
    frame = Frame(
        np.concatenate(points), np.concatenate(links), np.concatenate(radius), np.zeros(15 * 7, bool)
    )
    tubes = [make.tube(a, b, r, r) for line, r in zip(lines, [0.12, *[0.02] * FRONDS], strict=True)
             for a, b in pairwise(line)]  # fmt: skip
    blades = [blade(line, 2 * np.pi * number / FRONDS) for number, line in enumerate(lines[1:])]
    nuts = make.cards([line[12] + np.array([0, -0.1, 0]) for line in lines[1:]], size=0.2)
    return make.as_tree(make.joined(*tubes), make.joined(*blades, nuts)), frame


def blade(line: np.ndarray, angle: float) -> Surface:
    """A strip along a rib, 0.5 m wide, connected over its whole length."""
    side = 0.25 * np.array([-np.sin(angle), 0.0, np.cos(angle)])
    vertices = np.concatenate([line - side, line + side])
    n = len(line)
    k = np.arange(n - 1)
    faces = np.concatenate([np.column_stack([k, k + 1, k + n]), np.column_stack([k + 1, k + n + 1, k + n])])
    return Surface(vertices, faces)


def bent(frame: Frame, strength: float) -> np.ndarray:
    """(4p, 3, 1) displacement of the particles: trunk and fronds turn by angles that grow along them."""
    parent = np.full(len(frame.points_m), -1)
    parent[frame.links[:, 1]] = frame.links[:, 0]
    angle, place = np.zeros(len(parent)), frame.points_m.copy()
    for point in range(1, len(parent)):
        up = parent[point]
        angle[point] = angle[up] + strength * (0.03 if point < 16 else 0.05)
        arm = frame.points_m[point] - frame.points_m[up]
        place[point] = place[up] + rotated(arm, 0.5 * (angle[up] + angle[point]))
    arms = np.array([np.zeros(3), *(ARM_M * np.eye(3))])
    beside = np.array([[rotated(arm, turn) for arm in arms] for turn in angle])
    now = place[:, None] + beside
    rest = frame.points_m[:, None] + arms
    return (now - rest).reshape(-1, 3, 1)


def rotated(arm: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * arm[0] + s * arm[1], -s * arm[0] + c * arm[1], arm[2]])


@pytest.fixture(scope="module")
def drawn_palm():
    tree, frame = palm()
    axis = axis_of_frame(frame, ARM_M)
    samples = MotionSamples(bent(frame, 0.8), np.ones((1, 1)), np.ones(1))
    skin = make_skin(axis, vertex_bindings(tree, axis), samples, 0.0005 * tree.height_m)
    rest = np.concatenate([p.positions_m for p in tree.primitives])
    return tree, rest, drawn_positions(skin, rest, np.ones(1))


def angle_along(blade: np.ndarray) -> float:
    """Angle between the first and the last edge of a blade, rad."""
    root, tip = blade[1] - blade[0], blade[15] - blade[14]
    return float(np.arccos(np.dot(root, tip) / (np.linalg.norm(root) * np.linalg.norm(tip))))


def leaf_pieces(tree: TreeMesh) -> tuple[RenderPrimitive, slice]:
    first = sum(len(p.positions_m) for p in tree.primitives if p.kind == "wood")
    leaves = next(p for p in tree.primitives if p.kind == "leaves")
    return leaves, slice(first, first + len(leaves.positions_m))


def test_long_fronds_bend_along_their_ribs_without_tearing(drawn_palm) -> None:
    tree, rest, now = drawn_palm
    figures = Distortion(tree).between(rest, now)
    assert np.abs(now - rest).max() > 0.2 * tree.height_m
    assert figures["wood_stretch"] < 1.1 and figures["wood_stretch_worst"] < 1.3
    assert figures["leaves_stretch_worst"] < 1.2
    assert figures["leaves_gap"] < 0.002
    _, part = leaf_pieces(tree)
    blade_rest, blade_now = rest[part][:32], now[part][:32]
    # it is bent, not only turned
    assert angle_along(blade_now) > angle_along(blade_rest) + 0.2


def test_a_card_keeps_its_shape_and_turns_with_the_rib(drawn_palm) -> None:
    tree, rest, now = drawn_palm
    _, part = leaf_pieces(tree)
    card_rest, card_now = rest[part][-4:], now[part][-4:]
    for a in range(4):
        for b in range(a):
            kept = np.linalg.norm(card_now[a] - card_now[b])
            assert kept == pytest.approx(np.linalg.norm(card_rest[a] - card_rest[b]), rel=1e-5)
    turn = np.dot(card_now[1] - card_now[0], card_rest[1] - card_rest[0])
    assert turn < 0.95 * np.dot(card_rest[1] - card_rest[0], card_rest[1] - card_rest[0])


def test_each_piece_is_looked_at_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Thousands of large cards take a time in proportion to their number."""
    looked_at: list[int] = []

    def counting(vertices_m: np.ndarray, faces: np.ndarray, base_m: np.ndarray) -> np.ndarray:
        looked_at.append(len(vertices_m))
        return arms_of(vertices_m, faces, base_m)

    monkeypatch.setattr(surface_bindings, "arms_of", counting)
    tree, frame = palm()
    vertex_bindings(tree, axis_of_frame(frame, ARM_M))
    # blades that touch are one piece; they have 32 vertices each, and the cards are too small to have arms
    assert sum(looked_at) == 32 * FRONDS
