"""Wood is bound beside itself; bindings at forks are near to each other."""

from __future__ import annotations

import numpy as np
from galewood.solid.skinning import Axis, Bindings
from galewood.solid.skinning.wood_bindings import limited_slope, wood_bindings
from galewood.util import Floats, Ints

from tests.precompute.solid.skinning.poles import axis_of, pole, pole_wood


def test_a_straight_limb_is_bound_beside_itself() -> None:
    axis, wood = pole(), pole_wood()
    bindings = wood_bindings(wood, axis)
    inner = np.abs(wood.positions_m[:, 1] - 2) < 1.7
    np.testing.assert_allclose(bindings.at_m[inner, 1], wood.positions_m[inner, 1], atol=0.02)


def fork() -> tuple[Axis, Floats, Ints, Bindings]:
    """Two limbs from a fork at 1 m, and an edge of 0.05 m between vertices bound 0.2 m up each limb."""
    up = np.linspace(0, 1, 11)
    trunk = np.stack([0 * up, up, 0 * up], axis=1)
    limbs = [np.stack([s * up[1:], 1 + up[1:], 0 * up[1:]], axis=1) for s in (-0.3, 0.3)]
    parent = np.array([*range(-1, 10), 10, *range(11, 20), 10, *range(21, 30)])
    axis = axis_of(np.concatenate([trunk, *limbs]), parent, 0.2)
    place = np.array([(-0.025, 1.2, 0), (0.025, 1.2, 0)])
    child = np.array([12, 22])
    bindings = Bindings(child, np.ones(2), axis.points_m[child], np.zeros(2))
    return axis, place, np.array([[0, 1]]), bindings


def test_neighbours_on_two_limbs_are_bound_near_their_fork() -> None:
    axis, place, ends, bindings = fork()
    before = np.linalg.norm(np.diff(bindings.at_m, axis=0))
    _, arc = axis.paths.places(limited_slope(bindings, place, ends, axis))
    assert before > 0.1
    assert float((arc - 1.0).sum()) < 1.4 * 0.05 + 1e-6, "the path is hardly longer than the edge"
    assert (arc >= 1.0 - 1e-9).all(), "no binding is moved farther than to the fork"
