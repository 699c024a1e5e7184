"""Where files that are no Python lie, in a wheel and in a checkout of the repository."""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
REPOSITORY = PACKAGE.parents[1]


def data_folder(packaged: str, checkout: str, package: Path = PACKAGE) -> Path:
    """In a wheel the copy below ``package`` (setup.py); in a checkout the folder that it is a copy of."""
    copy = package / "data" / packaged
    return copy if copy.is_dir() else REPOSITORY / checkout


def species_folder() -> Path:
    """The folder of the built-in trees: species.json, meshes, and ``shipped`` with their tables."""
    return data_folder("species", "assets/species")
