"""Expected motion before a build, and trees made livelier or stiffer than their wood."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from galewood.io.cli.commands import app
from galewood.options import BuildRequest, ImportRequest
from galewood.pipeline.results import BUILTIN_OPTIONS, SHIPPED_FOLDER, read_shipped
from galewood.pipeline.stages import builtin_meshes
from galewood.pipeline.stages.kernel_compilation import small_tree_obj
from galewood.pipeline.tables import BuildOptions, expected_motion, motion_lines
from galewood.pipeline.tables.expected import length_words
from galewood.pipeline.tables.stiffness import Goal, goal_of, scaled_to
from galewood.solid.beams import frame_modes
from galewood.solid.fem import FemModel
from galewood.solid.model import beam_model, typical_frequency_hz
from galewood.tree import TreeMesh
from galewood.tree.importer import read_tree
from galewood.util import MeshError
from galewood.wood import Wood, WoodDocument, wood_of_species
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
    """A twig of a micrometre would hang like a thread under its leaves, whatever the trunk is.

    Even stout ones do not bear these cards, so that nothing is said of the motion of either tree.
    """
    trees = [twiggy(least_m) for least_m in (1e-5, 0.006)]
    drawn, stout = (beam_model(tree, wood_of_species(tree.species or "default")) for tree in trees)
    assert float(drawn.frequencies_hz[0]) == pytest.approx(float(stout.frequencies_hz[0]), rel=0.2)
    assert [expected_motion(tree) for tree in trees] == [None, None]


def test_lengths_are_told_without_exponents() -> None:
    words = [length_words(metres) for metres in (1e-5, 0.0021, 0.0094, 0.0096, 0.064, 2.31)]
    assert words == ["less than 0.1 mm", "2 mm", "9 mm", "1 cm", "6 cm", "2.3 m"]
    sway = {"wind_m_s": 10, "sway_m": 2e-6, "share": 8e-7}
    known = {"first_frequency_hz": 5.0, "typical_frequency_hz": 1.0, "lively_frequency_hz": 0.5}
    told = motion_lines(
        {**known, "default_frequency_hz": 0.5, "measured": False, "sway": [sway], "visible": False}
    )
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
    assert goal_of(tree, WOOD, BuildOptions(stiffness="as drawn")) is None


def test_a_stylised_tree_that_would_not_move_visibly_is_made_softer_by_default(tree: TreeMesh) -> None:
    """One rule for all ways in: that of a build without any options."""
    stiff, default = WOOD.scaled(1000), BuildOptions.model_validate({})
    expected = expected_motion(tree, stiff)
    assert expected is not None
    goal = goal_of(tree, stiff, default)
    assert goal is not None
    assert goal.frequency_hz == expected["default_frequency_hz"] == expected["lively_frequency_hz"]
    assert expected["typical_frequency_hz"] / 2 <= goal.frequency_hz <= expected["typical_frequency_hz"]
    assert "softer" in " ".join(motion_lines(expected))
    softer = expected_motion(tree, stiff.scaled(goal.factor))
    assert softer is not None
    assert softer["sway"][1]["share"] >= 0.004
    assert goal_of(tree, stiff, BuildOptions(first_frequency_hz=3.0)) == Goal(
        3.0, goal_factor(tree, stiff, 3.0)
    )
    assert goal_of(tree, stiff, BuildOptions(stiffness="as drawn")) is None


def goal_factor(tree: TreeMesh, wood: Wood, hertz: float) -> float:
    return beam_model(tree, wood).factor_for(hertz)


def test_wood_that_is_known_keeps_its_stiffness(tree: TreeMesh) -> None:
    """Radii of a scanned tree are measured, a modulus in a wood document is given."""
    stiff = WOOD.scaled(1000)
    scanned = replace(tree, report=tree.report | {"qsm": {}})
    expected = expected_motion(scanned, stiff)
    assert expected is not None and not expected["visible"]
    assert expected["default_frequency_hz"] == expected["first_frequency_hz"]
    assert goal_of(scanned, stiff, BuildOptions()) is None
    assert "scanned" in " ".join(motion_lines(expected))
    document = WoodDocument(name="mine", young_longitudinal_pa=5e10)
    assert goal_of(tree, document.wood().scaled(100), BuildOptions(wood=document)) is None
    assert goal_of(tree, stiff, BuildOptions(wood=WoodDocument(name="dense", density_kg_m3=900))) is not None


def test_builtin_trees_keep_their_wood_and_their_keys() -> None:
    species = Path(__file__).resolve().parents[3] / "assets/species"
    for mesh in builtin_meshes(species):
        assert read_shipped(species / SHIPPED_FOLDER, mesh.name, mesh.key) is not None
        assert BuildOptions.model_validate({**BUILTIN_OPTIONS, **mesh.options}).stiffness == "as drawn"


def spring(hertz: float) -> FemModel:
    """Stands for a model with this first frequency."""
    return cast(FemModel, SimpleNamespace(report={"frequencies_hz": [hertz]}))


def heavy(factor: float) -> float:
    """The weight takes a constant part of the stiffness."""
    return math.sqrt(max(factor - 0.02, 1e-9))


def supported(factor: float) -> float:
    """Soft wood is stiffened so that the tree stands: the frequency follows a small power of the factor."""
    return 0.3 * factor**0.08 if factor < 0.1 else 0.3 * 0.1**0.08 * (factor / 0.1) ** 0.5


def jumping(factor: float) -> float:
    """A smaller mass of the twigs above a factor: the frequency jumps, but not over the requested one."""
    return math.sqrt(factor) * (1.3 if factor > 0.2 else 1.0)


@pytest.mark.parametrize("hertz", [heavy, supported, jumping])
@pytest.mark.parametrize("wanted_hz", [0.22, 0.4])
@pytest.mark.parametrize("guess", [1e-3, 0.16, 30.0])
def test_a_requested_frequency_is_met_within_a_hundredth(
    hertz: Callable[[float], float], wanted_hz: float, guess: float
) -> None:
    built: list[float] = []

    def build(factor: float) -> FemModel:
        built.append(factor)
        return spring(hertz(factor))

    model, factor = scaled_to(Goal(wanted_hz, guess), build)
    assert model.report["frequencies_hz"][0] == pytest.approx(wanted_hz, rel=0.01)
    assert len(built) <= 10
    assert model.report["frequencies_hz"][0] == hertz(factor)
    assert model.report["stiffness"]["factor"] == factor
    assert "warning" not in model.report["stiffness"]


def test_a_frequency_that_no_stiffness_gives_is_told() -> None:
    model, _ = scaled_to(Goal(0.5, 0.2), lambda factor: spring(0.7 + 0.1 * factor))
    assert model.report["frequencies_hz"][0] == pytest.approx(0.7, rel=0.01)
    assert "instead of 0.5 Hz" in model.report["stiffness"]["warning"]


def test_without_beams_a_tree_is_at_most_as_stiff_as_measured_ones(
    tree: TreeMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*args: object, **kwargs: object) -> None:
        raise ValueError("no branches")

    monkeypatch.setattr("galewood.pipeline.tables.stiffness.beam_model", fails)
    goal = goal_of(tree, WOOD, BuildOptions())
    assert goal is not None
    assert goal.frequency_hz == typical_frequency_hz(tree.height_m)
    stiff, _ = scaled_to(goal, lambda factor: spring(9 * math.sqrt(factor)))
    assert stiff.report["frequencies_hz"][0] == pytest.approx(goal.frequency_hz, rel=0.01)
    limp, factor = scaled_to(goal, lambda factor: spring(0.5 * math.sqrt(factor)))
    assert factor == 1 and limp.report["frequencies_hz"] == [0.5]


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
