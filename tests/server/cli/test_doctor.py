"""`galewood doctor`: detection and repair of each kind of fault."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from galewood_server.cli.commands import app
from galewood_server.cli.doctor import run_checks
from galewood_server.settings import Settings
from galewood_server.storage.database import migrate, open_database
from galewood_server.storage.models import Job, Tree
from galewood_server.storage.stores import Stores
from typer.testing import CliRunner

OLD_S = 1_000_000_000


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """A consistent data folder: a tree with every kind of file and a job with a picture."""
    settings = Settings(data_dir=tmp_path / "data")
    migrate(settings.database)
    stores = Stores(settings.data_dir)
    files = {
        kind: stores.named(kind).put(f"{kind} of a tree".encode())
        for kind in ("sources", "meshes", "models", "records")
    }
    table, bare = stores.tables.put(b"table of a tree"), stores.tables.put(b"table of a bare tree")
    picture = stores.pictures.put(b"a picture")
    with open_database(settings.database).begin() as session:
        tree = Tree(
            id="oak",
            name="Oak",
            filename="a.obj",
            source_sha256=files["sources"],
            mesh_sha256=files["meshes"],
            model_sha256=files["models"],
            table_sha256=table,
            bare_table_sha256=bare,
            records_sha256=files["records"],
            fingerprint="f" * 64,
        )
        tree.jobs.append(Job(id="job", state="done", pictures={"skeleton": picture}))
        session.add(tree)
    return settings


def faults(settings: Settings, *, repair: bool = False) -> list[str]:
    return [f"{one.kind}: {one.what}" for one in run_checks(settings, repair=repair) if one.is_fault]


def tree_of(settings: Settings) -> Tree:
    with open_database(settings.database)() as session:
        return session.get_one(Tree, "oak")


def test_an_intact_store_has_no_faults(settings: Settings) -> None:
    assert faults(settings) == []
    # an unreadable table is only a note
    assert [one.kind for one in run_checks(settings) if one.kind == "version"] == ["version"]


@pytest.mark.parametrize("kind", ["sources", "meshes", "tables", "records", "models", "pictures"])
def test_a_missing_file_is_reported_and_repaired(settings: Settings, kind: str) -> None:
    store = Stores(settings.data_dir).named(kind)
    name = tree_of(settings).table_sha256 if kind == "tables" else next(iter(store.names()))
    assert name
    store.remove(name)
    assert [line.split("/")[0] for line in faults(settings)] == [f"missing: {kind}"]
    still = faults(settings, repair=True)
    if kind == "sources":  # uploads cannot be restored
        assert len(still) == 1 and tree_of(settings).table_sha256
        return
    assert still == [] == faults(settings)
    tree = tree_of(settings)
    assert tree.state == ("ready" if kind in ("pictures", "records") else "uploaded")
    assert tree.jobs[0].pictures == ({} if kind == "pictures" else tree.jobs[0].pictures)


def test_a_missing_bare_table_leaves_the_other(settings: Settings) -> None:
    store, before = Stores(settings.data_dir).tables, tree_of(settings)
    assert before.bare_table_sha256
    store.remove(before.bare_table_sha256)
    assert [line.split("/")[0] for line in faults(settings)] == ["missing: tables"]
    assert faults(settings, repair=True) == []
    tree = tree_of(settings)
    assert (tree.state, tree.table_sha256, tree.bare_table_sha256) == ("ready", before.table_sha256, None)


def test_a_corrupt_file_is_detected_by_its_hash(settings: Settings) -> None:
    store, name = Stores(settings.data_dir).tables, tree_of(settings).table_sha256
    assert name
    store.path(name).write_bytes(b"table of a tr")
    assert [line.split("/")[0] for line in faults(settings)] == ["torn: tables"]
    assert store.has(name)
    assert faults(settings, repair=True) == []
    assert not store.has(name) and tree_of(settings).table_sha256 is None
    assert faults(settings) == []


def test_an_old_unreferenced_file_is_removed(settings: Settings) -> None:
    store = Stores(settings.data_dir).meshes
    name = store.put(b"nobody's")
    assert faults(settings, repair=True) == [] and store.has(name)  # it may belong to a running upload
    os.utime(store.path(name), (OLD_S, OLD_S))
    part = store.path(name).with_name(".part-abc")
    part.write_bytes(b"half")
    os.utime(part, (OLD_S, OLD_S))
    assert sorted(line.split(":")[0] for line in faults(settings)) == ["orphaned", "orphaned"]
    assert faults(settings, repair=True) == []
    assert not store.has(name) and not part.exists()
    assert len(list(store.names())) == 1


def test_active_jobs_and_low_disk_space_are_reported(settings: Settings) -> None:
    with open_database(settings.database).begin() as session:
        session.add(Job(tree_id="oak", state="running"))
    assert [one.what for one in run_checks(settings) if one.kind == "jobs"] == [
        "1 running; a running server will resume them"
    ]
    assert faults(settings.model_copy(update={"free_bytes": 1 << 60}))[0].startswith("disk: ")
    assert faults(settings.model_copy(update={"stored_bytes": 1}))[0].startswith("disk: ")


def test_a_database_without_schema_is_reported(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    settings = Settings(data_dir=tmp_path / "data")
    assert [line.split(":")[0] for line in faults(settings)] == ["database"]
    (tmp_path / "data" / "galewood.sqlite").write_bytes(b"this is not a database" * 100)
    (fault,) = faults(settings)
    assert "galewood.sqlite is damaged (file is not a database): restore it" in fault


def test_the_doctor_command_has_an_exit_status(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("GALEWOOD_DATA_DIR", str(settings.data_dir))
    run = CliRunner().invoke
    report = tmp_path / "report.json"
    assert run(app, ["doctor", "--json", str(report)]).exit_code == 0
    assert json.loads(report.read_text())["faults"] == 0
    store = Stores(settings.data_dir).tables
    store.remove(next(iter(store.names())))
    assert run(app, ["doctor"]).exit_code == 1
    assert run(app, ["doctor", "--repair"]).exit_code == 0
    assert run(app, ["doctor"]).exit_code == 0
