"""Temporary files are below the data folder, so that the next server finds what a killed one left behind."""

from __future__ import annotations

import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from galewood.sandbox import remove_folder


@contextmanager
def temporary_files_in(folder: Path) -> Generator[None]:
    """Empty a folder, and have this process create its temporary files there while the block runs.

    The caller must hold the lock of the data folder. Child processes get the folder by
    `Settings.environment`; those of a killed server have ended (galewood.util.guard).
    """
    remove_folder(folder)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    before, tempfile.tempdir = tempfile.tempdir, str(folder)
    try:
        yield
    finally:
        tempfile.tempdir = before
        remove_folder(folder)
