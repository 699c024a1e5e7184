"""What a table was computed from, as one hash: an outdated table is recognised by it."""

from __future__ import annotations

import hashlib
import json
from importlib.metadata import version
from typing import Any

from galewood.sampling import SAMPLING_VERSION
from galewood.table import VERSION

BUILD_VERSION = 2
"""Raise it when builds store more than they did (2: the model)."""


def fingerprint(source_sha256: str, options: dict[str, Any], settings: dict[str, Any]) -> str:
    """Hash of all that a table depends on: a built-in species is computed again when it changes."""
    versions = [version("galewood"), VERSION, SAMPLING_VERSION, BUILD_VERSION]
    parts = json.dumps([source_sha256, options, settings, versions], sort_keys=True)
    return hashlib.sha256(parts.encode()).hexdigest()
