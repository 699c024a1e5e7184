"""Inventories as offices and foresters write them, and the projection against Vincenty's geodesics."""

# ruff: noqa: E501 (rows of files)
from __future__ import annotations

import json
import math
import random
import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from typing import Any, cast

import pytest
from galewood.measurements.inventory import InventoryError, Stem, local_m, match_species, read_inventory
from galewood.measurements.inventory.species import COMMON_NAMES, STANDS_FOR

ROOT = Path(__file__).parents[3]
SPHERE_M = 6_371_008.8
STREET = (
    (8.40371, 49.00937, "Winterlinde", 21.5, 48),
    (8.40395, 49.00951, "Acer campestre 'Elsrijk'", 9.0, 22),
    (8.40418, 49.00922, None, 6.0, None),
    (8.40402, 49.00929, "Pyramidenpappel", None, 61),
)


def geojson(crs: str = "") -> str:
    """Points of a street, a polygon, and a feature without a place."""
    features: list[dict[str, Any]] = [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": [lon, lat]},
            "properties": {"art": name, "baumhoehe": height, "stammdurchmesser": dbh, "x": 1},
        }
        for lon, lat, name, height, dbh in STREET
    ]
    features.append({"type": "Feature", "geometry": {"type": "Polygon", "coordinates": []}, "properties": {}})
    features.append({"type": "Feature", "geometry": None, "properties": {"art": "Ulme", "baumhoehe": 12}})
    reference = {"crs": {"type": "name", "properties": {"name": crs}}} if crs else {}
    return json.dumps({"type": "FeatureCollection", **reference, "features": features}, ensure_ascii=False)


