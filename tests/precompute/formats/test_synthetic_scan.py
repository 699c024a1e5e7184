"""The example that grows the cylinders of a tree: its files are accepted, and have what was asked for."""

import runpy
import sys
from pathlib import Path

import pytest
from galewood.options import ImportRequest
from galewood.tree.importer import read_tree

SCRIPT = Path(__file__).parents[3] / "docs" / "examples" / "synthetic_scan.py"
TREES = {
    "slender": {"height-m": 24, "dbh-cm": 17, "cylinders": 900, "crown-base": 0.6},
    "leaning": {"height-m": 12, "dbh-cm": 22, "cylinders": 260, "lean": 0.5},
    "forked": {"height-m": 16, "dbh-cm": 35, "cylinders": 600, "fork": 0.4},
    "large": {"height-m": 22, "dbh-cm": 55, "cylinders": 8000},
}


@pytest.mark.parametrize("name", TREES)
def test_a_grown_tree_has_the_size_that_was_asked_for(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = TREES[name]
    out = tmp_path / "tree.csv"
    options = [word for key, value in asked.items() for word in (f"--{key}", str(value))]
    monkeypatch.setattr(sys, "argv", [str(SCRIPT), *options, "--out", str(out)])
    runpy.run_path(str(SCRIPT), run_name="__main__")
    qsm = read_tree(out.read_bytes(), out.name, ImportRequest()).report["qsm"]
    assert qsm["cylinders"] == asked["cylinders"]
    assert qsm["height_m"] == pytest.approx(asked["height-m"], rel=0.07)
    assert qsm["dbh_cm"] == pytest.approx(asked["dbh-cm"], rel=0.05)
    assert qsm["dropped"]["loose_cylinders"] == 0
