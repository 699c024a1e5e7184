"""Versions of intermediate results, by which outdated ones are recognised without loading their packages."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import version
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
SAMPLING_VERSION = 6
"""Part of every training run's hash; increase it when the recorded data changes."""


@cache
def sources_hash() -> str:
    """Hash of the sources of this package: part of the name of what another version would make differently.

    Nobody has to remember to change it; it also changes where the result would not.
    """
    digest = hashlib.sha256(version("galewood").encode())
    for file in sorted(PACKAGE.rglob("*.py")):
        digest.update(f"{file.relative_to(PACKAGE)}\n".encode() + file.read_bytes())
    return digest.hexdigest()
