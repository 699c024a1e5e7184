"""Where the library and the service find files that are no Python."""

from pathlib import Path

import pytest
from galewood import packaged
from galewood_server.settings import Settings

ROOT = Path(__file__).resolve().parents[2]


def test_a_checkout_uses_its_own_folders(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("GALEWOOD_PAGE_DIR", "GALEWOOD_SPECIES_DIR"):
        monkeypatch.delenv(name, raising=False)
    assert packaged.species_folder() == Settings().species_dir == ROOT / "assets/species"
    assert Settings().page_dir == ROOT / "web/dist"


def test_a_copy_in_the_package_comes_first(tmp_path: Path) -> None:
    copy = tmp_path / "data" / "species"
    copy.mkdir(parents=True)
    assert packaged.data_folder("species", "assets/species", tmp_path) == copy
