"""Individuals of a species: the size that was asked for, from seed to bytes; what can go wrong with Node."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import galewood
import numpy as np
import pytest
from galewood.check.field import diameter_cm
from galewood.constants import BREAST_HEIGHT_M
from galewood.growth import GrowthError, grow_files, read_skeleton
from galewood.io.cli.commands import app
from galewood.options import IndividualRequest
from galewood.solid.beams import joined_frame
from galewood.tree import face_components
from typer.testing import CliRunner

OAK = IndividualRequest(seed=11, height_m=14, dbh_cm=38)
SIZES = [
    ("oak", {"seed": 3, "height_m": 20.0, "dbh_cm": 58.0}),
    ("spruce", {"seed": 4, "height_m": 16.0, "dbh_cm": 29.0}),
    ("larch", {"seed": 5, "height_m": 26.0, "dbh_cm": 30.0, "form": "forest"}),
    ("willow", {"seed": 6, "height_m": 8.0, "dbh_cm": 26.0}),
]


@pytest.mark.parametrize(("species", "asked"), SIZES)
def test_an_individual_has_its_size_and_is_read_without_warnings(
    species: str, asked: dict[str, float]
) -> None:
    individual = galewood.grow(species, **asked)  # type: ignore[arg-type]
    tree = individual.tree
    assert tree.report["warnings"] == []
    assert tree.report["questions"] == []
    assert {part.kind for part in tree.mesh.primitives} == {"wood", "twigs", "leaves"}
    places = np.concatenate([part.positions_m for part in tree.mesh.primitives])
    assert places[:, 1].max() == pytest.approx(asked["height_m"], rel=2e-3)
    # without the boughs, which may cross breast height as well
    _, component = face_components(tree.wood_faces, len(tree.wood_vertices_m))
    lowest = int(tree.wood_vertices_m[tree.wood_faces, 1].min(axis=1).argmin())
    stem = tree.wood_faces[component == component[lowest]]
    measured_cm = diameter_cm(tree.wood_vertices_m, stem, BREAST_HEIGHT_M)
    assert measured_cm == pytest.approx(asked["dbh_cm"], rel=0.02)


def test_the_same_values_give_the_same_bytes_and_another_seed_another_tree() -> None:
    first, second = grow_files("oak", OAK), grow_files("oak", OAK)
    assert hashlib.sha256(first.glb).digest() == hashlib.sha256(second.glb).digest()
    assert first.skeleton == second.skeleton
    other = grow_files("oak", OAK.model_copy(update={"seed": 12}))
    assert other.glb != first.glb
    assert other.skeleton != first.skeleton


def test_the_skeleton_is_that_of_the_mesh() -> None:
    individual = galewood.grow("oak", **OAK.model_dump())
    skeleton = individual.skeleton
    assert (skeleton.parent < np.arange(len(skeleton.parent))).all()
    frame = joined_frame(skeleton.points_m, skeleton.radius_m, skeleton.parent, skeleton.branch)
    corners = individual.tree.wood_vertices_m[individual.tree.wood_faces]
    volume_m3 = abs(np.einsum("fi,fi->f", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) / 6
    # the bases of the branches lie inside the stem, where the closed tubes overlap
    assert frame.volume_m3() == pytest.approx(volume_m3, rel=0.1)


def test_a_document_that_is_no_skeleton_is_refused() -> None:
    with pytest.raises(ValueError, match="not the skeleton of a grown tree"):
        read_skeleton(b"{}")


def test_what_cannot_be_grown_is_said_in_words() -> None:
    with pytest.raises(GrowthError, match="called 'elm': choose one of poplar, maple"):
        grow_files("elm", OAK)
    with pytest.raises(GrowthError, match=r"60.* m is out of range for English oak: choose 6\.4 to 25\.6 m"):
        grow_files("oak", OAK.model_copy(update={"height_m": 60.0}))


def test_without_node_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(GrowthError, match="Install Node 20 or newer"):
        grow_files("oak", OAK)


def _node_that(folder: Path, script: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put a program called node first on the path."""
    program = folder / "node"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")


def test_what_a_failing_node_says_is_passed_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _node_that(tmp_path, "echo 'SyntaxError: top-level await' >&2; exit 9", monkeypatch)
    with pytest.raises(GrowthError, match=r"code 9.*Node 20 or newer.*top-level await"):
        grow_files("oak", OAK)


def test_a_node_that_hangs_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _node_that(tmp_path, "exec sleep 600", monkeypatch)
    with pytest.raises(GrowthError, match=r"took longer than 0\.2 s"):
        grow_files("oak", OAK, time_limit_s=0.2)


def test_a_tree_that_is_no_longer_wanted_is_not_grown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _node_that(tmp_path, "exec sleep 600", monkeypatch)
    answers = iter([True, True, False])
    with pytest.raises(galewood.Cancelled):
        galewood.grow("oak", **OAK.model_dump(), wanted=lambda: next(answers))


def test_the_command_writes_the_mesh_and_refuses_in_words(tmp_path: Path) -> None:
    out = tmp_path / "new" / "oak.glb"
    options = ["--seed", "11", "--height-m", "14", "--dbh-cm", "38"]
    result = CliRunner().invoke(app, ["grow", "oak", *options, "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert out.read_bytes() == grow_files("oak", OAK).glb
    options[3] = "99"
    result = CliRunner().invoke(app, ["grow", "oak", *options, "--out", str(out)])
    assert result.exit_code == 1
    assert "choose 6.4 to 25.6 m" in " ".join(result.output.split())


def test_the_nearest_size_is_taken_if_that_is_wanted() -> None:
    tall = IndividualRequest(seed=11, height_m=60, dbh_cm=500, nearest_size=True)
    most = IndividualRequest(seed=11, height_m=25.6, dbh_cm=115.328)  # 1.6 and 1.7 times what is usual
    assert grow_files("oak", tall).glb == grow_files("oak", most).glb
    individual = galewood.grow("oak", seed=11, height_m=60, nearest_size=True)
    assert individual.tree.height_m == pytest.approx(25.6, rel=2e-3)
    assert galewood.regrow(individual.document()).glb == individual.glb


def test_without_a_diameter_it_is_in_proportion_to_the_height() -> None:
    given = IndividualRequest(seed=11, height_m=12, dbh_cm=31.8)  # 42.4 cm at 16 m
    assert grow_files("oak", given).glb == grow_files("oak", given.model_copy(update={"dbh_cm": None})).glb
