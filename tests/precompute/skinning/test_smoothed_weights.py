"""A bend is shared by all edges around it; rotations carry no stretch; pieces stay beside long edges."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from galewood.mesh.types import RenderPrimitive
from galewood.model import Axis, Feet, welded_wood
from galewood.model.bark import bark_feet
from galewood.model.eased import AxisPaths, axis_paths
from galewood.pipeline.borne_pieces import with_borne_pieces
from galewood.pipeline.drawn_figures import DrawnFigures
from galewood.reduction import calm_bark
from galewood.reduction.spread_bends import AxisPoses, Skin, Slide, drawn_at
from galewood.table import Table, decode, turned, unstretched
from galewood.util import Floats
from scipy.sparse import csr_matrix

from tests.precompute import tree_meshes as make

SEED = 11
POLE = Path(__file__).parents[1] / "golden" / "pole-table.safetensors"


def test_links_on_the_way_to_a_point_are_those_of_a_walk() -> None:
    rng = np.random.default_rng(SEED)
    parent = np.array([-1, *(int(rng.integers(0, k)) for k in range(1, 50))])
    paths = AxisPaths(rng.random((50, 3)), parent)
    end = rng.integers(1, 50, 300)
    mark = rng.random(300) * paths.mark_m[end]
    for point, at, found in zip(end.tolist(), mark.tolist(), paths.on_way(end, mark).tolist(), strict=True):
        while paths.mark_m[parent[point]] > at and parent[parent[point]] >= 0:
            point = int(parent[point])
        assert found == point, f"seed {SEED}"


def test_the_end_of_the_line_through_a_point_is_the_farthest_beyond_it() -> None:
    rng = np.random.default_rng(SEED)
    parent = np.array([-1, *(int(rng.integers(0, k)) for k in range(1, 50))])
    paths = AxisPaths(rng.random((50, 3)), parent)
    for point in range(50):
        beyond = [p for p in range(50) if point in _way(parent, p)]
        assert paths.mark_m[paths.line_ends[point]] == max(paths.mark_m[beyond]), f"seed {SEED}"


def _way(parent: np.ndarray, point: int) -> list[int]:
    way = [point]
    while parent[way[-1]] >= 0:
        way.append(int(parent[way[-1]]))
    return way


def flared() -> tuple[Axis, RenderPrimitive, AxisPoses]:
    """A stem of 6 m whose foot is 0.9 m thick, bent by 0.6 rad in one pose, mostly in its lower half."""
    height = np.linspace(0, 6, 49)
    points = np.stack([0 * height, height, 0 * height], axis=1)
    none = csr_matrix((0, 0))
    axis = Axis(points, np.arange(-1, 48), np.full(49, 0.3), none, none)
    angle = 0.6 * (1 - np.exp(-height / 2))
    step = np.diff(height, prepend=0.0)
    now = np.cumsum(np.stack([np.sin(angle) * step, np.cos(angle) * step, 0 * step], axis=1), axis=0)
    turn = np.stack([0 * angle, 0 * angle, -np.sin(angle)], axis=1)
    tube = make.tube((0, 0, 0), (0, 6, 0), 0.9, 0.2, sides=8, rings=13)
    wood = RenderPrimitive("wood_0", "wood", tube.vertices, tube.faces)
    return axis, wood, AxisPoses((now - points)[:, :, None], turn[:, :, None])


def longest(skin: Skin, feet: Feet, axis: Axis, poses: AxisPoses) -> float:
    now = drawn_at(skin.place_m, *axis_paths(axis).places(feet), axis_paths(axis), poses)
    apart = np.linalg.norm(now[skin.ends[:, 0]] - now[skin.ends[:, 1]], axis=2)
    return float((apart / skin.length_m[:, None]).max())


def skin_of(wood: RenderPrimitive) -> Skin:
    welded = welded_wood(wood)
    return Skin(welded.place_m, welded.ends, np.sqrt(welded.squared))


def test_a_thick_foot_shares_its_bend_better_than_vertices_one_by_one(monkeypatch) -> None:
    monkeypatch.setattr(calm_bark, "TRIES", 1)
    axis, wood, poses = flared()
    welded, skin = welded_wood(wood), skin_of(wood)
    feet = bark_feet(wood, axis)
    first = welded.first
    feet = Feet(feet.child[first], feet.share[first], feet.at_m[first], feet.distance_m[first])
    together = longest(skin, calm_bark.calmed(welded, feet, axis, poses), axis, poses)
    monkeypatch.setattr(calm_bark, "PASSES", 0)
    alone = longest(skin, calm_bark.calmed(welded, feet, axis, poses), axis, poses)
    assert longest(skin, feet, axis, poses) > 1.1
    assert together < 1 + 0.9 * (alone - 1)
    assert together < 1.1


def test_the_slope_of_the_cost_is_that_of_differences() -> None:
    axis, wood, poses = flared()
    skin, paths = skin_of(wood), axis_paths(axis)
    child, mark = paths.places(axis.feet(skin.place_m))
    mark = np.clip(mark, 0.06, 5.9) + 1e-3 * np.random.default_rng(SEED).random(len(mark))
    slide = Slide(skin, child, mark, np.arange(5, len(mark)), paths, poses)
    at = mark[5:] / slide.unit_m
    _, slope = slide.cost(at)
    for k in (0, 17, 40):
        step = np.zeros(len(at))
        step[k] = 1e-5
        difference = (slide.cost(at + step)[0] - slide.cost(at - step)[0]) / 2e-5
        assert slope[k] == pytest.approx(difference, rel=0.02, abs=1e-3 * np.abs(slope).max())


def test_what_stays_keeps_its_place(monkeypatch) -> None:
    monkeypatch.setattr(calm_bark, "TRIES", 1)
    axis, wood, poses = flared()
    welded = welded_wood(wood)
    paths = axis_paths(axis)
    feet = paths.feet(*paths.places(axis.feet(welded.place_m)), np.zeros(len(welded.place_m)))
    still = np.arange(0, len(welded.place_m), 3)
    held = calm_bark.calmed(welded, feet, axis, poses, still)
    spacing_m = 6 / 48 / 32
    np.testing.assert_allclose(held.at_m[still], feet.at_m[still], atol=spacing_m)
    assert np.abs(held.at_m - feet.at_m).max() > 2 * spacing_m


@pytest.mark.parametrize("angle", [0.1, 0.5, 0.9])
def test_a_linear_motion_is_drawn_at_its_angle(angle: float) -> None:
    rest = np.array([(0.0, 0.0, 0.0), (0.0, 2.0, 0.0)])
    moved = np.array([(0.0, 0.0, 0.0), (2 * np.tan(angle), 0.0, 0.0)])
    shortened, stretch = unstretched(rest, np.array([0, 0]), moved)
    sine = np.tan(angle) / stretch[1]
    assert sine == pytest.approx(np.sin(angle))
    assert np.linalg.norm(rest[1] + shortened[1]) == pytest.approx(
        2 * 1.02 if angle > 0.2 else 2 / np.cos(angle)
    )
    drawn = turned(np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -sine]))
    assert np.arctan2(drawn[0], drawn[1]) == pytest.approx(angle, abs=0.12 * angle**2 + 1e-3)


def fruit_beside_a_long_edge() -> tuple[Table, DrawnFigures, list[Floats]]:
    """A pole of one cylinder, 4 m long, and a card beside its middle, held where the axis of the pole is."""
    tube = make.tube((0, 0, 0), (0, 4, 0), 0.02, 0.02, sides=6, rings=2)
    tree = make.as_tree(tube, make.cards([np.array((0.04, 2.0, 0.0))], size=0.03))
    rest = np.concatenate([part.positions_m for part in tree.primitives])
    node = np.linspace(0, 4, 9)
    points = np.stack([0 * node, node, 0 * node], axis=1).astype(np.float32)
    table = decode(POLE.read_bytes())
    modes = len(table.mode_scale)
    basis, turn = np.zeros((9, 3, modes), np.float32), np.zeros((9, 3, modes), np.float32)
    basis[:, 0, 0], turn[:, 2, 0] = node**2 / 16, -node / 8
    nearest = np.abs(rest[:, 1:2] - node).argmin(axis=1)
    nearest[len(tree.primitives[0].positions_m) :] = 4
    own = np.arange(9)
    table = replace(
        table, node_basis=basis, node_turn=turn, node_rest_m=points,
        node_parent=np.maximum(own - 1, 0).astype(np.uint16),
        joint_nodes=np.stack([own, own], axis=1).astype(np.uint16), joint_share=np.zeros(9, np.float32),
        joint_rest_m=points, vertex_joint=nearest.astype(np.uint16),
        metadata={**table.metadata, "height_m": 4.0},
    )  # fmt: skip
    q = np.zeros((2, modes))
    q[:, 0] = (0.4, -0.4)
    return table, DrawnFigures(tree), [q]


def test_a_piece_beside_the_middle_of_a_long_edge_stays_with_it() -> None:
    table, figures, q = fruit_beside_a_long_edge()
    assert figures.of(table, q)["leaves_gap"] > 0.01
    held = with_borne_pieces(table, figures, q)
    assert len(held.node_rest_m) == 10
    assert figures.of(held, q)["leaves_gap"] < 0.002
    assert figures.of(held, q)["leaves_stretch_worst"] == pytest.approx(1.0, abs=1e-4)
    again = with_borne_pieces(held, figures, q)
    assert len(again.node_rest_m) <= 11
