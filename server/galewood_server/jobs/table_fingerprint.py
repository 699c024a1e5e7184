"""Fingerprint of a table's inputs, by which outdated tables are recognised."""

from __future__ import annotations

import hashlib
import json
from importlib.metadata import version
from typing import Any

from galewood.constants import TABLE_VERSION
from galewood.versions import SAMPLING_VERSION

BUILD_VERSION = 5
"""Increase it when builds store additional files."""


def fingerprint(source_sha256: str, options: dict[str, Any], settings: dict[str, Any]) -> str:
    """SHA-256 of source, options, settings and versions; a table with another fingerprint is outdated."""
    versions = [version("galewood"), TABLE_VERSION, SAMPLING_VERSION, BUILD_VERSION]
    parts = json.dumps([source_sha256, options, settings, versions], sort_keys=True)
    return hashlib.sha256(parts.encode()).hexdigest()
