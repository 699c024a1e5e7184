"""Links of pages outside docs/ lead to files (`make docs` checks those inside); code in pages is tested."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"\]\(([^)\s]+)\)|<img src=\"([^\"]+)\"")


@pytest.mark.parametrize(
    "page",
    [
        "README.md", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "web/README.md",
        "assets/species/README.md", *(str(page.relative_to(ROOT)) for page in ROOT.glob("spec/**/*.md")),
    ],
)  # fmt: skip
def test_relative_links_lead_to_files(page: str) -> None:
    targets = [a or b for a, b in LINK.findall(ROOT.joinpath(page).read_text(encoding="utf-8"))]
    local = [target.partition("#")[0] for target in targets if not re.match(r"[a-z]+:|#", target)]
    assert [target for target in local if not (ROOT / page).parent.joinpath(target).exists()] == []


def test_every_page_is_in_the_navigation() -> None:
    nav = ROOT.joinpath("mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:")[2]
    pages = {str(path.relative_to(ROOT / "docs")) for path in (ROOT / "docs").rglob("*.md")}
    assert {page for page in pages if page not in nav} == set()


def test_the_pages_with_python_code_are_those_that_are_tested() -> None:
    pages = [ROOT / "README.md", *ROOT.glob("docs/**/*.md")]
    found = {str(page.relative_to(ROOT)) for page in pages if "```python" in page.read_text(encoding="utf-8")}
    assert found == {  # by test_snippets.py but for one
        "README.md",
        "docs/tutorial.md",
        "docs/how-to/export-mujoco.md",  # by tests/precompute/io/rigid/test_mjcf.py
        "docs/how-to/export-urdf.md",  # by tests/precompute/io/rigid/test_urdf.py
        "docs/how-to/motion-records.md",
        "docs/how-to/notebook.md",
        "docs/how-to/sway-envelope.md",  # by tests/precompute/check/test_envelope.py
        "docs/how-to/wind-measurements.md",
        "docs/how-to/wind-risk.md",
    }