# name: text; east and north (m), species, built-in species, height (m), slender
FILES: dict[str, tuple[str, list[tuple[float, float, str, str, float, bool]]]] = {
    "plain": (
        "x,y,species,height,dbh\n0,0,maple,12,30\n10,5,poplar,22.5,28\n-4,8,Apricot,4,9\n",
        [(-3, -4, "maple", "maple", 12, False), (7, 1, "poplar", "poplar", 22.5, True), (-7, 4, "Apricot", "apricot", 4, False)],
    ),
    "german": (
        "Baumart;Rechtswert;Hochwert;Höhe (m);BHD (cm)\nStieleiche;3500000,5;5400000;18,5;35\n"
        "Bergahorn;3500010;5400020;12;15\nZitterpappel;3500015;5400008;25;\nXyz;3500012;5400009;;40\nfoo;a;b;1;1\n",
        [
            (-7.25, -10, "Stieleiche", "oak", 18.5, False),
            (2.25, 10, "Bergahorn", "sycamore", 12, True),
            (7.25, -2, "Zitterpappel", "poplar", 25, False),
            (4.25, -1, "Xyz", "maple", 1.3 + 30 * (1 - math.exp(-0.4 / 0.28)), False),
        ],
    ),
    "units": (
        "tree\tEast (ft)\tNorth (ft)\tHeight (ft)\tGirth (in)\nRed oak\t0\t0\t60\t55\nCrab apple\t30\t12\t18\t20\n",
        [
            (-15 * 0.3048, -6 * 0.3048, "Red oak", "oak", 60 * 0.3048, False),
            (15 * 0.3048, 6 * 0.3048, "Crab apple", "apricot", 18 * 0.3048, False),
        ],
    ),
    "millimetres": (
        "# plot 7\ngenus,species,X,Y,h,d\nPicea,abies,1,1,24,310\nPinus,sylvestris,4,9,22,290\n,,9,3,7,\n",
        [
            (-4, -4, "Picea abies", "spruce", 24, True),
            (-1, 4, "Pinus sylvestris", "pine", 22, True),
            (4, -2, "", "apricot", 7, True),
        ],
    ),
    "metres": (
        "x,y,ht,d\n1,1,24,0.31\n5,2,18,0.22\n2,8,11,\n",
        [(-2, -3.5, "", "maple", 24, True), (2, -2.5, "", "maple", 18, True), (-1, 3.5, "", "maple", 11, True)],
    ),
    "degrees": (
        "id;lat;lon;Art;Höhe;Umfang\n1;47,37;8,55;Roßkastanie;14;157\n2;47,3702;8,5503;Hain-Buche;9;88\n"
        "3;47,3699;8,5501;Prunus × yedoensis;6;60\n4;97;8,5;Ulme;9;88\n",
        [
            (-11.33, -5.56, "Roßkastanie", "sycamore", 14, False),
            (11.33, 16.68, "Hain-Buche", "beech", 9, False),
            (-3.78, -16.68, "Prunus × yedoensis", "apricot", 6, False),
        ],
    ),
    "faults": (
        'x,y,species,height,dbh\n0,0,"maple, red",12,30\n,3,oak,9,9\n1,1,oak,,\n2,2,oak,400,10\n3,3,oak,10,2000\n'
        "5,5,oak,NA,25\n5000,5,ash,9,12\n6,1\n7,2,elm,tall,3\n",
        [
            (-2.5, -2.5, "maple, red", "maple", 12, False),
            (2.5, 2.5, "oak", "oak", 1.3 + 30 * (1 - math.exp(-0.25 / 0.28)), False),
        ],
    ),
    "geojson": (
        geojson(),
        [
            (-17.19, 0.56, "Winterlinde", "beech", 21.5, False),
            (0.37, 16.13, "Acer campestre 'Elsrijk'", "maple", 9, False),
            (17.19, -16.13, "", "apricot", 6, False),
            (5.49, -8.34, "Pyramidenpappel", "poplar", 1.3 + 30 * (1 - math.exp(-0.61 / 0.28)), False),
        ],
    ),
    "date-line": (
        "lon,lat,height\n179.9995,-16.5,8\n-179.9995,-16.5,9\n",
        [(-53.38, 0, "", "maple", 8, False), (53.38, 0, "", "maple", 9, False)],
    ),
}  # fmt: skip
NEEDED = "Needed are 'x' and 'y' (m) or 'lon' and 'lat', and 'height' (m) or 'dbh' (cm); 'species' is useful"
REFUSED = {
    "x,y,height\n0,0,9\n3000,0,9\n": "all stems are more than 1000 m from their centre",
    "": f"no column names were found. {NEEDED}",
    "time,speed,direction\n0,3,240\n": f"no column names were found. {NEEDED}",
    "x,y,species,note\n0,0,oak,\n": f"columns are missing. Recognised: 'x' as x, 'y' as y, 'species' as species; not recognised: 'note'. {NEEDED}",
    "x,y,height\n0,,3\n": "no row describes a tree (line 2: no coordinates)",
    "x,y,height\n": "no row describes a tree",
    '{"type": "FeatureCollection", ': "the file is not valid JSON",
    '{"type": "Point", "coordinates": [8, 49]}': "expected a GeoJSON FeatureCollection of points",
    '{"type": "FeatureCollection", "features": [{"properties": {"height": 3}}]}': "no row describes a tree (feature 1: no coordinates)",
}


def vincenty_m(lon1: float, lat1: float, lon2: float, lat2: float) -> float:
    """Length of the geodesic on WGS 84 (Vincenty 1975, inverse formula)."""
    a, f = 6_378_137.0, 1 / 298.257223563
    b = a * (1 - f)
    u1 = math.atan((1 - f) * math.tan(math.radians(lat1)))
    u2 = math.atan((1 - f) * math.tan(math.radians(lat2)))
    difference = lam = math.radians(lon2 - lon1)
    s1, c1, s2, c2 = math.sin(u1), math.cos(u1), math.sin(u2), math.cos(u2)
    sin_sigma = cos_sigma = sigma = cos2_alpha = middle = 0.0
    for _ in range(20):
        sin_sigma = math.hypot(c2 * math.sin(lam), c1 * s2 - s1 * c2 * math.cos(lam))
        cos_sigma = s1 * s2 + c1 * c2 * math.cos(lam)
        sigma = math.atan2(sin_sigma, cos_sigma)
        sin_alpha = c1 * c2 * math.sin(lam) / sin_sigma
        cos2_alpha = 1 - sin_alpha**2
        middle = cos_sigma - 2 * s1 * s2 / cos2_alpha
        k = f / 16 * cos2_alpha * (4 + f * (4 - 3 * cos2_alpha))
        lam = difference + (1 - k) * f * sin_alpha * (
            sigma + k * sin_sigma * (middle + k * cos_sigma * (2 * middle**2 - 1))
        )
    square = cos2_alpha * (a * a - b * b) / (b * b)
    big_a = 1 + square / 16384 * (4096 + square * (-768 + square * (320 - 175 * square)))
    big_b = square / 1024 * (256 + square * (-128 + square * (74 - 47 * square)))
    change = big_b * sin_sigma * (middle + big_b / 4 * cos_sigma * (2 * middle**2 - 1))
    return b * big_a * (sigma - change)


