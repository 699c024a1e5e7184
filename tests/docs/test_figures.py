"""Figures in README.md and docs/index.md equal those of the files and of the tests that they come from."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from galewood.pipeline.tables import BuildOptions

from tests.precompute.check.accuracy import ORDINARY, STATED_LIMIT
from tests.precompute.check.test_species_accuracy import BENDING_SPEED_M_S

ROOT = Path(__file__).parents[2]
SPECIES_FOLDER = ROOT / "assets" / "species"
COUNTS = {"three": 3, "twelve": 12, "24": 24}


def text_of(page: str) -> str:
    """A page with its lines joined."""
    return " ".join(ROOT.joinpath(page).read_text(encoding="utf-8").split())


def found(pattern: str, page: str) -> tuple[str, ...]:
    """What the groups of a pattern match in a page, which must have it."""
    match = re.search(pattern, text_of(page))
    assert match, f"{page} does not say {pattern!r} any more: change this test with it"
    return match.groups()


@pytest.mark.parametrize("page", ["README.md", "docs/index.md"])
def test_a_table_is_smaller_than_half_a_megabyte(page: str) -> None:
    assert "lookup table of less than half a megabyte" in text_of(page)
    tables = sorted(SPECIES_FOLDER.glob("shipped/*.table"))
    assert tables
    assert {path.name: path.stat().st_size for path in tables if path.stat().st_size >= 500_000} == {}


@pytest.mark.parametrize("page", ["README.md", "docs/index.md"])
def test_the_built_in_trees_are_counted_and_named(page: str) -> None:
    count, names = found(r"the (\w+) built-in trees \(([^)]*)\)", page)
    trees = json.loads((SPECIES_FOLDER / "species.json").read_text(encoding="utf-8"))
    assert COUNTS[count] == len(trees)
    assert set(names.split(", ")) == {tree["species"] for tree in trees}


def rows_of(page: str, head: str) -> list[list[str]]:
    """The rows of the table of a page whose head begins so; each row as its cells."""
    blocks = ROOT.joinpath(page).read_text(encoding="utf-8").split(f"\n| {head}")
    assert len(blocks) == 2, f"{page} has no table, or several, with the head {head!r}"
    lines = blocks[1].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]


def accuracy_table() -> tuple[list[str], list[list[str]]]:
    """Head and rows of the measured errors in docs/physics.md."""
    page = ROOT.joinpath("docs/physics.md").read_text(encoding="utf-8")
    block = page.split("<!-- accuracy:")[1].split("<!-- end of accuracy -->")[0]
    head, _, *rows = ([cell.strip() for cell in line.split("|")[1:-1]] for line in block.splitlines()[1:])
    return head, rows


def test_the_stated_error_in_gusts_is_the_measured_one_and_comes_first() -> None:
    pattern = r"In gusts that differ within the crown, the (\w+) built-in trees are off by (\d+) to (\d+) %"
    count, least, most = found(pattern, "README.md")
    head, rows = accuracy_table()
    errors: dict[str, list[int]] = {}
    tree = ""
    for row in rows:
        tree = row[0] or tree
        errors.setdefault(tree, [])
        if error := row[head.index("error, RMS")]:
            errors[tree].append(int(error.removesuffix(" %")))
    assert COUNTS[count] == len(errors)
    assert all(len(found) == 4 for found in errors.values())
    every = [error for found in errors.values() for error in found]
    assert (int(least), int(most)) == (min(every), max(every))
    text = text_of("README.md")
    assert text.index("In gusts that differ") < text.index("in winds that are the same over the whole crown")


def test_the_stated_error_in_uniform_winds_is_the_limit_of_the_accuracy_tests() -> None:
    pattern = (
        r"with peaks of (\d+) m/s, their errors are below ([\d.]+) % of the height "
        r"\(poplar, maple and apricot: ([\d.]+) %\)"
    )
    speed_m_s, percent, percent_of_three = found(pattern, "README.md")
    assert float(percent_of_three) == pytest.approx(100 * STATED_LIMIT)
    head, rows = accuracy_table()
    cells = {row[0]: row[head.index("uniform wind: largest")] for row in rows if row[0]}
    measured = {tree: float(cell.removesuffix(" %")) for tree, cell in cells.items()}
    assert float(percent) - 0.1 <= max(measured.values()) < float(percent)
    three = [error for tree, error in measured.items() if tree.split("-")[0] in BENDING_SPEED_M_S]
    assert len(three) == 6
    assert float(percent_of_three) - 0.1 <= max(three) < float(percent_of_three)
    assert float(speed_m_s) == pytest.approx(ORDINARY * BuildOptions().design_speed_m_s, abs=0.5)


def test_the_stated_time_of_a_step_is_the_measured_one() -> None:
    (time,) = found(r"Play 10,000 trees, each moving on its own, in ([\d to]+ ms) per step", "README.md")
    record = "docs/design/0010-kernel.md"
    assert found(r"WebAssembly, 24 oscillators[^|]*\| ([\d to]+ ms) \|", record) == (time,)


@pytest.mark.parametrize(
    "pattern",
    [r"(\d+ to \d+) %\s+of\s+\[?their sway", r"(?:below|less than) ([\d.]+) % of the(?:ir)? height"],
)
def test_the_about_dialog_states_the_errors_of_the_readme(pattern: str) -> None:
    about = " ".join(re.sub(r'" \+\s*"', "", text_of("web/src/page/controls/about.ts")).split())
    said = re.search(pattern, about)
    assert said and said.groups() == found(pattern, "README.md")


MUJOCO_PAGE, URDF_PAGE = "docs/how-to/export-mujoco.md", "docs/how-to/export-urdf.md"


def numbers(cell: str) -> list[float]:
    """The numbers in a cell."""
    return [float(number) for number in re.findall(r"\d+(?:\.\d+)?", cell)]


def test_what_is_missed_in_mujoco_follows_from_its_table() -> None:
    """The rows themselves are held against measurements in test_mujoco_figures.py."""
    rows = rows_of(MUJOCO_PAGE, "tree | bodies")
    shares = [numbers(row[column])[2] / 50 for row in rows for column in (4, 5)]
    assert "of all points a quarter are beyond 5 %" in text_of(MUJOCO_PAGE)
    assert sum(shares) / len(shares) == pytest.approx(0.75, abs=0.03)
    (percent,) = found(r"The mean sway is up to (\d+) % less than the table's", MUJOCO_PAGE)
    means = [numbers(row[6])[:2] for row in rows]
    assert max(1 - own / given for own, given in means) == pytest.approx(float(percent) / 100, abs=0.01)
    (percent,) = found(r"RMS sway along the wind is up to (\d+) % less than the table's", MUJOCO_PAGE)
    sways = [numbers(row[2]) for row in rows_of(MUJOCO_PAGE, "tree | wind")]
    assert max(1 - own / given for own, given in sways) == pytest.approx(float(percent) / 100, abs=0.01)


def test_the_pages_of_rigid_bodies_and_the_table_of_all_kinds_agree() -> None:
    own, urdf = rows_of(MUJOCO_PAGE, "tree | bodies"), rows_of(URDF_PAGE, "tree | bodies")
    assert [row[:2] for row in own] == [row[:2] for row in urdf]
    sizes = {row[0]: row[1] for row in rows_of("docs/how-to/exports.md", "`--to` | size")}
    for kind, rows in (("`mjcf`", own), ("`urdf`", urdf)):
        (poplar,) = (row for row in rows if row[0] == "poplar")
        assert sizes[kind] == poplar[-1]
