"""The paper's experiments at their smallest extent, on a small tree."""

import json
from pathlib import Path

import numpy as np
import pytest
from galewood.check.paper import speed
from galewood.check.paper.gestures import first_maximum
from galewood.check.paper.plan import Notes, code_hash, full_plan, quick_plan
from galewood.check.paper.run import run_paper
from galewood.check.paper.text import table
from galewood.packaged import species_folder
from galewood.pipeline.stages import BuiltinMesh

from tests.precompute.fixtures.shared_tets import cache_with_tets, small_tree_glb

pytestmark = pytest.mark.usefixtures("one_worker")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("paper")
    (path / "maple.glb").write_bytes(small_tree_glb())
    cache_with_tets(path / "cache", tmp_path_factory)
    return path


def test_the_experiments_are_those_of_the_species_in_the_paper(tmp_path: Path) -> None:
    species = ("poplar", "maple", "apricot")
    trees = {mesh.name for mesh in full_plan(species_folder(), tmp_path).meshes}
    assert trees == {*species, *(f"{one}-forest" for one in species)}


def test_the_page_is_written_the_search_is_exact_and_only_timings_are_repeated(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = quick_plan(BuiltinMesh("maple", folder / "maple.glb", {"species": "maple"}), folder / "cache")
    fractions: list[float] = []
    figures = run_paper(plan, folder / "paper.md", lambda fraction, message: fractions.append(fraction))
    assert fractions[-1] == 1.0
    assert all(0 <= fraction <= 1 for fraction in fractions)
    maple = figures["trees"]["maple"]
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
    cached = sorted((folder / "cache" / "paper").iterdir())
    before = [path.stat().st_mtime_ns for path in cached]
    monkeypatch.setattr(speed, "step_us", lambda *_: 1.25)
    monkeypatch.setattr(speed, "exhaustive_us", lambda *_: 2.5)
    monkeypatch.setattr(speed, "_forest_ms", lambda *_: (3.75, 5.0))
    again = run_paper(plan, folder / "paper.md", lambda fraction, message: None)
    assert json.dumps(again["trees"]["maple"]["winds"]) == json.dumps(maple["winds"])
    assert sorted((folder / "cache" / "paper").iterdir()) == cached
    assert [path.stat().st_mtime_ns for path in cached] == before
    for count, row in again["trees"]["maple"]["elements"].items():
        times = {name: row.pop(name) for name in sorted(row) if name.endswith("_us")}
        assert times == {
            "exhaustive_us": 2.5,
            "modal_single_us": 1.25,
            "modal_us": 1.25,
            "paper_single_us": 1.25,
            "paper_us": 1.25,
        }
        assert row.items() <= maple["elements"][count].items()
    times = {"wind_ms": 3.75, "modal_ms": 5.0, "paper_ms": 5.0}
    assert again["forests"] == {"20": times, "50": times}


def test_the_code_hash_covers_the_packages_that_the_figures_depend_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    read: list[str] = []
    original = Path.read_bytes

    def record(path: Path) -> bytes:
        read.append(path.as_posix())
        return original(path)

    monkeypatch.setattr(Path, "read_bytes", record)
    code_hash()
    for name in (
        "motion/modal/step.py",
        "player/paper_search.py",
        "solid/fem/dynamics.py",
        "check/paper/search.py",
    ):
        assert any(path.endswith(f"galewood/{name}") for path in read), name
    assert not any(path.endswith(("paper/text.py", "evaluation/plot.py")) for path in read)


def test_a_result_is_computed_once_for_what_it_depends_on(tmp_path: Path) -> None:
    notes, made = Notes(quick_plan(BuiltinMesh("none", tmp_path, {}), tmp_path)), []
    for depends in ("a", "a", "b"):
        assert notes.kept("x", depends, lambda: made.append(1) or {"made": len(made)})["made"] == len(made)
    assert len(made) == 2


def test_the_first_maximum_is_the_frame_before_the_sway_first_falls() -> None:
    assert first_maximum(np.array([0.1, 0.4, 0.7, 0.6, 0.9])) == 3
    assert first_maximum(np.array([0.1, 0.2, 0.3])) == 3


def test_markdown_tables() -> None:
    assert table(["a", "b"], [["1", "2"]]) == "| a | b |\n| --- | ---: |\n| 1 | 2 |"
