"""Which file holds the records of the paper's state search for a table."""

from __future__ import annotations

from sqlalchemy import select

from galewood_server.storage.database import Sessions
from galewood_server.storage.models import Tree


def records_of(sessions: Sessions, table_sha256: str) -> str | None:
    """Hash of the records file of a table; None if there is none."""
    with sessions() as session:
        return session.scalars(
            select(Tree.records_sha256).where(
                Tree.table_sha256 == table_sha256, Tree.records_sha256.is_not(None)
            )
        ).first()
