"""Versions of intermediate results, by which outdated ones are recognised without loading their packages."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import version
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
IMPORTING = ("formats", "tree", "wood", "options", "util", "constants.py")
"""Sources on which it depends what a mesh file is read as."""
SAMPLING_VERSION = 6
"""Part of every training run's hash; increase it when the recorded data changes."""


@cache
def importer_version() -> str:
    """The version of the mesh import: a hash of its sources, so that nobody has to remember to change it."""
    digest = hashlib.sha256(version("galewood").encode())
    for path in (PACKAGE / name for name in IMPORTING):
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            digest.update(f"{file.relative_to(PACKAGE)}\n".encode() + file.read_bytes())
    return digest.hexdigest()
