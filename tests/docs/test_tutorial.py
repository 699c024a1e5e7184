"""The Python code of docs/tutorial.md runs as it stands, on a small mesh and with quick build options."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path
from typing import Any

import galewood
import numpy as np
import pytest

from tests.precompute.shared_tets import TARGET_TETS, cache_with_tets, small_tree_glb

TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorial.md"
HEIGHT_M = 12.0
"""As in the tutorial, so that its tree is meshed already."""
QUICK: dict[str, Any] = {
    "target_tets": TARGET_TETS,
    "sampled_elements": 8,
    "frames": 16,
    "design_speed_m_s": 14.0,
    "reference_frames": 0,
}
"""As in tests/precompute/test_api.py, so that the runs are simulated once for both."""


pytestmark = pytest.mark.usefixtures("one_worker")


def python_blocks(page: str) -> list[tuple[int, str]]:
    """(line, code) of the page's Python blocks."""
    found = re.finditer(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    return [(page.count("\n", 0, match.start(1)), match[1]) for match in found]


def test_the_code_of_the_tutorial_runs(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    cache_with_tets(tmp_path / "cache", tmp_path_factory, HEIGHT_M, share_runs=True)
    monkeypatch.setenv("GALEWOOD_CACHE_DIR", str(tmp_path / "cache"))
    Path("mytree.glb").write_bytes(small_tree_glb())
    monkeypatch.setattr(galewood, "build", partial(galewood.build, **QUICK), raising=False)
    model = partial(galewood.Model, target_tets=TARGET_TETS)
    monkeypatch.setattr(galewood, "Model", model, raising=False)
    page = TUTORIAL.read_text(encoding="utf-8")
    blocks = python_blocks(page)
    assert len(blocks) >= 6
    names: dict[str, Any] = {"__name__": "tutorial"}
    for line, code in blocks:
        exec(compile("\n" * line + code, str(TUTORIAL), "exec"), names)
    assert Path("mytree.gwt").stat().st_size > 0
    assert np.isfinite(names["vertices_m"]).all()
    assert names["vertices_m"].shape[1] == 3
