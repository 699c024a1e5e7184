"""Whatever a confined child writes, its parent goes on, says that the file was the cause, and cleans up."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest
from galewood.sandbox import Limits, run_limited
from galewood.util import MeshError

from tests.precompute.sandbox.hostile_children import DEEDS

LIMITS = Limits(folder_bytes=64 << 20)
CODES = {"unlinked_files": "too-much-written"}
SUCCEED = ("deep_folders",)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("deed", sorted(DEEDS))
def test_what_a_child_writes_is_not_trusted(folder: Path, deed: str) -> None:
    arguments = {"deed": np.array(deed)}
    target = "tests.precompute.sandbox.hostile_children:misbehave"
    try:
        result = run_limited(target, arguments, LIMITS, what="The import")
    except MeshError as error:
        assert error.code == CODES.get(deed, "crashed")
    else:
        assert deed in SUCCEED and result == {}
    assert not list(folder.iterdir()), "what the child left"
