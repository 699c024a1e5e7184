"""Leases of shared forests: each is simulated by one of the servers that share a database.

As with jobs (`jobs/leases.py`), a claim stores a new random token, and whoever has another token has lost.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import timedelta

from sqlalchemy import delete, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from galewood_server.storage import SharedForest, database_now, new_id

ATTEMPTS = 5
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
    RuntimeError if other servers change the row again and again.
    """
    for _ in range(ATTEMPTS):
        now, token = database_now(session), new_id()
        row = session.get(SharedForest, share, populate_existing=True)
        values = {"server_url": server_url, "lease": token, "lease_until": now + timedelta(seconds=lease_s)}
        if row is None:
            try:
                session.add(SharedForest(share=share, **values))
                session.commit()
                return Lease(server_url, token, mine=True)
            except IntegrityError:  # another server was faster
                session.rollback()
                continue
        if row.server_url != server_url and row.lease_until >= now and row.lease != lost:
            return Lease(row.server_url, row.lease, mine=False)
        condition = (SharedForest.share == share, SharedForest.lease == row.lease)
        taken = session.scalar(
            update(SharedForest).where(*condition).values(**values).returning(SharedForest.share)
        )
        session.commit()
        if taken is not None:
            return Lease(server_url, token, mine=True)
    raise RuntimeError(f"the shared forest {share!r} changes its server again and again")


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
