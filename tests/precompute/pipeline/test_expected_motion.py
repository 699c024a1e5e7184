"""Expected motion before a build, and trees made livelier or stiffer than their wood."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.io.cli.commands import app
from galewood.options import BuildRequest, ImportRequest
from galewood.pipeline.stages.kernel_compilation import small_tree_obj
from galewood.pipeline.tables import BuildOptions, expected_motion, motion_lines
from galewood.pipeline.tables.expected import length_words
from galewood.pipeline.tables.stiffness import Goal, goal_of, scaled_to
from galewood.solid.beams import frame_modes
from galewood.solid.model import beam_model, typical_frequency_hz
from galewood.tree import TreeMesh
from galewood.tree.importer import read_tree
from galewood.util import MeshError
from galewood.wood import wood_of_species
from typer.testing import CliRunner

from tests.precompute.fixtures.labelled import shapes as shapes
from tests.precompute.fixtures.labelled.looks import Look, Part
from tests.precompute.fixtures.labelled.writers import write_glb

WOOD = wood_of_species("maple")


@pytest.fixture(scope="module")
def tree() -> TreeMesh:
    return read_tree(small_tree_obj(), "tree.obj", ImportRequest(species="maple", height_m=5.0, up_axis="y"))


def test_typical_frequency_is_that_of_measured_trees() -> None:
    # A tree of 14.7 m and 22 cm sways at 0.41 Hz in the open.
    assert typical_frequency_hz(14.7) == pytest.approx(0.41, abs=0.01)
    heights_m = np.linspace(0.5, 60, 40)
    frequencies = [typical_frequency_hz(height_m) for height_m in heights_m]
    assert (np.diff(frequencies) <= 0).all()


def test_expected_motion_is_that_of_the_beams(tree: TreeMesh) -> None:
    expected = expected_motion(tree)
    assert expected is not None
    model = beam_model(tree, WOOD)
    assert expected["first_frequency_hz"] == pytest.approx(float(model.frequencies_hz[0]))
    slow, fast = expected["sway"]
    assert (slow["wind_m_s"], fast["wind_m_s"]) == (10, 18)
    assert 0 < slow["sway_m"] < fast["sway_m"]
    assert fast["share"] == pytest.approx(fast["sway_m"] / tree.height_m)
    assert expected["lively_frequency_hz"] <= expected["first_frequency_hz"]


def twiggy(least_m: float) -> TreeMesh:
    """A trunk with twelve bare twigs that taper to `least_m`, each with a large card at its end."""
    rise = np.column_stack([np.zeros(9), np.linspace(0, 10, 9), np.zeros(9)])
    wood, tips = [shapes.tube(rise, np.linspace(0.2, 0.03, 9), 12)], []
    for k in range(12):
        foot = np.array([0, 4 + 0.45 * k, 0])
        tips.append(foot + np.array([1.6 * np.cos(2.4 * k), 0.7, 1.6 * np.sin(2.4 * k)]))
        radii = np.maximum(np.geomspace(0.02, 1e-5, 6), least_m)
        wood.append(shapes.tube(np.linspace(foot, tips[-1], 6), radii, 6))
    cards = shapes.cards(np.random.default_rng(3), np.array(tips), 0.3)
    brown, green = (Look(factor=(*rgb, 1.0)) for rgb in ((0.2, 0.12, 0.06), (0.1, 0.3, 0.05)))
    parts = [Part("bark", "wood", shapes.together(*wood), brown), Part("leaves", "leaves", cards, green)]
    return read_tree(write_glb(parts), "tree.glb")


def test_twigs_drawn_to_a_point_do_not_make_a_tree_limp() -> None:
    """A twig of a micrometre would hang like a thread under its leaves, whatever the trunk is."""
    drawn, stout = (expected_motion(twiggy(least_m)) for least_m in (1e-5, 0.006))
    assert drawn is not None and stout is not None
    assert drawn["first_frequency_hz"] == pytest.approx(stout["first_frequency_hz"], rel=0.2)


def test_lengths_are_told_without_exponents() -> None:
    words = [length_words(metres) for metres in (1e-5, 0.0021, 0.0094, 0.0096, 0.064, 2.31)]
    assert words == ["less than 0.1 mm", "2 mm", "9 mm", "1 cm", "6 cm", "2.3 m"]
    sway = {"wind_m_s": 10, "sway_m": 2e-6, "share": 8e-7}
    known = {"first_frequency_hz": 5.0, "typical_frequency_hz": 1.0, "lively_frequency_hz": 0.5}
    told = motion_lines({**known, "sway": [sway], "visible": False})
    assert "e-" not in " ".join(told)


def test_a_stiff_tree_is_told_and_its_lively_frequency_makes_it_visible(tree: TreeMesh) -> None:
    stiff = WOOD.scaled(1000)
    expected = expected_motion(tree, stiff)
    assert expected is not None
    assert not expected["visible"]
    text = " ".join(motion_lines(expected))
    assert "barely visible" in text
    goal = goal_of(tree, stiff, BuildOptions(first_frequency_hz=expected["lively_frequency_hz"]))
    assert goal is not None
    livelier = expected_motion(tree, stiff.scaled(goal.factor))
    assert livelier is not None
    assert livelier["first_frequency_hz"] == pytest.approx(expected["lively_frequency_hz"], rel=1e-6)
    assert livelier["sway"][1]["share"] > 100 * expected["sway"][1]["share"]


def test_sway_and_frequency_lead_to_the_same_stiffness(tree: TreeMesh) -> None:
    by_sway = goal_of(tree, WOOD, BuildOptions(sway=0.05))
    assert by_sway is not None
    scaled = beam_model(tree, WOOD.scaled(by_sway.factor))
    assert scaled.steady_sway_m(18.0) == pytest.approx(0.05 * tree.height_m, rel=1e-6)
    by_frequency = goal_of(tree, WOOD, BuildOptions(first_frequency_hz=by_sway.frequency_hz))
    assert by_frequency is not None
    assert by_frequency.factor == pytest.approx(by_sway.factor, rel=1e-6)
    assert goal_of(tree, WOOD, BuildOptions()) is None


class Spring:
    """A model whose frequency follows its stiffness, less a part that does not: its weight."""

    def __init__(self, modulus_pa: float) -> None:
        hertz = math.sqrt(max(modulus_pa / WOOD.young_longitudinal_pa - 0.02, 1e-9))
        self.report = {"frequencies_hz": [hertz]}


def test_the_weight_of_the_tree_is_corrected_for() -> None:
    model, wood = scaled_to(Goal(0.4, 0.4**2), WOOD, lambda wood: Spring(wood.young_longitudinal_pa))  # type: ignore[arg-type]
    assert model.report["frequencies_hz"][0] == pytest.approx(0.4, rel=0.02)
    assert model.report["stiffness"]["factor"] == pytest.approx(
        wood.young_longitudinal_pa / WOOD.young_longitudinal_pa
    )


def test_beams_without_a_frequency_say_nothing(tree: TreeMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(*args: Any) -> Any:
        modes = frame_modes(*args)
        return replace(modes, frequencies_hz=np.full_like(modes.frequencies_hz, np.nan))

    monkeypatch.setattr("galewood.solid.model.beam_tree.frame_modes", unknown)
    assert expected_motion(tree) is None
    with pytest.raises(ValueError, match="no usable frequencies"):
        beam_model(tree, WOOD)
    assert "nan" not in " ".join(motion_lines(None)) and "Unsure" in motion_lines(None)[0]


def test_wood_without_branches_cannot_be_given_a_sway(
    tree: TreeMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*args: object, **kwargs: object) -> None:
        raise ValueError("no branches")

    monkeypatch.setattr("galewood.pipeline.tables.stiffness.beam_model", fails)
    monkeypatch.setattr("galewood.pipeline.tables.expected.beam_model", fails)
    assert expected_motion(tree) is None
    assert motion_lines(None)
    with pytest.raises(MeshError, match="first frequency instead"):
        goal_of(tree, WOOD, BuildOptions(sway=0.05))
    goal = goal_of(tree, WOOD, BuildOptions(first_frequency_hz=2.0))
    assert goal is not None
    assert (goal.frequency_hz, goal.factor) == (2.0, 1.0)


def test_a_request_sets_the_stiffness_once() -> None:
    with pytest.raises(ValueError, match="sway"):
        BuildRequest(sway=0.9)
    with pytest.raises(ValueError, match="either"):
        BuildRequest(sway=0.1, first_frequency_hz=0.5)


def test_check_tells_parts_and_motion_and_draws(tmp_path: Path) -> None:
    mesh, picture, figures = tmp_path / "tree.obj", tmp_path / "deep" / "tree.png", tmp_path / "tree.json"
    mesh.write_bytes(small_tree_obj())
    arguments = ["check", str(mesh), "--preview", str(picture), "--json", str(figures), "--up-axis", "y"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert "wood" in result.output
    assert "expected sway" in result.output
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert '"expected"' in figures.read_text()


def test_check_fails_with_a_sentence_and_strict_counts_warnings(tmp_path: Path) -> None:
    broken, tall = tmp_path / "broken.glb", tmp_path / "tall.obj"
    broken.write_bytes(b"glTF but not really")
    assert CliRunner().invoke(app, ["check", str(broken)]).exit_code == 1
    tall.write_bytes(small_tree_obj())
    warned = CliRunner().invoke(app, ["check", str(tall), "--strict"])
    assert warned.exit_code == (3 if "Warning" in warned.output else 0)
    assert CliRunner().invoke(app, ["check", str(tall), "--height-m", "-3"]).exit_code == 1
