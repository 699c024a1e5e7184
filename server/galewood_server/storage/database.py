"""Connections to the database and its migration to the present schema."""

from __future__ import annotations

import fcntl
from datetime import datetime
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from sqlalchemy import Engine, create_engine, event, func, select
from sqlalchemy.orm import Session, sessionmaker

from galewood_server.storage.models import utc_now

Sessions = sessionmaker[Session]


def open_database(url: str) -> Sessions:
    """A factory of sessions on an existing, migrated database."""
    engine = create_engine(with_driver(url), pool_pre_ping=not url.startswith("sqlite"))
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _prepare_sqlite)
    return sessionmaker(engine, expire_on_commit=False)


def with_driver(url: str) -> str:
    """PostgreSQL's usual URL, with the driver that is installed here."""
    for plain in ("postgresql://", "postgres://"):
        if url.startswith(plain):
            return "postgresql+psycopg://" + url.removeprefix(plain)
    return url


def _prepare_sqlite(connection: Any, _record: object) -> None:
    # WAL lets the job processes write while the server reads; waiting beats "database is locked".
    for pragma in ("journal_mode=WAL", "synchronous=NORMAL", "foreign_keys=ON", "busy_timeout=10000"):
        connection.execute(f"PRAGMA {pragma}")


def migrate(url: str) -> None:
    """Bring the database to the newest schema; an empty one is made. One server at a time does so."""
    if not url.startswith("sqlite:///"):
        command.upgrade(migration_config(url), "head")  # env.py takes an advisory lock
        return
    path = Path(url.removeprefix("sqlite:///"))
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.with_name(path.name + ".migrating").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        command.upgrade(migration_config(url), "head")


def migration_config(url: str) -> Config:
    """Alembic's configuration, without a file."""
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    config.attributes["url"] = url
    return config


def engine_of(sessions: Sessions) -> Engine:
    """The engine behind a factory of sessions."""
    bind = sessions.kw["bind"]
    assert isinstance(bind, Engine)
    return bind


def database_now(session: Session) -> datetime:
    """The database's clock, where it is one for several servers; a file's servers share the machine's."""
    if session.get_bind().dialect.name == "postgresql":
        return session.scalars(select(func.clock_timestamp())).one()
    return utc_now()
