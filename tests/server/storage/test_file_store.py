"""Stored files: what is returned is what the name promises, whatever happens to the file meanwhile."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import pytest
from galewood_server.storage import FileStore, encoded_file
from galewood_server.storage.files import DamagedFileError

from tests.server.support.server_process import wait_until


def _damage_unseen(path: Path) -> None:
    """Replace a file's bytes; its size and time remain."""
    state = path.stat()
    path.write_bytes(b"\0" * state.st_size)
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))


def test_damaged_bytes_are_not_returned(tmp_path: Path) -> None:
    store = FileStore(tmp_path)
    name = store.put(b"a table")
    assert store.get(name) == b"a table"
    store.check(name)
    _damage_unseen(store.path(name))
    with pytest.raises(DamagedFileError):
        store.get(name)


def test_damaged_bytes_are_not_compressed(tmp_path: Path) -> None:
    store = FileStore(tmp_path / "tables")
    name = store.put(b"a table")
    store.check(name)
    whole = store.path(name).read_bytes()
    _damage_unseen(store.path(name))
    read: list[str] = []

    def get() -> bytes:
        try:
            return store.get(name)
        finally:
            read.append(name)

    assert encoded_file(tmp_path / "encoded", name, "gzip", get) is None
    wait_until(lambda: read)
    store.path(name).write_bytes(whole)
    # the attempt has failed, so a later request makes the copy; it holds the whole file
    copy = wait_until(lambda: encoded_file(tmp_path / "encoded", name, "gzip", get))
    assert gzip.decompress(copy.read_bytes()) == b"a table"
