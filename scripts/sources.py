"""The source files of the project, for scripts/structure.py."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

SOURCE_FOLDERS = ("precompute", "server", "scripts", "tests", "spec", "docs", "web", "tools")
SKIPPED_FOLDERS = {"node_modules", "dist", "__pycache__"}
TEST_OUTPUT = "tests/e2e/results"
TYPESCRIPT_SUFFIXES = {".ts", ".tsx", ".js", ".mjs"}
PYTHON_SCRIPT = b"#!/usr/bin/env python3"
"""First line of a script without a suffix."""


def sources(root: Path) -> Iterator[Path]:
    """The source files below the folders of the project, without what is installed or built there."""
    for name in SOURCE_FOLDERS:
        for folder, folders, files in os.walk(root / name):
            inside = Path(folder).relative_to(root)
            folders[:] = sorted(
                {one for one in folders if (inside / one).as_posix() != TEST_OUTPUT} - SKIPPED_FOLDERS
            )
            paths = [Path(folder, file) for file in sorted(files)]
            yield from (path for path in paths if path.suffix in TYPESCRIPT_SUFFIXES or is_python(path))


def is_python(path: Path) -> bool:
    """Whether a file is a Python module, or a Python script without a suffix."""
    return path.suffix == ".py" or (path.suffix == "" and path.read_bytes().startswith(PYTHON_SCRIPT))
