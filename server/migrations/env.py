"""How Alembic reaches the database: by the URL of server/database.py, or of the settings from a shell."""

from __future__ import annotations

from alembic import context
from sqlalchemy import create_engine

from server.models import Base
from server.settings import Settings

url = context.config.attributes.get("url") or Settings().database
engine = create_engine(url)
with engine.connect() as connection:
    # batch mode: SQLite cannot alter a column, so tables are copied
    context.configure(connection=connection, target_metadata=Base.metadata, render_as_batch=True)
    with context.begin_transaction():
        context.run_migrations()
engine.dispose()
