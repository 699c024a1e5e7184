"""Database connections and schema migration."""

from __future__ import annotations

import fcntl
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import Engine, create_engine, event, func, select, text
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session, sessionmaker

from galewood_server.storage.failures import StartError
from galewood_server.storage.models import utc_now

if TYPE_CHECKING:
    from alembic.config import Config

Sessions = sessionmaker[Session]
REVISIONS = ("0001",)
"""The schema revisions, known without loading Alembic; a test compares them with the migrations."""
HEAD_REVISION = REVISIONS[-1]


def open_database(url: str) -> Sessions:
    """A session factory for an existing, migrated database."""
    engine = create_engine(with_driver(url), pool_pre_ping=not url.startswith("sqlite"))
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _prepare_sqlite)
    return sessionmaker(engine, expire_on_commit=False)


def with_driver(url: str) -> str:
    """A database URL with the installed PostgreSQL driver."""
    for plain in ("postgresql://", "postgres://"):
        if url.startswith(plain):
            return "postgresql+psycopg://" + url.removeprefix(plain)
    return url


def _prepare_sqlite(connection: Any, _record: object) -> None:
    # text that is not UTF-8 spoils its own row only, which is then not serialisable
    connection.text_factory = partial(str, encoding="utf-8", errors="surrogateescape")
    # WAL allows job processes to write while the server reads; busy_timeout avoids "database is locked"
    for pragma in ("journal_mode=WAL", "synchronous=NORMAL", "foreign_keys=ON", "busy_timeout=10000"):
        connection.execute(f"PRAGMA {pragma}")


def migrate(url: str) -> None:
    """Migrate the database to the newest schema, creating it if necessary. Serialises concurrent calls.

    StartError if its schema is not one of this version of the software.
    """
    revision = _revision(url)
    if revision == HEAD_REVISION:
        return
    check_revision(revision)
    from alembic import command

    if not url.startswith("sqlite:///"):
        command.upgrade(migration_config(url), "head")  # env.py takes an advisory lock
        return
    path = Path(url.removeprefix("sqlite:///"))
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.with_name(path.name + ".migrating").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        command.upgrade(migration_config(url), "head")


def check_revision(revision: str | None) -> None:
    """Raise StartError if a schema is not one that this version of the software can use or migrate."""
    if revision is not None and revision not in REVISIONS:
        raise StartError(
            f"The database belongs to another version of Galewood (schema {revision}; this version uses"
            f" {HEAD_REVISION}): install that version, or set GALEWOOD_DATA_DIR to an empty folder (and"
            " GALEWOOD_DATABASE_URL, if it is set, to an empty database) and upload the trees again."
        )


def _revision(url: str) -> str | None:
    """The schema revision of a database; None if it has none or does not exist."""
    if url.startswith("sqlite:///") and not Path(url.removeprefix("sqlite:///")).exists():
        return None
    engine = create_engine(with_driver(url))
    try:
        with engine.connect() as connection:
            return connection.execute(text("SELECT version_num FROM alembic_version")).scalar()
    except SQLAlchemyError:
        return None
    finally:
        engine.dispose()


def migration_config(url: str) -> Config:
    """Alembic's configuration for a database URL."""
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    config.attributes["url"] = url
    return config


def engine_of(sessions: Sessions) -> Engine:
    """The engine of a session factory."""
    bind = sessions.kw["bind"]
    assert isinstance(bind, Engine)
    return bind


def database_now(session: Session) -> Any:
    """The current time by PostgreSQL's clock, which servers share, or by this machine's for SQLite.

    For use in a statement, so that it costs no query of its own.
    """
    return func.clock_timestamp() if _on_postgresql(session) else utc_now()


def insert_for(session: Session) -> Any:
    """The INSERT of the database's dialect, which knows ON CONFLICT."""
    return postgresql.insert if _on_postgresql(session) else sqlite.insert


def lock_transaction(session: Session, key: int) -> None:
    """Wait until no other transaction holds this key (SQLite: none writes), also of other servers.

    Call it first in a transaction, which then holds the key until it ends.
    """
    lock = select(func.pg_advisory_xact_lock(key))
    session.execute(lock if _on_postgresql(session) else text("BEGIN IMMEDIATE"))


def _on_postgresql(session: Session) -> bool:
    return session.get_bind().dialect.name == "postgresql"
