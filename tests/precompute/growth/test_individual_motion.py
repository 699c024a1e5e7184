"""The table of an individual, from its beams and its species: against full tables, and from its document."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import galewood
import numpy as np
import pytest
from galewood.check.evaluation import METHODS, play_pressures
from galewood.growth import GrowthError
from galewood.io.cli.commands import app
from galewood.motion.wind import dynamic_pressure
from galewood.options import ImportRequest
from galewood.packaged import species_folder
from galewood.pipeline.individuals import individual_table, shipped_motions
from galewood.pipeline.results import shipped_bare_tables, shipped_tables
from galewood.pipeline.tables import BuildOptions
from galewood.solid.skinning import is_torn
from galewood.table import Foliage, Table, decode
from galewood.tree import read_tree, render_glb
from galewood.util import Floats
from typer.testing import CliRunner

MOST_DOCUMENT_BYTES = 20_000
# first frequency of the table that `galewood build` made of the same tree, in a minute or two each, Hz
FULL_BUILDS = [
    ("beech", "forest", 11, 16.7, 17.0, 0.268),
    ("spruce", "open", 11, 19.7, 35.6, 0.425),
    ("oak", "open", 11, 16.3, 43.5, 0.366),
]
BARE_BUILD = ("beech", "forest", 15, 27.5, 33.9, 0.1916)
FOLIAGES: tuple[Foliage, ...] = ("leaf", "bare")


def top_track_m(table: Table, pressure_pa: Floats) -> Floats:
    """(T, 3) motion of the highest node, m."""
    q, _ = play_pressures(table, pressure_pa, METHODS["modal"])
    top = int(table.node_rest_m[:, 1].argmax())
    return q @ table.node_basis[top].astype(np.float64).T


@pytest.mark.parametrize(("species", "form", "seed", "height_m", "dbh_cm", "full_hz"), FULL_BUILDS)
def test_the_first_frequency_is_near_that_of_a_full_build(
    species: str, form: str, seed: int, height_m: float, dbh_cm: float, full_hz: float
) -> None:
    size = {"height_m": height_m, "dbh_cm": dbh_cm, "form": form}
    table = galewood.grow(species, seed=seed, **size).table()  # type: ignore[arg-type]
    assert table.frequencies_hz[0] == pytest.approx(full_hz, rel=0.04)
    assert not is_torn(table.report["drawn"])
    assert table.metadata["provenance"]["left_out"]


@pytest.mark.parametrize("foliage", FOLIAGES)
def test_a_built_in_tree_as_an_individual_moves_like_its_fitted_table(foliage: Foliage) -> None:
    name, path = "beech-forest", species_folder() / "beech-forest.glb"
    shipped = shipped_bare_tables if foliage == "bare" else shipped_tables
    fitted = decode(shipped(species_folder())[name].read_bytes())
    height_m = float(fitted.metadata["height_m"])
    tree = read_tree(path.read_bytes(), path.name, ImportRequest(species="beech", height_m=height_m))
    options = BuildOptions(species="beech", height_m=height_m, stiffness="as drawn", foliage=foliage)
    motions = shipped_motions("beech", "forest")
    motion = motions.bare if foliage == "bare" else motions.leaf
    assert motion is not None
    quick = individual_table(tree, motion, options, render_glb(tree))
    assert quick.metadata["foliage"] == fitted.metadata["foliage"] == foliage
    hz = [table.metadata["frequencies_hz"] for table in (quick, fitted)]
    np.testing.assert_allclose(hz[0][:3], hz[1][:3], rtol=1e-3)
    assert len(quick.vertex_joint) == len(fitted.vertex_joint)
    time_s = np.arange(240) / 30
    speed_m_s = 5.0 * (1 + 0.5 * np.sin(2 * np.pi * time_s / 5.0))
    pressure_pa = np.outer(dynamic_pressure(speed_m_s, fitted.streamlined_exponent), [0.8, 0.6])
    ours_m, theirs_m = top_track_m(quick, pressure_pa), top_track_m(fitted, pressure_pa)
    sway_m = np.linalg.norm(theirs_m, axis=1).max()
    assert sway_m > 0.04 * height_m
    assert np.linalg.norm(ours_m - theirs_m, axis=1).max() < 0.15 * sway_m
    # the crown sinks as the stem bends, which a linear motion would not
    far = int(np.linalg.norm(theirs_m, axis=1).argmax())
    assert ours_m[far, 1] == pytest.approx(theirs_m[far, 1], abs=0.25 * abs(theirs_m[far, 1]))


def test_a_bare_individual_sways_faster_and_has_the_same_vertices() -> None:
    species, form, seed, height_m, dbh_cm, full_hz = BARE_BUILD
    size: dict[str, Any] = {"height_m": height_m, "dbh_cm": dbh_cm, "form": form}
    individual = galewood.grow(species, seed=seed, **size)
    leaf, bare = individual.table(), individual.table("bare")
    assert bare.frequencies_hz[0] == pytest.approx(full_hz, rel=0.04)
    assert bare.frequencies_hz[0] > 1.03 * leaf.frequencies_hz[0]
    assert not is_torn(bare.report["drawn"])
    assert bare.metadata["mesh_sha256"] == leaf.metadata["mesh_sha256"]
    assert len(bare.table.vertex_joint) == len(leaf.table.vertex_joint)


def test_a_species_that_keeps_its_leaves_has_no_bare_individual() -> None:
    with pytest.raises(ValueError, match="keeps its leaves"):
        galewood.grow("pine", seed=2, height_m=14).table("bare")


def test_a_document_without_the_bare_motion_has_the_same_table_in_leaf(apricot: bytes) -> None:
    values = json.loads(apricot)
    assert values["motion"].pop("bare")
    older = galewood.regrow(json.dumps(values))
    assert older.table().data == galewood.regrow(apricot).table().data
    with pytest.raises(ValueError, match="no bare table"):
        older.table("bare")


def test_an_individual_is_grown_again_from_its_document() -> None:
    individual = galewood.grow("beech", seed=3, height_m=20, dbh_cm=24, form="forest")
    document = individual.document()
    assert len(document) < MOST_DOCUMENT_BYTES
    again = galewood.regrow(document)
    assert (again.name, again.glb) == ("beech-forest-3", individual.glb)
    for foliage in FOLIAGES:
        assert again.table(foliage).data == individual.table(foliage).data


@pytest.fixture(scope="module")
def apricot() -> bytes:
    """The document of an individual."""
    return galewood.grow("apricot", seed=3, height_m=10, dbh_cm=28).document()


@pytest.mark.parametrize(
    "change",
    [{"format": "another"}, {"version": 2}, {"motion": {}}, {"seed": -1}, {"age": 3}, {"species": None}],
)
def test_another_document_is_refused(change: dict[str, object], apricot: bytes) -> None:
    values = json.loads(apricot) | change
    with pytest.raises(GrowthError):
        galewood.regrow(json.dumps(values))


@pytest.mark.parametrize("document", ["", "[]", "3", '{"format":"galewood-individual"}'])
def test_what_is_no_document_is_refused_in_words(document: str) -> None:
    with pytest.raises(GrowthError, match="Not the document of an individual"):
        galewood.regrow(document)


def test_the_commands_write_the_table_and_make_it_again(tmp_path: Path) -> None:
    mesh, table, document = (tmp_path / name for name in ("a.glb", "b.gwt", "c.json"))
    size = ["--seed", "4", "--height-m", "18", "--dbh-cm", "20", "--form", "forest"]
    files = ["--out", str(mesh), "--table", str(table), "--document", str(document)]
    result = CliRunner().invoke(app, ["grow", "beech", *size, *files])
    assert result.exit_code == 0, result.output
    made = galewood.load(table)
    assert made.height_m == pytest.approx(18, rel=2e-3)
    assert len(made.rest_vertices_m) == len(made.table.vertex_joint)
    again = [str(tmp_path / name) for name in ("again.glb", "moved.gwt")]
    result = CliRunner().invoke(app, ["regrow", str(document), "--out", again[0], "--table", again[1]])
    assert result.exit_code == 0, result.output
    assert Path(again[0]).read_bytes() == mesh.read_bytes()
    assert galewood.load(again[1]).data == made.data
    result = CliRunner().invoke(
        app, ["regrow", str(document), "--out", str(mesh), "--table", f"{tmp_path}/a.gwt"]
    )
    assert result.exit_code == 1
    assert "choose another name" in " ".join(result.output.split())
