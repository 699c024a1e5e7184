"""Atomic file writes."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from galewood.util.atomic_file import write_arrays, write_atomically


def test_failed_write_leaves_only_the_old_file(tmp_path: Path) -> None:
    target = tmp_path / "folder" / "file"
    write_atomically(target, b"old")
    with pytest.raises(TypeError):
        write_atomically(target, "no bytes")  # pyright: ignore[reportArgumentType]
    assert target.read_bytes() == b"old"
    assert list(target.parent.iterdir()) == [target]


def test_concurrent_writes_leave_one_complete_file(tmp_path: Path) -> None:
    target = tmp_path / "file"
    contents = [bytes([k]) * 100_000 for k in range(16)]
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda content: write_atomically(target, content), contents))
    assert target.read_bytes() in contents
    assert list(tmp_path.iterdir()) == [target]


def test_arrays_survive_a_round_trip(tmp_path: Path) -> None:
    write_arrays(tmp_path / "a.npz", x=np.arange(3), y=np.eye(2))
    with np.load(tmp_path / "a.npz", allow_pickle=False) as found:
        assert found["x"].tolist() == [0, 1, 2]
        assert np.array_equal(found["y"], np.eye(2))
