"""Stems of a stand: similarity against trees that are bent themselves, shelter, ranks and reports."""

from __future__ import annotations

import csv
import json
import time
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from galewood.check.stand import (
    StandOptions,
    TreeForm,
    edge_distances_m,
    form_of_rods,
    shelter_factor,
    ship_forms,
    shipped_forms,
    stand_report,
    write_report,
)
from galewood.check.stand.form_file import forms_key, shipped_key
from galewood.check.stand.forms import MEDIAN_SAMPLE
from galewood.io.cli.builtin_form import builtin_form
from galewood.io.cli.commands import app
from galewood.measurements import read_inventory, wood_species_of
from galewood.options import ImportRequest
from galewood.packaged import species_folder
from galewood.pipeline.stages import BuiltinMesh, builtin_meshes
from galewood.solid.strain import CriticalOptions, WindRods, samples, wind_rods
from galewood.solid.strain.standing import standing_rods
from galewood.table import Foliage
from galewood.tree.importer import read_tree
from galewood.wood import SPECIES, wood_of_species
from typer.testing import CliRunner

SEED = 5521


@pytest.fixture(scope="module")
def rods() -> WindRods:
    mesh = {mesh.name: mesh for mesh in builtin_meshes(species_folder())}["maple-forest"]
    tree = read_tree(mesh.path.read_bytes(), mesh.path.name, ImportRequest(species="maple", accept=True))
    return wind_rods(tree, wood_of_species("maple"))


@pytest.fixture(scope="module")
def form(rods: WindRods) -> TreeForm:
    return form_of_rods("maple-forest", rods, 0.2, 0.5)


def stretched(rods: WindRods, stretch: float, thickening: float) -> WindRods:
    """The rods of a tree of another size and as wide as it is thick: as drawn, not by similarity."""
    size = np.array([thickening, stretch, thickening])
    given = replace(
        rods.rods,
        along_m=size * rods.rods.along_m,
        bending_n_m2=thickening**4 * rods.rods.bending_n_m2,
        twisting_n_m2=thickening**4 * rods.rods.twisting_n_m2,
        weight_n=thickening**2 * stretch * rods.rods.weight_n / rods.weight_share,
    )
    standing = standing_rods(given, rods.branch)
    return replace(
        rods,
        rods=standing.rods,
        points_m=size * rods.points_m,
        radius_m=thickening * rods.radius_m,
        drag_area_m2=stretch * thickening * rods.drag_area_m2,
        leaf_area_m2=stretch * thickening * rods.leaf_area_m2,
        load_factor=standing.load_factor,
        weight_share=standing.weight_share,
    )


@pytest.mark.parametrize(
    ("stretch", "thickening"), [(1.3, 1.3), (0.7, 0.8), (1.2, 1.0), (1.0, 1.3), (1.5, 1.9)]
)
def test_similarity_agrees_with_trees_that_are_bent_themselves(
    rods: WindRods, form: TreeForm, stretch: float, thickening: float
) -> None:
    own = form_of_rods("own", stretched(rods, stretch, thickening), 0.2 * thickening, 0.5)
    tree = form.scaled(stretch * form.height_m, thickening * form.dbh_m, form.wood)
    assert tree.load_factor == pytest.approx(own.load_factor, rel=0.04)
    for wind in (5.0, 15.0, 25.0):
        expected = own.scaled(own.height_m, own.dbh_m, own.wood)
        assert tree.strain_at(wind) == pytest.approx(expected.strain_at(wind), rel=0.12)
        assert tree.sway_m(wind) == pytest.approx(expected.sway_m(wind), rel=0.15)
        assert tree.moment_nm(wind) == pytest.approx(expected.moment_nm(wind), rel=0.12)


def test_frequencies_follow_the_law_of_beams(form: TreeForm) -> None:
    """f is in proportion to d/h² where weight does not matter."""
    light = replace(form, load_factor=0.0)
    tree = light.scaled(2 * form.height_m, 3 * form.dbh_m, form.wood)
    assert tree.frequency_hz == pytest.approx(form.frequency_hz * 3 / 4)


