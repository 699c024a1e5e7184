"""The cache key of a long run: it covers the settings, the table, the model, the modes and the code."""

import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import galewood.motion
import galewood.player
import numpy as np
import pytest
from galewood.check.evaluation.long_run import long_run_key
from galewood.check.evaluation.source import Source
from galewood.table.format import Table, decode

from tests.golden import GOLDEN_FOLDER

TABLE = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
MODEL_ARRAYS = ("nodes_m", "elements", "blocks", "mass_kg", "drag_area_m2", "fixed", "gravity_n")


def source(mass_kg: float = 1.0, mode: float = 1.0, strain_m: float | None = None) -> Source:
    """A source with only the attributes that the key reads."""
    arrays = dict.fromkeys(MODEL_ARRAYS, np.zeros(3)) | {"mass_kg": np.full(3, mass_kg)}
    absent = dict.fromkeys(("exposed_area_m2", "wind_profile", "foundation_n_m"))
    strain = None if strain_m is None else np.full((1, 4, 3), strain_m)
    numbers = {"alpha": 0.1, "beta": 0.01, "streamlined_exponent": 1.3}
    model = SimpleNamespace(settings="settings", strain_m=strain, **numbers, **arrays, **absent)
    return cast(
        Source, SimpleNamespace(model=model, subspace=SimpleNamespace(basis=np.full((3, 3, 1), mode)))
    )


def key(table: Table = TABLE, of: Source | None = None, **settings: Any) -> str:
    chosen: dict[str, Any] = {"frames": 1500, "sway": 0.1, "seed": 1, **settings}
    return long_run_key(table, of or source(), **chosen)


def test_the_key_is_reproducible() -> None:
    assert key() == key(decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes()))


@pytest.mark.parametrize("setting", [{"frames": 3000}, {"sway": 0.2}, {"seed": 2}])
def test_the_key_covers_the_settings(setting: dict[str, Any]) -> None:
    assert key(**setting) != key()


def test_the_key_covers_the_model_and_the_modes() -> None:
    others = (source(mass_kg=2.0), source(mode=2.0), source(strain_m=0.0), source(strain_m=1e-3))
    assert len({key(), *(key(of=other) for other in others)}) == 5


@pytest.mark.parametrize("field", ["modal_force", "mode_scale", "node_basis"])
def test_the_key_covers_the_tensors_of_the_table(field: str) -> None:
    values = getattr(TABLE, field).copy()
    values.flat[-1] += 1
    assert key(replace(TABLE, **{field: values})) != key()


@pytest.mark.parametrize("field", ["dq", "pressure_pa"])
def test_the_key_covers_the_records_of_the_table(field: str) -> None:
    values = getattr(TABLE.records, field).copy()
    values.flat[-1] += 1
    assert key(replace(TABLE, paper=replace(TABLE.records, **{field: values}))) != key()


def test_the_key_covers_the_search_parameters_of_the_table() -> None:
    metadata = TABLE.records.metadata
    eased = metadata | {"pose_easing": 0.5 * metadata["pose_easing"]}
    assert key(replace(TABLE, paper=replace(TABLE.records, metadata=eased))) != key()


@pytest.mark.parametrize("package", [galewood.motion, galewood.player])
def test_the_key_covers_the_stepping_code(
    package: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = key()
    copy = tmp_path / "package"
    shutil.copytree(package.__path__[0], copy)
    monkeypatch.setattr(package, "__path__", [str(copy)])
    assert key() == before
    changed = next(path for path in sorted(copy.rglob("*.py")) if path.name != "__init__.py")
    changed.write_text(changed.read_text() + "\nCHANGED = True\n")
    assert key() != before
