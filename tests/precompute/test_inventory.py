"""Inventories: golden files, and the projection against Vincenty's geodesics."""

from __future__ import annotations

import json
import math
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from galewood.inventory import InventoryError, local_m, read_inventory
from galewood.inventory.species import STANDS_FOR

from tests.golden import make_inventory

ROOT = Path(__file__).parents[2]
GOLDEN = json.loads((ROOT / "tests" / "golden" / "inventory.json").read_text())
SPHERE_M = 6_371_008.8


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


def close(own: Any, known: Any, path: str) -> None:
    if isinstance(known, dict):
        assert list(own) == list(known), path
        for key, value in known.items():
            close(own[key], value, f"{path}.{key}")
    elif isinstance(known, list):
        assert len(own) == len(known), path
        for k, value in enumerate(known):
            close(own[k], value, f"{path}[{k}]")
    else:
        assert own == (pytest.approx(known, abs=1e-6) if isinstance(known, float) else known), path


@pytest.mark.parametrize("known", GOLDEN["files"], ids=lambda known: known["name"])
def test_golden_files_are_current(known: dict[str, Any]) -> None:
    found = make_inventory.read(known["name"], make_inventory.FILES[known["name"]])
    close(json.loads(json.dumps(found)), known, known["name"])


@pytest.mark.parametrize("known", GOLDEN["refused"], ids=lambda known: known["name"])
def test_useless_files_are_refused(known: dict[str, str]) -> None:
    with pytest.raises(InventoryError) as error:
        read_inventory(known["text"].encode())
    assert str(error.value) == known["error"]


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
    assert not found.report.notes
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
