"""Where the service finds files that are no Python."""

from pathlib import Path

import pytest
from galewood_server import settings


def test_a_checkout_uses_its_own_folders() -> None:
    root = Path(__file__).resolve().parents[2]
    assert settings.data_folder("species", "assets/species") == root / "assets/species"
    assert settings.data_folder("page", "web/dist") == root / "web/dist"


def test_a_copy_in_the_package_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(settings, "PACKAGE", tmp_path)
    copy = tmp_path / "data" / "species"
    copy.mkdir(parents=True)
    assert settings.data_folder("species", "assets/species") == copy
