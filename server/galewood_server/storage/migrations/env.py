"""Alembic environment: database URL from database.py or, on the command line, from the settings."""

from __future__ import annotations

from alembic import context
from galewood_server.settings import Settings
from galewood_server.storage.database import with_driver
from galewood_server.storage.models import Base
from sqlalchemy import create_engine, text

MIGRATION_LOCK_KEY = 0x67616C65  # "gale" in ASCII: key of the advisory lock

url = context.config.attributes.get("url") or Settings().database
engine = create_engine(with_driver(url))
with engine.connect() as connection:
    # batch mode copies tables, because SQLite cannot alter columns
    context.configure(connection=connection, target_metadata=Base.metadata, render_as_batch=True)
    with context.begin_transaction():
        if connection.dialect.name == "postgresql":
            # if several servers start at once, one migrates and the others wait
            connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": MIGRATION_LOCK_KEY})
        context.run_migrations()
engine.dispose()