def test_a_critical_wind_gives_the_rupture_strain(form: TreeForm) -> None:
    tree = form.scaled(form.height_m, 0.6 * form.dbh_m, form.wood)
    critical = tree.critical_m_s(0.8)
    assert np.isfinite(critical)
    assert tree.strain_at(critical, 0.8) == pytest.approx(tree.wood.rupture_strain, rel=1e-6)
    assert tree.critical_m_s(0.5) > critical
    heavier = tree.critical_m_s(0.8, MEDIAN_SAMPLE._replace(drag=1.3))
    stronger = tree.critical_m_s(0.8, MEDIAN_SAMPLE._replace(rupture=1.2))
    assert heavier < critical < stronger
    possible = [*samples(20, SEED), MEDIAN_SAMPLE._replace(rupture=50.0)]
    found = tree.all_critical_m_s(0.8, possible)
    assert list(found) == [tree.critical_m_s(0.8, one) for one in possible]
    assert np.isfinite(found[0]) and np.isinf(found[-1])


DIAMETERS_M = (0.02, 0.04, 0.06, 0.1, 0.2, 0.4)


def test_the_thinner_of_two_stems_breaks_first_however_thin(forms: dict[str, TreeForm]) -> None:
    """Where the form was not bent so far, its bending is continued; the sway ends at the height."""
    for form in forms.values():
        trees = [form.scaled(22.0, dbh_m, wood_of_species("conifer")) for dbh_m in DIAMETERS_M]
        critical = [tree.critical_m_s() for tree in trees]
        assert critical == sorted(critical) and np.isfinite(critical[:3]).all()
        for wind_m_s in (5.0, 20.0, 100.0):
            strain = [tree.strain_at(wind_m_s) for tree in trees]
            assert strain == sorted(strain, reverse=True) and len(set(strain)) == len(strain)
            assert all(tree.sway_m(wind_m_s) <= 22.0 + 1e-9 for tree in trees)
        assert trees[0].rough and not form.scaled(form.height_m, form.dbh_m, form.wood).rough


@pytest.mark.parametrize("wrong", [{"direction_deg": float("nan")}, {"direction_deg": 1e9}, {"seed": -1}])
def test_options_out_of_range_are_refused_by_name(wrong: dict[str, Any]) -> None:
    name = next(iter(wrong))
    with pytest.raises(ValueError, match=name):
        StandOptions(**wrong)
    with pytest.raises(ValueError, match=name):
        CriticalOptions(**wrong)


def test_shelter_is_that_of_the_wind_tunnel() -> None:
    """At s/h = 0.2: (0.48286 + 0.7155 · 0.25364^(x/h)) / 1.19836."""
    found = shelter_factor(np.array([0.0, 20.0, 1e4]), 20.0, 4.0)
    np.testing.assert_allclose(found, [1.0, (0.48286 + 0.7155 * 0.25364) / 1.19836, 0.40293], rtol=1e-3)


def test_edges_are_found_as_by_brute_force() -> None:
    print(f"seed {SEED}")
    generator = np.random.default_rng(SEED)
    place = np.concatenate([generator.uniform(0, 60, (150, 2)), generator.uniform(120, 160, (50, 2))])
    for direction in (0.0, 45.0, 200.0):
        found = edge_distances_m(place, direction, 15.0, 4.0)
        angle = np.radians(direction)
        wind, side = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        for k, own in enumerate(place):
            reach = 0.0
            for distance in sorted(
                float((own - other) @ wind) for other in place if abs((other - own) @ side) <= 4.0
            ):
                if distance >= reach and distance - reach <= 15.0:
                    reach = distance
            assert found[k] == pytest.approx(reach)


GERMAN = ("Rotbuche", "Stieleiche", "Bergahorn", "Fichte", "Esche", "Zitterpappel")
LATIN = (
    "Fagus sylvatica",
    "Quercus robur",
    "Acer pseudoplatanus",
    "Picea abies",
    "Fraxinus excelsior",
    "Populus tremula",
)


def stand_csv(names: tuple[str, ...], count: int = 300) -> bytes:
    """A square plantation of equal rows of trees, 4 m apart."""
    side = round(np.sqrt(count))
    rows = ["x;y;Baumart;Höhe (m);BHD (cm)"]
    for k in range(count):
        rows.append(f"{4 * (k % side)};{4 * (k // side)};{names[k % len(names)]};18;{22 + k % 3}")
    return "\n".join(rows).encode()


