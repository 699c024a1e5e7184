"""A piece beside the middle of a long edge stays with that edge."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from galewood.solid.skinning import Distortion, with_attached_pieces
from galewood.table import Table, decode
from galewood.util import Floats

from tests.golden import GOLDEN_FOLDER
from tests.precompute.fixtures import tree_meshes as make

POLE = GOLDEN_FOLDER / "pole-table.safetensors"


def fruit_beside_a_long_edge() -> tuple[Table, Distortion, list[Floats]]:
    """A pole of one cylinder, 4 m long, and a card beside its middle, bound where the axis of the pole is."""
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
    return table, Distortion(tree), [q]


def test_a_piece_beside_the_middle_of_a_long_edge_stays_with_it() -> None:
    table, distortion, q = fruit_beside_a_long_edge()
    poses = distortion.far_poses(table, q)
    assert distortion.in_poses(table, poses)["leaves_gap"] > 0.01
    attached = with_attached_pieces(table, distortion, q)
    assert len(attached.node_rest_m) == 10
    figures = distortion.in_poses(attached, poses)
    assert figures["leaves_gap"] < 0.002
    assert figures["leaves_stretch_worst"] == pytest.approx(1.0, abs=1e-4)
    again = with_attached_pieces(attached, distortion, q)
    assert len(again.node_rest_m) <= 11
