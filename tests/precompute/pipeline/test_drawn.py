"""No table tears the tree: its stretch is measured in poses that it was not made for."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np
import pytest
from galewood.pipeline.stages.artefacts import ArtefactPublisher
from galewood.pipeline.tables import BuildOptions, beam_table, encoded_unless_torn
from galewood.pipeline.tables.drawn import (
    CHECKED_POSES,
    FITTED_POSES,
    PoseChoice,
    drawn_poses,
    farthest_points,
)
from galewood.solid.skinning import Distortion, is_torn
from galewood.table import decode
from galewood.util import WorkerPool

from tests.golden import GOLDEN_FOLDER
from tests.precompute.fixtures.torn_trees import TORN_TREES

UNSEEN = PoseChoice(heading_deg=50.0, seed=77)
"""Poses that no code knows."""
MARGIN = 1.5
"""A tree is not stretched much more in other poses than in those in which it was checked."""


SLOW_TREES = ("twigs",)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if name in SLOW_TREES else ()) for name in TORN_TREES]
)
def test_the_first_table_states_its_stretch_and_is_published_only_if_it_does_not_tear(name: str) -> None:
    tree = TORN_TREES[name]()
    table, distortion = beam_table(tree, BuildOptions(), b""), Distortion(tree)
    drawn = table.metadata["drawn"]
    poses = drawn_poses(table, distortion.rest_m, distortion.wood, UNSEEN)
    found = distortion.in_poses(table, poses, gaps=False)
    assert found["wood_stretch"] - 1 < MARGIN * (drawn["wood_stretch"] - 1) + 0.02
    assert (encoded_unless_torn(table) is None) == is_torn(drawn)
    sways = distortion.in_poses(table, poses[:12], gaps=False)  # four headings, and the storm
    assert sways["wood_stretch"] < 1.2  # the twigs 1.16


def test_a_torn_table_is_not_published(caplog) -> None:
    table = decode((GOLDEN_FOLDER / "pole-table.safetensors").read_bytes())
    figures = {"wood_stretch": 1.2, "wood_stretch_worst": 1.31}
    torn = replace(table, metadata={**table.metadata, "drawn": figures})
    torn.metadata["provenance"] = {"stage": "beams"}
    whole = replace(torn, metadata={**torn.metadata, "drawn": {**figures, "wood_stretch_worst": 1.29}})
    published: dict[str, bytes] = {}
    with caplog.at_level(logging.INFO, "galewood.build"), WorkerPool(1) as pool:
        publisher = ArtefactPublisher(pool, published.__setitem__)
        publisher.compute("beams.table", lambda: encoded_unless_torn(torn))
        publisher.publish("complete.table", lambda: encoded_unless_torn(whole))
        publisher.wait()
    assert list(published) == ["complete.table"]
    assert "stretches edges of the wood to 1.31 times their length" in caplog.text


def test_poses_sway_by_a_fifth_and_differ_between_fit_and_check() -> None:
    table = decode((GOLDEN_FOLDER / "pole-table.safetensors").read_bytes())
    rest = np.array([[0.0, height, 0.0] for height in np.linspace(0, 5, len(table.vertex_joint))])
    fitted, checked = (
        drawn_poses(table, rest, np.arange(len(rest)), one) for one in (FITTED_POSES, CHECKED_POSES)
    )
    top = table.node_basis[int(table.node_rest_m[:, 1].argmax())].astype(float)
    height_m = float(table.metadata["height_m"])
    np.testing.assert_allclose(np.linalg.norm(fitted[:4] @ top.T, axis=1), 0.2 * height_m, rtol=1e-6)
    assert len(fitted) - len(checked) >= 72, "pulls at many points: each bends a limb that others do not"
    apart = np.linalg.norm(fitted[:4, None] @ top.T - checked[None, :4] @ top.T, axis=2)
    assert apart.min() > 0.02 * height_m


def test_pulls_that_weights_are_smoothed_for_reach_the_tip_of_every_limb() -> None:
    seed = 5
    rng = np.random.default_rng(seed)
    trunk = rng.uniform((-0.2, 2.0, -0.2), (0.2, 4.0, 0.2), (500, 3))
    angle = np.arange(6) * np.pi / 3
    tips = np.stack([3 * np.cos(angle), np.full(6, 3.0), 3 * np.sin(angle)], axis=1)
    place = np.concatenate([trunk, tips])
    spread = farthest_points(place, first=0, count=7)
    assert set(spread[1:]) == set(range(len(trunk), len(place))), f"seed {seed}"
