"""Which files belong to a table: the records of the paper's state search, and the compliance of its tree."""

from __future__ import annotations

from sqlalchemy import or_, select

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


def compliance_of(sessions: Sessions, table_sha256: str) -> str | None:
    """Hash of the compliance file of a table's tree, in leaf or bare; None if there is none."""
    with sessions() as session:
        of_table = or_(Tree.table_sha256 == table_sha256, Tree.bare_table_sha256 == table_sha256)
        return session.scalars(
            select(Tree.compliance_sha256).where(of_table, Tree.compliance_sha256.is_not(None))
        ).first()
