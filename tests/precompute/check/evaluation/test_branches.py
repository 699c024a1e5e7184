"""Motion of the branches relative to the bending trunk, on a table of known shape."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from galewood.check.evaluation.branches import branch_motion_m, outer_nodes, trunk_nodes
from galewood.table import Table, decode

from tests.golden import GOLDEN_FOLDER

POLE = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
HEIGHTS_M = (0.0, 3.0, 6.0, 10.0)
BRANCHES_M = ((1.0, 4.0, 0.0), (2.0, 4.0, 0.0), (0.5, 7.0, 0.0), (2.5, 7.0, 0.0))


def tree() -> Table:
    """A trunk of four nodes, with two branches of two nodes each that begin at its second and third node."""
    trunk = [(0.0, y, 0.0) for y in HEIGHTS_M]
    rest_m = np.array([trunk[0], trunk[1], *BRANCHES_M[:2], trunk[2], *BRANCHES_M[2:], trunk[3]], np.float32)
    #   trunk: 0 → 1 → 4 → 7; branches: 2 → 3 and 5 → 6
    parent = np.array([0, 0, 1, 2, 1, 4, 5, 4], np.uint16)
    return replace(POLE, node_rest_m=rest_m, node_parent=parent)


def test_the_trunk_continues_with_the_farthest_limb_and_the_outer_half_is_far_from_it() -> None:
    assert trunk_nodes(tree()).tolist() == [0, 1, 4, 7]
    assert sorted(outer_nodes(tree()).tolist()) == [3, 6]


def test_branches_that_follow_a_bending_trunk_do_not_move_by_themselves() -> None:
    rest_m, time = tree().node_rest_m.astype(np.float64), np.arange(60) / 10
    bend = np.interp(rest_m[:, 1], HEIGHTS_M, [0.0, 0.1, 0.4, 0.9])
    track = np.zeros((len(time), len(rest_m), 3))
    track[..., 0] = np.sin(time)[:, None] * bend
    assert branch_motion_m(tree(), track) == pytest.approx(0.0, abs=1e-12)
    own = np.sin(2 * np.pi * np.arange(60) / 20)  # three whole waves: 1/√2 about the mean
    track[:, [3, 6], 2] += own[:, None] * np.array([0.02, 0.04]) + 0.3  # a lean does not count
    assert branch_motion_m(tree(), track) == pytest.approx(0.03 / np.sqrt(2))


def test_a_pole_has_no_branches() -> None:
    parent = np.maximum(np.arange(len(POLE.node_parent)) - 1, 0).astype(np.uint16)
    assert branch_motion_m(replace(POLE, node_parent=parent), np.zeros((4, len(parent), 3))) is None