def haversine_m(lon1: float, lat1: float, lon2: float, lat2: float) -> float:
    p1, p2 = math.radians(lat1), math.radians(lat2)
    h = (
        math.sin((p2 - p1) / 2) ** 2
        + math.cos(p1) * math.cos(p2) * math.sin(math.radians(lon2 - lon1) / 2) ** 2
    )
    return 2 * SPHERE_M * math.asin(math.sqrt(h))


def test_projected_distances_are_those_on_the_ellipsoid() -> None:
    seed = 11
    print("seed", seed)
    rng = random.Random(seed)
    for _ in range(300):
        lon, lat = rng.uniform(-180, 180), rng.uniform(-65, 70)
        reach = rng.uniform(10, 1000) / 111_000
        dlon, dlat = rng.uniform(-reach, reach), rng.uniform(-reach, reach)
        x, y = local_m(lon + dlon, lat + dlat, (lon, lat))
        exact = vincenty_m(lon, lat, lon + dlon, lat + dlat)
        assert math.hypot(x, y) == pytest.approx(exact, rel=1e-3)
        # the sphere itself differs from the ellipsoid by up to 0.6 %
        assert math.hypot(x, y) == pytest.approx(haversine_m(lon, lat, lon + dlon, lat + dlat), rel=7e-3)
        assert math.copysign(1, x) == math.copysign(1, dlon)
        assert math.copysign(1, y) == math.copysign(1, dlat)


@pytest.mark.parametrize("name", FILES)
def test_stems_of_usual_files(name: str) -> None:
    text, expected = FILES[name]
    stems = read_inventory(text.encode()).stems
    for stem, (east, north, species, builtin, height, slender) in zip(stems, expected, strict=True):
        assert (stem.species, stem.builtin, stem.slender) == (species, builtin, slender)
        assert (stem.east_m, stem.north_m) == pytest.approx((east, north), abs=0.01)
        assert stem.height_m == pytest.approx(height)


def test_coordinates_of_a_projected_system_are_metres() -> None:
    found = read_inventory(geojson("urn:ogc:def:crs:EPSG::25832").encode())
    assert found.report.columns["x"] == "x: m"
    assert found.report.width_m == pytest.approx(8.40418 - 8.40371)


@pytest.mark.parametrize(
    "encoded",
    [lambda text: text.encode("cp1252"), lambda text: text.encode("utf-16"),
     lambda text: text.replace("\n", "\r\n").encode("utf-8-sig")],
)  # fmt: skip
def test_usual_encodings(encoded: Any) -> None:
    text, expected = FILES["german"]
    found = read_inventory(encoded(text))
    assert [stem.species for stem in found.stems] == [row[2] for row in expected]
    assert found.report.columns["height"] == "Höhe (m): m"


def test_the_report_says_what_was_assumed_substituted_and_skipped() -> None:
    report = read_inventory(FILES["faults"][0].encode()).report
    assert report.figures == {
        "Trees": "2 of 9 rows",
        "Plot": "5 × 5 m, 200 per hectare",
        "Heights": f"12.0 to {1.3 + 30 * (1 - math.exp(-0.25 / 0.28)):.1f} m",
        "Column for x": "x: m",
        "Column for y": "y: m",
        "Column for species": "species",
        "Column for height": "height: m",
        "Column for dbh": "dbh: cm",
    }
    assert report.notes == (
        "No unit of the diameters was found: cm fits them.",
        "No unit of the heights was found: m is assumed.",
        "1 of 2 heights were missing and estimated from the diameter, by a general curve (fewer than 10 different trees have both).",
        "1 of 2 trees lack a height or a diameter, which decide between the open-grown and the slender form: "
        "the density of the plot decides.",
        "Skipped 7 of 9 rows: line 3: no coordinates; line 4: neither height nor diameter; line 5: a height of 400.0 m is "
        "not between 0.5 and 120 m; line 6: a diameter of 20.00 m is not between 0 and 12 m; line 8: 4995 m from the "
        "centre; at most 1000 m are shown; line 9: neither height nor diameter; line 10: height: 'tall' is not a "
        "number.",
    )
    assert (report.rows, report.stems, report.skipped, report.estimated_heights) == (9, 2, 7, 1)


