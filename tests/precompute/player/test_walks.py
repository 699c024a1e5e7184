"""The golden steps match this implementation (the twin's test is tests/web/player/core/walks.test.ts)."""

import json

import pytest
from galewood.table.format import decode

from tests.golden import GOLDEN_FOLDER
from tests.golden.make_walks import WINDS, step_digests


@pytest.mark.parametrize("index", range(len(WINDS)))
def test_matches_the_golden_records_and_poses_under_every_wind(index: int) -> None:
    table = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    golden = json.loads((GOLDEN_FOLDER / "walks.json").read_text())["walks"][index]
    found = step_digests(table, WINDS[index])
    assert found["records"] == golden["records"]
    for row, expected in zip(found["poses"], golden["poses"], strict=True):
        assert row == pytest.approx(expected, abs=1e-5 * float(table.metadata["height_m"]))
