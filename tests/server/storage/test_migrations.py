"""Schema migrations: at startup, in agreement with the models, and only of known schemas."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from galewood_server.storage import StartError
from galewood_server.storage.database import (
    REVISIONS,
    check_revision,
    engine_of,
    migrate,
    migration_config,
    open_database,
    with_driver,
)
from galewood_server.storage.models import Base
from sqlalchemy import text


def test_the_migrations_match_the_models(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'new.sqlite'}"
    migrate(url)
    with engine_of(open_database(url)).connect() as connection:
        scripts = ScriptDirectory.from_config(migration_config(url)).walk_revisions()
        assert [script.revision for script in scripts] == list(reversed(REVISIONS))
        assert compare_metadata(MigrationContext.configure(connection), Base.metadata) == []
    command.downgrade(migration_config(url), "base")
    migrate(url)


def test_a_database_of_another_version_is_refused_and_left_alone(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'other.sqlite'}"
    migrate(url)
    with engine_of(open_database(url)).begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '0007'"))
    with pytest.raises(StartError, match=r"schema 0007; this version uses .* upload the trees again"):
        migrate(url)
    with engine_of(open_database(url)).connect() as connection:
        assert connection.execute(text("SELECT version_num FROM alembic_version")).scalar() == "0007"
    check_revision(None)
    for known in REVISIONS:
        check_revision(known)


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