@pytest.mark.parametrize(
    ("name", "note"),
    [
        ("degrees", "Longitudes and latitudes (WGS 84) were projected to metres."),
        ("degrees", "No unit of the circumferences was found: cm fits them."),
        ("millimetres", "No unit of the diameters was found: mm fits them."),
        ("metres", "No unit of the diameters was found: m fits them."),
        ("metres", "There is no column of species: trees below 8 m are apricots, the others maples."),
        ("german", "Substitutes for species without a tree model: "
         "Xyz (unknown) is shown as maple: 1."),
    ],
)  # fmt: skip
def test_notes(name: str, note: str) -> None:
    assert note in read_inventory(FILES[name][0].encode()).report.notes


@pytest.mark.parametrize(
    "head",
    ["UTM-Ost;UTM-Nord;d1.3;h;BA", "X_UTM32;Y_UTM32;BHD;Hoehe;Baumart", "utm32_e;utm32_n;dbh;height;species",
     "Rechtswert (GK3);Hochwert (GK3);BHD_cm;Höhe;Art", "E (LV95);N (LV95);dbh;height;sp", "E_EPSG 25832;N_EPSG 25832;d130;ht;spp"],
)  # fmt: skip
def test_columns_of_national_grids(head: str) -> None:
    found = read_inventory(f"{head}\n500000;5400000;31;21;Fichte\n500010;5400004;28;19;Buche\n".encode())
    assert [(stem.east_m, stem.north_m, stem.height_m) for stem in found.stems] == [(-5, -2, 21), (5, 2, 19)]
    assert set(found.report.columns) == {"x", "y", "dbh", "height", "species"}


def test_columns_can_be_named() -> None:
    rows = b"Ost A;Nord A;Mass\n0;0;12\n8;6;15\n"
    chosen = {"x": "Ost A", "y": "Nord A", "height": "Mass"}
    assert [stem.height_m for stem in read_inventory(rows, columns=chosen).stems] == [12, 15]
    with pytest.raises(
        InventoryError, match="there is no column 'Masse'; the first row is 'Ost A', 'Nord A', 'Mass'"
    ):
        read_inventory(rows, columns={**chosen, "height": "Masse"})
    with pytest.raises(InventoryError, match="no column holds 'width': choose from x, y, lon"):
        read_inventory(rows, columns={"width": "Mass"})


def test_missing_heights_follow_the_curve_of_their_own_stand() -> None:
    """Trees of two species with curves of their own, and ten without a height; a seed."""
    seed = 21
    print("seed", seed)
    rng = random.Random(seed)

    def height_m(species: str, dbh_m: float) -> float:
        a, b = {"Fichte": (0.045, 0.28), "Buche": (0.06, 0.31)}[species]
        return 1.3 + (dbh_m / (a + b * dbh_m)) ** 3

    trees = [(rng.choice(("Fichte", "Buche")), rng.uniform(0.1, 0.6)) for _ in range(178)]
    rows = [
        f"{rng.uniform(0, 100):.2f},{rng.uniform(0, 100):.2f},{species},"
        + (f"{height_m(species, dbh) + rng.gauss(0, 1):.3f}" if k >= 10 else "")
        + f",{100 * dbh:.3f}"
        for k, (species, dbh) in enumerate(trees)
    ]
    found = read_inventory("\n".join(["x,y,species,height,dbh", *rows]).encode())
    for stem, (species, dbh) in zip(found.stems[:10], trees, strict=False):
        assert stem.height_m == pytest.approx(height_m(species, dbh), abs=1.0)
    assert {curve.species for curve in found.report.height_curves} == {"Fichte", "Buche"}
    assert all(curve.residual_m == pytest.approx(1.0, abs=0.2) for curve in found.report.height_curves)
    note = next(note for note in found.report.notes if "were missing" in note)
    assert note.startswith("10 of 178 heights were missing and estimated from the diameter, by curves fitted")
    few = read_inventory("\n".join(["x,y,species,height,dbh", *rows[:12]]).encode())
    assert few.report.height_curves == ()


