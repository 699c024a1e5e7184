"""The paper's experiments at their smallest extent, on a small tree: what must agree agrees."""

import json
from pathlib import Path

import numpy as np
import pytest
from galewood.paper.gestures import first_maximum
from galewood.paper.plan import Notes, quick_plan
from galewood.paper.run import run_paper
from galewood.paper.text import table

from tests.precompute.shared_tets import cache_with_tets, small_tree_glb


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("paper")
    (path / "maple.glb").write_bytes(small_tree_glb())
    cache_with_tets(path / "cache", tmp_path_factory)
    return path


def test_the_whole_page_is_written_and_the_search_is_exact(folder: Path) -> None:
    plan = quick_plan({"maple": folder / "maple.glb"}, folder / "cache")
    told: list[float] = []
    figures = run_paper(plan, folder / "paper.md", lambda fraction, message: told.append(fraction))
    assert told[-1] == 1.0
    assert all(0 <= fraction <= 1 for fraction in told)
    maple = figures["species"]["maple"]
    assert maple["search"] == {**maple["search"], "queries": 200, "differences": 0}
    assert maple["gestures"]["hausdorff"]["modal"]["60"] < maple["gestures"]["sway"]["60"]
    assert set(maple["elements"]) == {"6", "12"}
    assert set(figures["forests"]) == {"20", "50"}
    text = (folder / "paper.md").read_text()
    for picture in (
        "winds.svg",
        "elements.svg",
        "gestures-maple.png",
        "errors-maple.png",
        "directions-maple.png",
    ):
        assert f"(paper/{picture})" in text
        assert 500 < (folder / "paper" / picture).stat().st_size < 150_000, picture
    assert "nan" not in text
    kept = sorted((folder / "cache" / "paper").glob("*.json"))
    before = [path.stat().st_mtime_ns for path in kept]
    again = run_paper(plan, folder / "paper.md", lambda fraction, message: None)
    assert json.dumps(again["species"]["maple"]["winds"]) == json.dumps(maple["winds"])
    assert [path.stat().st_mtime_ns for path in kept] == before


def test_a_figure_is_made_once_for_what_it_depends_on(tmp_path: Path) -> None:
    notes, made = Notes(quick_plan({}, tmp_path)), []
    for depends in ("a", "a", "b"):
        assert notes.kept("x", depends, lambda: made.append(1) or {"made": len(made)})["made"] == len(made)
    assert len(made) == 2


def test_the_first_maximum_is_where_the_tree_first_turns_back() -> None:
    assert first_maximum(np.array([0.1, 0.4, 0.7, 0.6, 0.9])) == 3
    assert first_maximum(np.array([0.1, 0.2, 0.3])) == 3


def test_a_table_in_the_text_has_its_columns() -> None:
    assert table(["a", "b"], [["1", "2"]]) == "| a | b |\n| --- | ---: |\n| 1 | 2 |"
