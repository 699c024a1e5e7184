"""Schema migrations: upgrade at startup, and agreement with the models."""

from __future__ import annotations

import threading
from pathlib import Path

from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from galewood_server.storage.database import (
    HEAD,
    engine_of,
    migrate,
    migration_config,
    open_database,
    with_driver,
)
from galewood_server.storage.models import Base, Job, Tree
from sqlalchemy import create_engine, text

OLD_TREE = """INSERT INTO trees (id, name, builtin, filename, options, report, source_sha256, table_sha256,
    created_at, updated_at) VALUES ('old', 'Old oak', false, 'oak.obj', '{}', '{}', 'aa', 'bb',
    '2026-01-02 03:04:05', '2026-01-02 03:04:05')"""
OLD_JOB = """INSERT INTO jobs (id, tree_id, state, stage, fraction, message, settings, attempts,
    cancel_requested, created_at, updated_at) VALUES ('job', 'old', 'running', 'sampling', 0.5, '', '{}', 0,
    false, '2026-01-02 03:04:05', '2026-01-02 03:04:05')"""


def test_startup_migrates_an_older_database(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'old.sqlite'}"
    command.upgrade(migration_config(url), "0001")
    engine = create_engine(url)
    with engine.begin() as connection:
        connection.execute(text(OLD_TREE))
        connection.execute(text(OLD_JOB))
    engine.dispose()
    migrate(url)
    with open_database(url)() as session:
        tree = session.get_one(Tree, "old")
        assert (tree.name, tree.state, tree.preliminary) == ("Old oak", "ready", False)
        assert tree.model_sha256 is tree.records_sha256 is tree.bare_table_sha256 is None
        assert tree.form == "open"
        job = session.get_one(Job, "job")
        assert (job.kind, job.state, job.pictures, job.lease) == ("build", "running", {}, None)


def test_the_migrations_match_the_models(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'new.sqlite'}"
    migrate(url)
    with engine_of(open_database(url)).connect() as connection:
        assert ScriptDirectory.from_config(migration_config(url)).get_current_head() == HEAD
        assert compare_metadata(MigrationContext.configure(connection), Base.metadata) == []
    command.downgrade(migration_config(url), "base")
    migrate(url)


def test_concurrent_starts_migrate_once(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'shared.sqlite'}"
    failures: list[Exception] = []

    def start() -> None:
        try:
            migrate(url)
        except Exception as error:
            failures.append(error)

    threads = [threading.Thread(target=start) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures


def test_postgresql_urls_use_the_installed_driver() -> None:
    assert with_driver("postgresql://a@b/c") == "postgresql+psycopg://a@b/c"
    assert with_driver("postgresql+psycopg://a@b/c") == "postgresql+psycopg://a@b/c"
    assert with_driver("sqlite:///x") == "sqlite:///x"