@pytest.mark.parametrize("text", REFUSED)
def test_useless_files_are_refused(text: str) -> None:
    with pytest.raises(InventoryError) as error:
        read_inventory(text.encode())
    assert str(error.value) == REFUSED[text]


@pytest.mark.parametrize(
    ("name", "builtin", "genus"),
    [
        ("Populus nigra 'Italica'", "poplar", "populus"), ("Zitter-Pappel", "poplar", "populus"),
        ("Feldahorn", "maple", "acer"), ("Süßkirsche", "apricot", "prunus"), ("Weiß-Tanne", "spruce", "abies"),
        ("Roßkastanie", "sycamore", "aesculus"), ("Rotbuche (Purpurea)", "beech", "fagus"),
        ("horse chestnut", "sycamore", "aesculus"), ("crab apple", "apricot", "malus"), ("Föhre", "pine", "pinus"),
        ("Bergahorn", "sycamore", "acer"), ("Acer pseudoplatanus L.", "sycamore", "acer"),
        ("Stieleiche", "oak", "quercus"), ("European ash", "ash", "fraxinus"), ("Moorbirke", "birch", "betula"),
        ("Trauerweide", "willow", "salix"), ("Fichte", "spruce", "picea"), ("Larix decidua", "larch", "larix"),
        ("Winterlinde", "beech", "tilia"), ("quite unknown", "maple", ""),
        ("Bu", "beech", "fagus"), ("Ei", "oak", "quercus"), ("Fi", "spruce", "picea"), ("Lä", "larch", "larix"),
        ("BAh", "sycamore", "acer"), ("SAh", "maple", "acer"), ("DGL", "spruce", "pseudotsuga"),
        ("FASY", "beech", "fagus"), ("Acps", "sycamore", "acer"),
    ],
)  # fmt: skip
def test_names_of_species(name: str, builtin: str, genus: str) -> None:
    match = match_species(name, 10.0)
    assert (match.builtin, match.genus) == (builtin, genus)


def test_every_known_name_is_found_also_with_a_capital() -> None:
    for genus, builtin in STANDS_FOR.items():
        assert match_species(f"{genus.capitalize()} spec.", 10.0).builtin == builtin
    for name, genus in COMMON_NAMES.items():
        assert match_species(name.capitalize(), 10.0).genus == genus, name


def test_trees_without_a_diameter_are_slender_where_they_stand_densely() -> None:
    def slender(apart_m: int) -> set[bool]:
        rows = "\n".join(f"{apart_m * (k % 10)},{apart_m * (k // 10)},9" for k in range(100))
        return {stem.slender for stem in read_inventory(f"x,y,height\n{rows}\n".encode()).stems}

    assert (slender(5), slender(10)) == ({True}, {False})  # 494 and 123 per hectare


def test_the_document_has_the_fields_of_its_format() -> None:
    document = json.loads(json.dumps(read_inventory(FILES["plain"][0].encode()).document()))
    page = (ROOT / "spec" / "formats" / "inventory.md").read_text(encoding="utf-8")
    assert f"# The inventory document, version {document['version']}\n" in page
    for field in fields(Stem):
        assert f"`{field.name}`" in page, field.name
    assert document["stems"][0] == {
        "line": 2, "east_m": -3.0, "north_m": -4.0, "species": "maple", "builtin": "maple", "height_m": 12.0,
        "slender": False, "dbh_cm": 30.0, "height_estimated": False,
    }  # fmt: skip
    assert document["report"]["figures"]["Trees"] == "3 of 3 rows"


