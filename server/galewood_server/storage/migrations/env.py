"""How Alembic reaches the database: by the URL of database.py, or of the settings from a shell."""

from __future__ import annotations

from alembic import context
from galewood_server.settings import Settings
from galewood_server.storage.database import with_driver
from galewood_server.storage.models import Base
from sqlalchemy import create_engine, text

LOCK = 0x67616C65  # "gale": a number that only we take in this database

url = context.config.attributes.get("url") or Settings().database
engine = create_engine(with_driver(url))
with engine.connect() as connection:
    # batch mode: SQLite cannot alter a column, so tables are copied
    context.configure(connection=connection, target_metadata=Base.metadata, render_as_batch=True)
    with context.begin_transaction():
        if connection.dialect.name == "postgresql":
            # of several servers that start at once, one migrates and the others wait, then find nothing to do
            connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": LOCK})
        context.run_migrations()
engine.dispose()
