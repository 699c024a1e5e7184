"""Figures of docs/how-to/export-mujoco.md and export-urdf.md are what their script measures, for one tree."""

from __future__ import annotations

import importlib.util
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from galewood.table import decode

from tests.docs.test_figures import ROOT, found, rows_of

NAME = "apricot-forest"
MUJOCO_PAGE, URDF_PAGE = "docs/how-to/export-mujoco.md", "docs/how-to/export-urdf.md"
MOST_POINTS = 0.7
"""By which percentages may differ."""
STEP_CELL = "ms"
"""In cells of times, which depend on the machine."""


def example(name: str) -> ModuleType:
    """A script of docs/examples as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs/examples" / f"{name}.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # where dataclasses look their annotations up
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def figures() -> ModuleType:
    return example("mujoco_figures")


@pytest.mark.parametrize(
    ("page", "head", "measured"),
    [
        (MUJOCO_PAGE, "tree | bodies", "row"),
        pytest.param(MUJOCO_PAGE, "tree | wind", "gust_rows", marks=pytest.mark.release),
        (URDF_PAGE, "tree | bodies", "urdf_row"),
    ],
)
def test_the_rows_are_what_is_measured(figures: ModuleType, page: str, head: str, measured: str) -> None:
    measure: Callable[[str], str] = getattr(figures, measured)
    own = [[cell.strip() for cell in line.split("|")[1:-1]] for line in measure(NAME).splitlines()]
    said = [row for row in rows_of(page, head) if row[0] == NAME]
    assert len(own) == len(said)
    for mine, theirs in zip(own, said, strict=True):
        print(mine)
        assert len(mine) == len(theirs)
        for cell, other in zip(mine, theirs, strict=True):
            assert cell.endswith(STEP_CELL) or same(cell, other), f"measured {cell}, said {other}"


def same(cell: str, other: str) -> bool:
    """Whether two cells differ in the last place of their numbers at most: processors round differently.

    Percentages may differ by more: the fit of the stiffnesses ends elsewhere on other processors.
    """
    pattern = r"\d+(?:\.\d+)?"
    if re.sub(pattern, "", cell) != re.sub(pattern, "", other):
        return False
    pairs = zip(re.findall(pattern, cell), re.findall(pattern, other), strict=True)
    loose = MOST_POINTS if "%" in cell else 0.0
    return all(
        abs(float(a) - float(b)) <= 1.01 * 10.0 ** -len(b.partition(".")[2]) + 0.02 * float(b) + loose
        for a, b in pairs
    )


def test_the_released_tree_is_as_near_to_the_table_as_the_caption_says() -> None:
    plots = example("live_plots")
    table, glb = decode(plots.TREE_PATH.read_bytes()), Path(plots.TREE_PATH).with_suffix(".glb").read_bytes()
    rest_m = plots.GltfFile(glb, table).rest_m()
    top = plots.top_of(table, rest_m)
    _, moved, given = plots.in_mujoco(table, glb, rest_m, top)
    percent = 100 / float(table.metadata["height_m"])
    apart = percent * np.linalg.norm(moved - given, axis=1)
    largest, rms = found(
        r"apart by at most ([\d.]+) % of the height, in the first moment.*?RMS ([\d.]+) %", MUJOCO_PAGE
    )
    assert apart.max() == pytest.approx(float(largest), rel=0.05)
    assert np.sqrt(np.square(apart).mean()) == pytest.approx(float(rms), abs=0.0006)