def test_a_document_is_read_as_the_file_it_was_made_from() -> None:
    file = b"x,y,species,height,dbh\n0,0,Bergahorn,12,30\n9,4,Fichte,,41\n5,-5,,9,\n1,2,,,\n"
    found = read_inventory(file)
    document = json.dumps(found.document())
    again = read_inventory(document.encode())
    assert again.stems == found.stems and again.lon_lat_deg == (None,) * 3
    assert [stem.height_estimated for stem in again.stems] == [False, True, False]
    for name in ("notes", "per_ha", "estimated_heights", "substitutes", "highest_m"):
        assert getattr(again.report, name) == getattr(found.report, name), name


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"version": 2}, "version: this reader knows version 1, not 2"),
        ({"stems": []}, "stems: expected at least one"),
        ({"stems": [1]}, "stems[0]: expected an object"),
        ({"stems": [{}]}, "stems[0].line is missing: write the document again with `galewood convert`"),
        ({"height_m": "9"}, "stems[0].height_m: expected a number"),
        ({"height_m": float("nan")}, "stems[0].height_m: expected a number"),
        ({"height_m": 10**400}, "stems[0].height_m: expected a number"),
        ({"height_m": 900.0}, "stems[0].height_m: 900 is not between 0.5 and 120"),
        ({"dbh_cm": 0}, "stems[0].dbh_cm: 0 is not between 0.001 and 1200"),
        ({"builtin": "palm"}, "stems[0].builtin: expected one of poplar, maple, apricot, birch,"),
        ({"species": 3}, "stems[0].species: expected a text"),
        ({"slender": 1}, "stems[0].slender: expected true or false"),
    ],
)
def test_errors_of_documents_name_the_field(change: dict[str, object], message: str) -> None:
    document = read_inventory(FILES["plain"][0].encode()).document()
    stem = {**cast("list[dict[str, object]]", document["stems"])[0]}
    ours = {"version", "stems"}
    document["stems"] = [{**stem, **{k: v for k, v in change.items() if k not in ours}}]
    document |= {k: v for k, v in change.items() if k in ours}
    with pytest.raises(InventoryError, match=re.escape(message)):
        read_inventory(json.dumps(document).encode())


def test_places_heights_and_units_are_kept() -> None:
    rows = "\n".join(
        f"{500_000 + 10 * k},{5_400_000 + 3 * k},maple,{8 + k},{0.3 + 0.01 * k}" for k in range(9)
    )
    found = read_inventory(f"easting,northing,species,height,dbh (m)\n{rows}\n".encode())
    for k, stem in enumerate(found.stems):
        assert (stem.east_m, stem.north_m) == pytest.approx((10 * k - 40, 3 * k - 12))
        assert stem.height_m == 8 + k
        assert stem.slender is ((8 + k) / (0.3 + 0.01 * k) > 65)


def test_at_most_twenty_thousand_stems_are_taken_from_the_middle() -> None:
    rows = "\n".join(f"{k % 160},{k // 160},{5 + k % 20}" for k in range(160 * 160))
    found = read_inventory(f"x,y,height\n{rows}\n".encode())
    assert found.report.stems == 20_000
    assert found.report.skipped == 5600
    assert max(math.hypot(stem.east_m, stem.north_m) for stem in found.stems) < 81


def test_the_example_is_a_plausible_stand(tmp_path: Path) -> None:
    out = tmp_path / "stand.csv"
    subprocess.run([sys.executable, ROOT / "docs" / "examples" / "inventory.py", out], check=True)
    found = read_inventory(out)
    assert found.report.stems == 500
    assert all(note.startswith("Substitutes for species") for note in found.report.notes)
    assert found.report.width_m == pytest.approx(100, abs=4)
    assert 450 < found.report.per_ha < 560
    nearest = min(
        math.hypot(a.east_m - b.east_m, a.north_m - b.north_m)
        for k, a in enumerate(found.stems)
        for b in found.stems[:k]
    )
    assert nearest > 1.5


def test_every_genus_has_a_built_in_tree() -> None:
    builtin = {path.stem for path in (ROOT / "assets" / "species").glob("*.glb")}
    assert set(STANDS_FOR.values()) <= builtin
