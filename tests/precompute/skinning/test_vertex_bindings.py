"""The axis turns as the wood does; bark, twigs, leaves and fronds are held where they grow."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from galewood.beams import Frame
from galewood.mesh.repair import Surface
from galewood.mesh.types import RenderPrimitive, TreeMesh
from galewood.model.axis import axis_of_frame, axis_of_tets
from galewood.model.holds import holds_of
from galewood.pipeline.drawn_figures import DrawnFigures
from galewood.reduction.nodes import Motion, make_nodes
from galewood.skeleton import extract_skeleton
from galewood.table import turned

from tests.precompute import tree_meshes as make
from tests.precompute.tet_meshes import Y_SEGMENTS, y_mesh

ARM_M = 0.1


def test_the_axis_of_tets_moves_and_turns_with_a_rigid_motion() -> None:
    mesh = y_mesh()
    axis = axis_of_tets(mesh, extract_skeleton(mesh))
    spin, shift = np.array([0.01, -0.02, 0.03]), np.array([0.1, 0.2, -0.3])
    moved = np.cross(spin, mesh.vertices_m) + shift
    np.testing.assert_allclose(
        axis.rotation(moved[:, :, None])[:, :, 0], np.tile(spin, (len(axis.parent), 1)), atol=1e-9
    )
    found = axis.displacement(moved[:, :, None])[:, :, 0]
    expected = np.cross(spin, axis.points_m) + shift
    assert np.abs(found - expected).max() < 0.03 * 0.05  # a point outside the wood moves with the nearest tet


def test_bark_is_held_beside_itself() -> None:
    mesh = y_mesh()
    axis = axis_of_tets(mesh, extract_skeleton(mesh))
    wood = make.joined(*(make.tube(a, b, r, r) for a, b, r in Y_SEGMENTS))
    feet = axis.feet(wood.vertices)
    thickest = max(radius for _, _, radius in Y_SEGMENTS)
    assert np.linalg.norm(wood.vertices - feet.at_m, axis=1).max() < 2.5 * thickest
    start = axis.points_m[axis.parent[feet.child]]
    along = start + feet.share[:, None] * (axis.points_m[feet.child] - start)
    np.testing.assert_allclose(along, feet.at_m, atol=1e-9)


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
    feet = holds_of(tree, axis)
    basis = bent(frame, 0.8)
    nodes = make_nodes(axis, feet, Motion(basis, np.ones((1, 1)), np.ones(1)), 0.0005 * tree.height_m)
    rest = np.concatenate([p.positions_m for p in tree.primitives])
    joint = nodes.vertex_joint.astype(int)
    first, second = nodes.joint_nodes.astype(int).T
    share = nodes.joint_share[:, None]
    moved = (1 - share) * nodes.basis[first, :, 0] + share * nodes.basis[second, :, 0]
    turn = (1 - share) * nodes.turn[first, :, 0] + share * nodes.turn[second, :, 0]
    now = nodes.joint_rest_m[joint] + moved[joint] + turned(rest - nodes.joint_rest_m[joint], turn[joint])
    return tree, rest, now


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
    figures = DrawnFigures(tree).between(rest, now)
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
