"""Arguments of the Python API of another type are refused with what to give instead."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import galewood
import pytest

SHIPPED = Path(__file__).parents[3] / "assets/species/shipped/apricot-forest.table"
GALEWOOD: Any = galewood  # type checkers would refuse these calls too


def loaded() -> galewood.MotionTable:
    return galewood.load(SHIPPED)


def tree() -> Any:
    return galewood.Tree(cast(Any, SimpleNamespace(species="apricot")), b"")


NEEDS_TREE = r"galewood\.Tree, not 'x': .*galewood\.read"
NEEDS_TABLE = r"galewood\.MotionTable, not 'x': .*load"
NEEDS_WIND, NEEDS_WOOD = r"galewood\.Wind, not 'breeze': .*PRESETS", r"galewood\.Wood, not 'oak': .*SPECIES"
WIND = galewood.Wind()
CALLS: dict[str, tuple[Callable[[], object], str]] = {
    "Forest": (lambda: GALEWOOD.Forest("x", [[0, 0]], WIND), NEEDS_TABLE),
    "Forest of names": (
        lambda: GALEWOOD.Forest(["x"], [[0, 0]], WIND),
        rf"tables\[0\] .*{NEEDS_TABLE}",
    ),
    "Forest of one": (
        lambda: GALEWOOD.Forest(loaded(), [[0, 0]], WIND),
        r"a list of tables: \[table\]",
    ),
    "Forest in a name": (lambda: GALEWOOD.Forest([loaded()], [[0, 0]], "breeze"), NEEDS_WIND),
    "export_tree": (lambda: GALEWOOD.export_tree("x", to="glb", out="never"), NEEDS_TABLE),
    "sway_envelope": (lambda: GALEWOOD.sway_envelope("x", wind_m_s=5.0), NEEDS_TABLE),
    "evaluate": (lambda: GALEWOOD.evaluate("x"), NEEDS_TABLE),
    "evaluate in": (lambda: GALEWOOD.evaluate(loaded(), {"a": "breeze"}), rf"winds\['a'\] .*{NEEDS_WIND}"),
    "simulated_motion": (lambda: GALEWOOD.simulated_motion("x", "record.csv"), NEEDS_TABLE),
    "save": (lambda: GALEWOOD.save("x", "never.gwt"), NEEDS_TABLE),
    "Model": (lambda: GALEWOOD.Model("x"), NEEDS_TREE),
    "Model of": (lambda: GALEWOOD.Model(tree(), wood="oak"), NEEDS_WOOD),
    "build": (lambda: GALEWOOD.build("x"), NEEDS_TREE),
    "calibrate": (lambda: GALEWOOD.calibrate("x", "record.csv"), NEEDS_TREE),
    "strain": (lambda: GALEWOOD.strain("x", wind_m_s=10.0), NEEDS_TREE),
    "strain of": (lambda: GALEWOOD.strain(tree(), wind_m_s=10.0, wood="oak"), NEEDS_WOOD),
    "gust_strain": (lambda: GALEWOOD.gust_strain("x"), NEEDS_TREE),
    "gust_strain in": (lambda: GALEWOOD.gust_strain(tree(), "breeze"), NEEDS_WIND),
    "critical_wind": (lambda: GALEWOOD.critical_wind("x"), NEEDS_TREE),
}


@pytest.mark.parametrize("name", CALLS)
def test_another_type_is_refused_with_what_to_give(name: str) -> None:
    call, message = CALLS[name]
    with pytest.raises(TypeError, match=message):
        call()


def test_the_wind_of_a_forest_stays_one() -> None:
    forest: Any = galewood.Forest([loaded()], [[0.0, 0.0]], WIND)
    with pytest.raises(TypeError, match=NEEDS_WIND):
        forest.wind = "breeze"
    assert isinstance(forest.wind, galewood.Wind)
