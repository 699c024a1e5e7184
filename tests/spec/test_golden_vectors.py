"""The list of golden files is complete; Python computes those again that none of its other tests reads."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from galewood.table import decode, decode_compliance

from tests.golden import GOLDEN_FOLDER
from tests.golden.make import sway_steps, wind_vectors
from tests.golden.make_drawn import drawn_vectors
from tests.golden.make_pull import hand, responses
from tests.golden.make_reach import reach_vectors

TESTS = Path(__file__).parents[1]
LIST = (GOLDEN_FOLDER / "README.md").read_text(encoding="utf-8")


def golden(name: str) -> Any:
    return json.loads((GOLDEN_FOLDER / name).read_text(encoding="utf-8"))


def assert_close(found: Any, expected: Any, tolerance: float = 1e-6) -> None:
    """Equal texts and shapes, and numbers that differ by less than a share of the largest in their list."""
    if isinstance(expected, dict):
        assert set(found) == set(expected)
        for name in expected:
            assert_close(found[name], expected[name], tolerance)
    elif isinstance(expected, list) and any(isinstance(part, dict) for part in expected):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            assert_close(one, other, tolerance)
    elif isinstance(expected, str):
        assert found == expected
    else:
        numbers = np.array(expected, np.float64)
        np.testing.assert_allclose(found, numbers, rtol=0, atol=tolerance * max(np.abs(numbers).max(), 1e-9))


def test_every_file_is_in_both_tables_of_the_list() -> None:
    first, second = LIST.split("| test vectors |")
    for path in GOLDEN_FOLDER.rglob("*.*"):
        name = path.relative_to(GOLDEN_FOLDER).as_posix()
        listed = "wire/*.bin" if path.suffix == ".bin" else name
        assert name == "README.md" or (f"`{listed}`" in first and f"`{listed}`" in second), name


def test_every_test_of_the_list_exists() -> None:
    named = set(re.findall(r"`([\w.]+\.(?:py|ts))`", LIST))
    folders = [TESTS / folder for folder in ("precompute", "server", "spec", "web")]
    assert named and named <= {path.name for folder in folders for path in folder.rglob("*.*")}


def test_pressures_of_cosine_winds() -> None:
    assert_close(wind_vectors(), golden("wind.json"))


def test_drawn_vertices() -> None:
    assert_close(drawn_vectors(), golden("drawn.json"))


def test_reach_in_gusts() -> None:
    assert_close(reach_vectors(), golden("reach.json"), 1e-5)


def test_responses_to_pulls() -> None:
    table = decode((GOLDEN_FOLDER / "pole-table.safetensors").read_bytes())
    compliance = decode_compliance((GOLDEN_FOLDER / "pole-compliance.safetensors").read_bytes())
    found = {"responses": responses(table, compliance), "hand": hand(table, compliance)}
    assert_close(found, golden("pull.json"))


def test_sway_of_the_first_table_of_a_build() -> None:
    table = decode((GOLDEN_FOLDER / "pole-linear.safetensors").read_bytes())
    assert_close(sway_steps(table), golden("sway-linear.json"))
