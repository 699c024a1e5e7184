"""Versions of intermediate results, by which outdated ones are recognised without loading their packages."""

from __future__ import annotations

SAMPLING_VERSION = 6
"""Part of every training run's hash; increase it when the recorded data changes."""