@pytest.fixture(scope="module")
def forms() -> dict[str, TreeForm]:
    return shipped_forms("bare")


def test_shipped_forms_are_those_of_the_built_in_trees(tmp_path: Path) -> None:
    folder = species_folder()
    meshes = builtin_meshes(folder)
    assert shipped_key(folder) == forms_key(meshes), "run `galewood ship`"
    with pytest.raises(FileNotFoundError, match="galewood ship"):
        shipped_forms("leaf", tmp_path)
    mesh = {mesh.name: mesh for mesh in meshes}["poplar-forest"]
    for foliage in get_args(Foliage):
        found, bent = shipped_forms(foliage)[mesh.name], builtin_form(mesh, foliage)
        assert (found.name, found.wood) == (bent.name, bent.wood)
        for name in {field.name for field in fields(TreeForm)} - {"name", "wood"}:
            np.testing.assert_allclose(getattr(found, name), getattr(bent, name), rtol=1e-4, err_msg=name)


def test_forms_are_written_once(tmp_path: Path, form: TreeForm) -> None:
    (tmp_path / "small.obj").write_bytes(b"mesh")
    entry = {"id": "small", "file": "small.obj", "species": "maple", "height_m": 3.0}
    (tmp_path / "species.json").write_text(json.dumps([entry]))
    (tmp_path / "shipped").mkdir()

    def bend(mesh: BuiltinMesh, foliage: Foliage) -> TreeForm:
        return replace(form, name=mesh.name, frequency_hz=1.0 if foliage == "leaf" else 2.0)

    assert ship_forms(tmp_path, bend)
    assert not ship_forms(tmp_path, bend)
    found = shipped_forms("bare", tmp_path)["small"]
    assert (found.frequency_hz, found.name, found.wood) == (2.0, "small", form.wood)
    np.testing.assert_allclose(found.strain, form.strain, rtol=1e-6)
    (tmp_path / "small.obj").write_bytes(b"another mesh")
    assert ship_forms(tmp_path, bend)


@pytest.mark.parametrize("names", [GERMAN, LATIN])
def test_an_unsheltered_edge_ranks_above_the_interior(
    names: tuple[str, ...], forms: dict[str, TreeForm]
) -> None:
    inventory = read_inventory(stand_csv(names))
    began_s = time.process_time()
    found = stand_report(inventory, forms, StandOptions(sample_count=50))
    print(f"{(time.process_time() - began_s) / 300 * 1e3:.2f} ms of processor time per stem")
    assert [stem.rank for stem in found.stems] == list(range(1, 301))
    edge = [stem for stem in found.stems if stem.edge_distance_m == 0]
    inside = [stem for stem in found.stems if stem.edge_distance_m > 15]
    assert len(edge) > 50 and len(inside) > 50
    for wood in {stem.wood for stem in found.stems}:
        of_edge = [stem.strain for stem in edge if stem.wood == wood]
        of_inside = [stem.strain for stem in inside if stem.wood == wood]
        assert min(of_edge) > max(of_inside)
    assert np.mean([stem.rank for stem in edge]) < np.mean([stem.rank for stem in inside]) - 50
    for stem in found.stems:
        assert stem.critical_low_m_s <= stem.critical_high_m_s
        assert 0 < stem.load_share <= 1 and stem.base_moment_knm > 0 and stem.sway_m > 0


def test_german_and_latin_names_give_the_same_stand(forms: dict[str, TreeForm]) -> None:
    options = StandOptions(sample_count=0)
    german, latin = (
        stand_report(read_inventory(stand_csv(names)), forms, options) for names in (GERMAN, LATIN)
    )
    assert [stem.line for stem in german.stems] == [stem.line for stem in latin.stems]
    assert {stem.wood for stem in german.stems} == {stem.wood for stem in latin.stems}


