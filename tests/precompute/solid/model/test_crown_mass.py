"""Twigs that a mesh lacks: their mass follows from trunk and finest branches, and hangs where leaves do."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from galewood.options import ImportRequest
from galewood.solid.model import crown_mass
from galewood.solid.model.crown_mass import branch_mass_kg, twig_loads, twig_mass_per_area
from galewood.solid.skeleton import outline_of
from galewood.tree import TreeMesh
from galewood.tree.importer import read_tree
from galewood.util import Floats

from tests.precompute.fixtures import cylinder_models as make

WEIGHED_BRANCHES = """4.5 2571, 1.9 260, 3.3 825, 2.4 455, 1.5 113, 2.7 430, 1.2 68, 2.4 426, 3.4 1014,
5.2 6612, 3.1 1043, 3.8 1729, 1.8 116,
2.2 673, 2.3 388, 5.5 4381, 3.1 1138, 9.9 23133, 3.0 1261, 2.0 467, 1.5 165"""
"""Diameter (cm) and fresh mass (g) of branches: FES 519b, Yale, allom/brdat.txt."""
PLENTY_KG = 1e6
BREAST_CM = 20.0


def comb(bearing: int = 8) -> Any:
    """A straight trunk of 20 cm with limbs of 4 cm at equal distances, 8 m high."""
    height = np.linspace(0, 8, 41)
    trunk = make.chain(np.column_stack([np.zeros((41, 2)), height]), np.full(40, BREAST_CM / 200))
    at = np.linspace(12, 36, bearing).astype(int)
    angle = 2.4 * np.arange(bearing)
    start, end, radius, parent = trunk.start_m, trunk.end_m, trunk.radius_m, trunk.parent
    for own, turn in zip(at, angle, strict=True):
        tip = np.array([2 * np.cos(turn), 2 * np.sin(turn), height[own] + 1.0])
        knots = np.linspace(0, 1, 7)[:, None] * (tip - start[own]) + start[own]
        first = len(radius)
        start, end = np.vstack([start, knots[:-1]]), np.vstack([end, knots[1:]])
        radius = np.append(radius, np.full(6, 0.02))
        parent = np.concatenate([parent, [own], np.arange(first, first + 5)])
    return replace(
        trunk, start_m=start, end_m=end, radius_m=radius, parent=parent, extension=np.full(len(radius), -1)
    )


def read(add_leaves: bool = True, bearing: int = 8) -> TreeMesh:
    return read_tree(make.archi(comb(bearing)), "a.csv", ImportRequest(add_leaves=add_leaves))


def as_a_mesh(tree: TreeMesh) -> TreeMesh:
    """The tree without what its file said of the scan."""
    return replace(tree, report={key: value for key, value in tree.report.items() if key != "qsm"})


def collected(places: list[tuple[Floats, Floats]], primitive: Any, amount: Floats) -> Floats:
    """Spreads everything to two points, below and above 4 m, and keeps what it was given."""
    places.append((primitive.positions_m, amount))
    above = (primitive.positions_m[:, 1] > 4.0).astype(int)
    return np.bincount(above, amount, 2).astype(np.float64)


def loads(tree: TreeMesh, wood_kg: float = PLENTY_KG, drawn_kg: float = 0.0) -> Any:
    return twig_loads(tree, partial(collected, []), wood_kg, drawn_kg)


def test_the_mass_of_a_branch_is_that_of_weighed_branches() -> None:
    diameter, gram = np.array([[float(x) for x in pair.split()] for pair in WEIGHED_BRANCHES.split(",")]).T
    power, offset = np.polyfit(np.log(diameter), np.log(gram / 1000), 1)
    for cm in (1.0, 2.0, 5.0, 10.0):
        assert branch_mass_kg(cm) == pytest.approx(np.exp(offset) * cm**power, rel=0.01)
    off = np.log(gram / 1000) - np.log([branch_mass_kg(cm) for cm in diameter])
    assert np.std(off) == pytest.approx(np.log(1.34), abs=0.01)


def test_branches_of_one_thickness_have_the_trunk_s_cross_section() -> None:
    """A trunk of 20 cm bears a hundred branches of 2 cm, and their twigs are all its twigs."""
    area = np.pi / 4 * 0.2**2
    assert twig_mass_per_area(2.0) * area == pytest.approx(100 * branch_mass_kg(2.0))
    assert twig_mass_per_area(0.1) == twig_mass_per_area(1.0), "nothing finer was weighed"


def test_a_scan_gets_the_twigs_below_the_radius_at_which_it_was_cut() -> None:
    tree = read()
    assert tree.report["qsm"]["min_radius_mm"] == 10
    found = loads(tree)
    assert found.report["added_twig_mass_kg"] == pytest.approx(100 * branch_mass_kg(2.0), rel=1e-3)
    assert found.mass_kg.sum() == pytest.approx(found.report["added_twig_mass_kg"])


def test_a_mesh_gets_the_twigs_below_its_finest_branches() -> None:
    tree = as_a_mesh(read())
    report = loads(tree).report
    assert report["trunk_diameter_cm"] == pytest.approx(BREAST_CM, rel=0.05)
    assert report["finest_branch_cm"] == pytest.approx(4.0, rel=0.15)
    area = np.pi / 4 * (report["trunk_diameter_cm"] / 100) ** 2
    expected = twig_mass_per_area(report["finest_branch_cm"]) * area
    assert report["added_twig_mass_kg"] == pytest.approx(expected)


def test_drawn_twigs_count_and_light_trees_get_few() -> None:
    whole = loads(read()).report["added_twig_mass_kg"]
    assert loads(read(), drawn_kg=5.0).report["added_twig_mass_kg"] == pytest.approx(whole - 5.0)
    assert loads(read(), drawn_kg=2 * whole).report["added_twig_mass_kg"] == 0
    capped = loads(read(), wood_kg=whole).report
    assert capped["twig_mass_capped"]
    assert capped["added_twig_mass_kg"] == pytest.approx(crown_mass.MOST_TWIG_MASS * whole)


def test_twigs_hang_where_leaves_do_or_along_the_limbs() -> None:
    leafy, bare = loads(read()), loads(read(add_leaves=False))
    assert bare.mass_kg.sum() == pytest.approx(leafy.mass_kg.sum())
    assert leafy.mass_kg[1] > leafy.mass_kg[0] > 0
    places: list[tuple[Floats, Floats]] = []
    tree = read(add_leaves=False)
    twig_loads(tree, partial(collected, places), PLENTY_KG)
    position, amount = places[0]
    on_trunk = np.hypot(position[:, 0], position[:, 2]) < 0.11
    assert amount[on_trunk].sum() < 0.2 * amount.sum(), "the trunk has most of the surface"


def test_a_pole_has_no_twigs() -> None:
    for tree in (read(add_leaves=False, bearing=2), as_a_mesh(read(bearing=2))):
        found = loads(tree)
        assert found.report == {"added_twig_mass_kg": 0.0}
        assert not found.mass_kg.any()


def test_wood_whose_branches_cannot_be_followed_gets_no_twigs(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any) -> None:
        raise ValueError("no branches")

    monkeypatch.setattr(crown_mass, "outline_of", fail)
    found = loads(as_a_mesh(read()))
    assert found.report == {"added_twig_mass_kg": 0.0}
    assert found.mass_kg.tolist() == [0.0, 0.0]


def test_the_outline_of_a_comb_has_its_limbs() -> None:
    tree = read(add_leaves=False)
    outline = outline_of(tree.wood_vertices_m, tree.wood_faces)
    assert int(outline.branch.max()) == 8
