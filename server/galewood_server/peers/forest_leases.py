"""Leases of shared forests: each is simulated by one of the servers that share a database.

As with jobs (`jobs/leases.py`), a claim stores a new random token, and whoever has another token has lost.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import timedelta

from sqlalchemy import delete, or_, select, update
from sqlalchemy.orm import Session

from galewood_server.storage import SharedForest, database_now, insert_for, new_id

MAX_CLAIM_ATTEMPTS = 5
"""How often a claim is repeated if another server changes the same row."""


@dataclass(frozen=True)
class Lease:
    """Who holds a shared forest: the URL at which other servers reach the holder, and its token."""

    server_url: str
    token: str
    mine: bool


def claim_forest(
    session: Session, share: str, server_url: str, lease_s: float, lost: str | None = None
) -> Lease:
    """Claim a forest for the server at `server_url`, which does not hold it, or return another's valid lease.

    `lost` is the token of a lease whose server does not answer: it counts as expired. Commits.
    One statement, because many clients may wait for it: they all come when a server dies.
    RuntimeError if other servers keep changing the row.
    """
    for _ in range(MAX_CLAIM_ATTEMPTS):
        session.connection(execution_options={"isolation_level": "AUTOCOMMIT"})
        now, token = database_now(session), new_id()
        until = now + timedelta(seconds=lease_s)
        values = {"server_url": server_url, "lease": token, "lease_until": until}
        free = or_(
            SharedForest.lease_until < now,
            SharedForest.server_url == server_url,
            SharedForest.lease == lost,
        )
        statement = (
            insert_for(session)(SharedForest)
            .values(share=share, **values)
            .on_conflict_do_update(index_elements=[SharedForest.share], set_=values, where=free)
            .returning(SharedForest.lease)
        )
        claimed = session.scalar(statement) is not None
        if claimed:
            session.commit()
            return Lease(server_url, token, mine=True)
        holder = session.execute(
            select(SharedForest.server_url, SharedForest.lease).where(SharedForest.share == share)
        ).first()
        session.commit()
        if holder:  # otherwise it was released just now
            return Lease(holder.server_url, holder.lease, mine=False)
    raise RuntimeError(f"the shared forest {share!r} keeps changing its server")


def renew_forest(session: Session, share: str, token: str, lease_s: float) -> bool:
    """Extend a lease. False if another server has the forest now. Commits."""
    until = database_now(session) + timedelta(seconds=lease_s)
    condition = (SharedForest.share == share, SharedForest.lease == token)
    statement = update(SharedForest).where(*condition).values(lease_until=until).returning(SharedForest.share)
    renewed = session.scalar(statement) is not None
    session.commit()
    return renewed


def release_forest(session: Session, share: str, token: str) -> None:
    """Give a lease back, unless another server has the forest now. Commits."""
    session.execute(delete(SharedForest).where(SharedForest.share == share, SharedForest.lease == token))
    session.commit()
