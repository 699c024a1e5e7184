"""Smoothed weights share a bend among more edges; bindings of fixed vertices and of calm limbs stay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from galewood.solid.skinning import Axis, Bindings
from galewood.solid.skinning.smoothed_weights import THOROUGH_SMOOTHING, smoothed_weights
from galewood.solid.skinning.stretch_minimisation import AxisPoses, posed_positions
from galewood.solid.skinning.wood_bindings import welded_primitive, wood_bindings
from galewood.tree.types import RenderPrimitive

from tests.precompute.solid.skinning.poles import bent, flared, pole, pole_wood


def longest_stretch(wood: RenderPrimitive, bindings: Bindings, axis: Axis, poses: AxisPoses) -> float:
    """The longest edge over its length at rest; ``bindings`` are those of the welded vertices."""
    welded, paths = welded_primitive(wood), axis.paths
    now = posed_positions(welded.place_m, *paths.places(bindings), paths, poses)
    apart = np.linalg.norm(now[welded.ends[:, 0]] - now[welded.ends[:, 1]], axis=2)
    return float((apart / np.sqrt(welded.squared_m2)[:, None]).max())


@pytest.mark.parametrize("angle", [0.3, 0.6])
def test_a_sharp_bend_is_spread_over_more_edges(angle: float) -> None:
    axis, wood = pole(), pole_wood()
    poses = bent(axis, angle * np.clip((axis.points_m[:, 1] - 1.9) / 0.2, 0, 1))  # all within a single ring
    welded = welded_primitive(wood)
    initial = wood_bindings(wood, axis).take(welded.first)
    smoothed = smoothed_weights(welded, initial, axis, poses)
    before, after = (longest_stretch(wood, one, axis, poses) for one in (initial, smoothed))
    assert before > 1 + 0.4 * angle
    assert after < 1 + 0.7 * (before - 1)


def test_a_calm_limb_keeps_its_bindings() -> None:
    axis, welded = pole(), welded_primitive(pole_wood())
    still = AxisPoses(np.zeros((41, 3, 1)), np.zeros((41, 3, 1)))
    initial = axis.nearest(welded.place_m)
    smoothed = smoothed_weights(welded, initial, axis, still)
    np.testing.assert_allclose(smoothed.at_m, initial.at_m, atol=1e-9)


def test_a_thick_foot_shares_its_bend_better_than_vertices_one_by_one() -> None:
    effort = replace(THOROUGH_SMOOTHING, tries=1)
    axis, wood, poses = flared()
    welded = welded_primitive(wood)
    initial = wood_bindings(wood, axis).take(welded.first)
    together, alone = (
        longest_stretch(wood, smoothed_weights(welded, initial, axis, poses, None, own), axis, poses)
        for own in (effort, replace(effort, passes=0))
    )
    assert longest_stretch(wood, initial, axis, poses) > 1.1
    assert together < 1 + 0.9 * (alone - 1)
    assert together < 1.1


def test_fixed_vertices_keep_their_bindings() -> None:
    axis, wood, poses = flared()
    welded = welded_primitive(wood)
    paths = axis.paths
    nearest = axis.nearest(welded.place_m)
    initial = paths.bindings(*paths.places(nearest), np.zeros(len(welded.place_m)))
    fixed = np.arange(0, len(welded.place_m), 3)
    smoothed = smoothed_weights(welded, initial, axis, poses, fixed)
    spacing_m = 6 / 48 / 32
    np.testing.assert_allclose(smoothed.at_m[fixed], initial.at_m[fixed], atol=spacing_m)
    assert np.abs(smoothed.at_m - initial.at_m).max() > 2 * spacing_m
