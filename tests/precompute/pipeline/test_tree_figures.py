"""The figures of a tree in the report of a build, and the lines that the command prints."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from galewood.pipeline.tables.summary import figures_of, tree_lines

NO_SWAY = {"main_mode": None, "main_frequency_hz": None}


def cone(height_m: float) -> Any:
    """The skeleton of a trunk of 20 cm at its base, tapering to a point, with a limb."""
    up = np.linspace(0, height_m, 21)
    points = np.column_stack([np.zeros(21), up + 3.0, np.zeros(21)])
    limb = np.array([[0.5, 3.0 + height_m / 2, 0.0]])
    return SimpleNamespace(
        points_m=np.vstack([points, limb]),
        radius_m=np.append(0.1 * (1 - up / height_m), 0.5),
        branch=np.append(np.zeros(21, int), 1),
    )


def figures(height_m: float = 10.0, **model: Any) -> dict[str, Any]:
    corners = np.array([[0, 3.0, 0], [1, 3.0, 0], [0, 4.0, 0], [0, 3.0, 1]])
    mesh: Any = SimpleNamespace(
        vertices_m=corners, tets=np.array([[0, 1, 2, 3]]), radius_ratio=np.array([0.5])
    )
    tree: Any = SimpleNamespace(height_m=height_m)
    lumped: Any = SimpleNamespace(
        report={"leaf_mass_kg": 20.0, "twig_mass_kg": 3.0, "added_twig_mass_kg": 4.0}
    )
    report = {
        "wood_mass_kg": 300.0,
        "rest_pose": {"kind": "loaded"},
        "frequencies_hz": [0.3, 0.5],
        "sway": {"main_mode": 1, "main_frequency_hz": 0.5},
        **model,
    }
    made: Any = SimpleNamespace(
        tets=mesh, skeleton=cone(height_m), lumped=lumped, fem=SimpleNamespace(report=report)
    )
    return figures_of(tree, made)


def test_the_diameter_is_that_of_the_trunk_at_breast_height() -> None:
    assert figures()["dbh_cm"] == pytest.approx(20 * (1 - 1.3 / 10))
    assert figures(1.2)["dbh_cm"] is None
    assert not any("diameter" in line for line in tree_lines(figures(1.2)))


def test_masses_and_volume_add_up() -> None:
    found = figures()
    assert found["wood_volume_m3"] == pytest.approx(0.25 / 6)
    masses = [found[f"{part}_mass_kg"] for part in ("wood", "twig", "leaf")]
    assert masses == [300.0, pytest.approx(7.0), 20.0]


def test_the_main_sway_mode_is_named_where_it_is_not_the_first() -> None:
    bare = {"frequencies_hz": [0.4, 0.6], "sway": {"main_mode": 0, "main_frequency_hz": 0.4}}
    found = figures(bare=bare)
    assert (found["main_sway_mode"], found["bare_main_sway_mode"]) == (2, 1)
    line = tree_lines(found)[-1]
    assert line == "first frequency 0.3 Hz (main sway: mode 2, 0.5 Hz), without leaves 0.4 Hz"


def test_a_bare_tree_has_one_frequency() -> None:
    found = figures(sway=NO_SWAY)
    assert found["main_sway_mode"] is None and found["bare_first_frequency_hz"] is None
    assert tree_lines(found)[-1] == "first frequency 0.3 Hz"