def test_woods_exist() -> None:
    assert wood_species_of("Acer pseudoplatanus") == "sycamore"
    assert wood_species_of("Feldahorn") == "maple"
    assert wood_species_of("Gemeine Kiefer") == "pine"
    assert wood_species_of("Weißtanne") == "conifer"
    assert wood_species_of("Tilia cordata") == wood_species_of("") == "default"
    from galewood.measurements.inventory.species import WOODS

    assert set(WOODS.values()) <= set(SPECIES)


def test_reports_are_written(tmp_path: Path, forms: dict[str, TreeForm]) -> None:
    text = stand_csv(('<b>"Esche"</b>', "Esche"), 40).replace(b";18;23", b";18;")
    found = stand_report(read_inventory(text), forms, StandOptions(sample_count=5))
    for ending in ("csv", "html", "json"):
        write_report(found, tmp_path / f"report.{ending}")
    with pytest.raises(ValueError, match=r"\.csv, \.html, \.geojson, \.json"):
        write_report(found, tmp_path / "report.pdf")
    with pytest.raises(ValueError, match="no longitudes"):
        write_report(found, tmp_path / "report.geojson")
    lines = [line for line in (tmp_path / "report.csv").read_text().splitlines() if not line.startswith("#")]
    rows: list[dict[str, Any]] = list(csv.DictReader(lines))
    assert len(rows) == 40 and {row["dbh_assumed"] for row in rows} == {"yes", "no"}
    page = (tmp_path / "report.html").read_text()
    assert page.count("<circle") == 40 and "no substitute for an inspection" in page
    assert "Average wood for &lt;b&gt;" not in page
    assert '<b>"' not in page and "diameters are missing" in page
    assert page.count(" *</td>") == sum(stem.dbh_assumed for stem in found.stems) > 0
    document = json.loads((tmp_path / "report.json").read_text())
    assert len(document["stems"]) == 40 and "substitute" in document["caution"]


def test_the_command(tmp_path: Path) -> None:
    inventory, out = tmp_path / "stand.csv", tmp_path / "out.html"
    inventory.write_bytes(stand_csv(("Esche",), 25))
    found = CliRunner().invoke(
        app, ["stand", str(inventory), "--out", str(out), "--samples", "3", "--foliage", "bare"]
    )
    assert found.exit_code == 0, found.output
    assert "breaks at" in found.output and "no substitute" in found.output and out.stat().st_size > 3000
    wrong = CliRunner().invoke(app, ["stand", str(inventory), "--out", str(tmp_path / "out.txt")])
    assert wrong.exit_code == 1 and ".csv, .html, .geojson, .json" in wrong.output


def test_a_report_that_cannot_be_written_is_refused_before_trees_are_bent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def bend(*arguments: object, **options: object) -> None:
        raise AssertionError("trees are bent")

    monkeypatch.setattr("galewood.io.api.stand_risk", bend)
    inventory = tmp_path / "stand.csv"
    inventory.write_bytes(stand_csv(("Esche",), 25))
    for name, reason in (("out.geojson", "no longitudes"), ("out.pdf", ".csv, .html, .geojson, .json")):
        found = CliRunner().invoke(app, ["stand", str(inventory), "--out", str(tmp_path / name)])
        assert found.exit_code == 1 and reason in " ".join(found.output.split()), found.output


def test_a_map_has_the_places_of_the_inventory(tmp_path: Path, forms: dict[str, TreeForm]) -> None:
    rows = ["lon,lat,species,height_m,dbh_cm", "8.123456,50.654321,Esche,18,24", "8.1235,50.6543,Esche,,24"]
    rows += ["8.1236,50.6544,Esche,20,25"]
    found = stand_report(read_inventory("\n".join(rows).encode()), forms, StandOptions(sample_count=3))
    write_report(found, tmp_path / "map.geojson")
    document = json.loads((tmp_path / "map.geojson").read_text())
    assert document["type"] == "FeatureCollection" and "substitute" in document["caution"]
    stems = {one["properties"]["line"]: one for one in document["features"]}
    places = {line: one["geometry"]["coordinates"] for line, one in stems.items()}
    assert places == {2: [8.123456, 50.654321], 3: [8.1235, 50.6543], 4: [8.1236, 50.6544]}
    assert [stems[line]["properties"]["height_estimated"] for line in (2, 3, 4)] == [False, True, False]
