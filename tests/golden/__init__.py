"""Writes the golden files: numbers that the tests of every language read."""

from pathlib import Path

GOLDEN_FOLDER = Path(__file__).parents[2] / "spec" / "golden"
