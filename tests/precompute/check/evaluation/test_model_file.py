"""The finite-element model of a table that came without it: built again, and accepted by its frequencies."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.check.evaluation import model_file as module
from galewood.check.evaluation.model_file import SourceError, kept_model, model_file
from galewood.io.cli.commands import app
from galewood.packaged import species_folder
from galewood.pipeline.results import SHIPPED_FOLDER, read_shipped
from galewood.pipeline.sampling import content_hash
from galewood.pipeline.stages import BuiltinMesh, builtin_meshes, model_of
from galewood.pipeline.tables import BuildOptions
from galewood.solid.fem import FemModel, save_model
from galewood.table import Table, decode
from galewood.wood import is_evergreen, wood_of_species
from typer.testing import CliRunner

from tests.golden import GOLDEN_FOLDER
from tests.precompute.fixtures.shared_tets import TARGET_TETS, cache_with_tets, small_tree_glb

OPTIONS = BuildOptions(species="maple", height_m=5.2, target_tets=TARGET_TETS, stiffness="as drawn")
OTHER_SHA256 = "0" * 64
"""Of the model before rounding differed."""

pytestmark = [pytest.mark.usefixtures("one_worker"), pytest.mark.timeout(1800)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The mesh of a small tree, and a cache that has only its tetrahedra."""
    path = tmp_path_factory.mktemp("model-file")
    cache_with_tets(path / "cache", tmp_path_factory, OPTIONS.height_m)
    (path / "tree.glb").write_bytes(small_tree_glb())
    return path


@pytest.fixture(scope="module")
def model(folder: Path) -> FemModel:
    return model_of(small_tree_glb(), "tree.glb", OPTIONS, folder / "cache")


def table_of(model: FemModel, **provenance: Any) -> Table:
    """A table that says it was built from a model."""
    pole = decode((GOLDEN_FOLDER / "pole.safetensors").read_bytes())
    told = {
        "fem": asdict(OPTIONS.fem), "target_tets": TARGET_TETS, "winds": [], "frames": [],
        "tetrahedra": len(model.elements), "model_sha256": OTHER_SHA256, "wood": model.report["wood"],
        "young_longitudinal_pa": wood_of_species("maple").young_longitudinal_pa,
        **provenance,
    }  # fmt: skip
    metadata = {
        **pole.metadata, "species": "maple", "height_m": OPTIONS.height_m, "foliage": "leaf",
        "frequencies_hz": model.report["frequencies_hz"], "provenance": told,
        "streamlined_exponent": model.streamlined_exponent,
    }  # fmt: skip
    return replace(pole, metadata=metadata, paper=None)


def test_a_missing_model_is_built_again_once(
    folder: Path, model: FemModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    table, cache = table_of(model), folder / "cache"
    found = model_file(table, folder / "tree.glb", cache)
    built = np.array(found.model.report["frequencies_hz"])
    assert np.allclose(built, model.report["frequencies_hz"], rtol=module.SAME_FREQUENCIES)
    assert found.model_path == cache / "models" / f"{content_hash(found.model)}.npz"
    assert len(found.mesh.tets) == len(model.elements)
    monkeypatch.setattr(module, "model_of", lambda *_: pytest.fail("it was kept"))
    assert model_file(table, folder / "tree.glb", cache).model_path == found.model_path


def test_a_model_with_other_frequencies_is_refused(folder: Path, model: FemModel, tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    save_model(model, path)
    table = table_of(model)
    for deviation, refused in ((1e-5, False), (1e-3, True)):
        hz = (np.array(model.report["frequencies_hz"]) * (1 + deviation)).tolist()
        metadata = {**table.metadata, "frequencies_hz": hz}
        if not refused:
            assert kept_model(path, metadata, tmp_path / "cache").name == f"{content_hash(model)}.npz"
            continue
        with pytest.raises(SourceError, match=r"frequencies deviate by 0\.001 \(limit 0\.0005\)\. Give"):
            kept_model(path, metadata, tmp_path / "cache")
    with pytest.raises(SourceError, match="other tetrahedra"):
        kept_model(path, table_of(model, tetrahedra=7).metadata, tmp_path / "cache")
    bare = {**table.metadata, "streamlined_exponent": 2.0}  # its frequencies are the same
    for metadata in (bare, table_of(model, wood="the user's").metadata):
        with pytest.raises(SourceError, match="another wood or foliage"):
            kept_model(path, metadata, tmp_path / "cache")


def test_the_model_of_the_table_is_taken_by_its_hash(model: FemModel, tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    save_model(model, path)
    own = table_of(model, model_sha256=content_hash(model)).metadata
    metadata = {**own, "frequencies_hz": [1.0]}  # is not looked at
    assert kept_model(path, metadata, tmp_path / "cache").exists()


BUILTIN_MESHES = builtin_meshes(species_folder())
ALWAYS_BUILT_AGAIN = ("poplar", "apricot-forest", "spruce")
"""An open tree, one of the forest, and an evergreen; `make test-release` builds the models of all others."""


@pytest.mark.parametrize(
    "mesh",
    [
        pytest.param(mesh, id=mesh.name, marks=() if mesh.name in ALWAYS_BUILT_AGAIN else pytest.mark.release)
        for mesh in BUILTIN_MESHES
    ],
)
def test_a_shipped_table_gets_its_model_again(mesh: BuiltinMesh, tmp_path: Path) -> None:
    """On any processor, though rounding differs from that of the one that built it."""
    shipped = read_shipped(species_folder() / SHIPPED_FOLDER, mesh.name, mesh.key)
    assert shipped is not None
    bare = shipped.result.bare_table
    assert (bare is None) == is_evergreen(str(mesh.options["species"]))
    for data in (shipped.result.table, *([] if bare is None else [bare])):
        table = decode(data)
        shipped.keep_tetrahedra(tmp_path)
        found = np.array(model_file(table, mesh.path, tmp_path).model.report["frequencies_hz"])
        worst = np.abs(found / table.metadata["frequencies_hz"] - 1).max()
        print(mesh.name, table.foliage, f"{worst:.1e}")
        assert worst <= module.SAME_FREQUENCIES / 5


@pytest.mark.timeout(3600)
def test_a_shipped_tree_is_evaluated_with_an_empty_cache(tmp_path: Path) -> None:
    out = tmp_path / "figures.json"
    result = CliRunner().invoke(app, [
        "evaluate", "apricot-forest", "--cache-dir", str(tmp_path / "cache"), "--frames", "60",
        "--no-converged", "--workers", "1", "--json", str(out),
    ])  # fmt: skip
    assert result.exit_code == 0, result.output
    found = json.loads(out.read_text())
    print(result.output[:2000])
    assert all(case["modal"]["branches"] > 0.5 for case in found["gusts"].values())
    assert all(methods["modal"]["max_error"] < 0.005 for methods in found["uniform"].values())


def test_neither_a_file_nor_a_built_in_tree_is_refused_in_words(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["evaluate", "oaktree", "--cache-dir", str(tmp_path)])
    assert result.exit_code == 1
    assert "neither a file nor a built-in tree" in " ".join(result.output.split())
