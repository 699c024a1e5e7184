"""Job leases: a running job is owned by one server until its lease expires.

A claim stores a new random token, the lease, with the job. All later writes of its process require this
token, so a slow server whose job was claimed by another one cannot change the job.
"""

from __future__ import annotations

import os
from collections.abc import Collection
from datetime import timedelta
from pathlib import Path
from typing import Any

from galewood.constants import STAGES_AFTER_TABLE
from sqlalchemy import ColumnElement, and_, not_, or_, select, update
from sqlalchemy.orm import Session

from galewood_server.storage import Job, JobKind, database_now, new_id, utc_now


def server_identity(data_dir: Path) -> str:
    """The identifier of a data folder's server, with which it requeues its own jobs after a crash."""
    path = data_dir / "server-id"
    if not path.exists():
        path.write_text(new_id())
    return path.read_text().strip() or f"process-{os.getpid()}"


AFTER_TABLE = Job.stage.in_(STAGES_AFTER_TABLE)
"""Whether a build has its table: what follows comes after the tables of all other trees."""


def claim(
    session: Session, owner: str, kinds: Collection[JobKind], lease_s: float, *, after_table: bool = False
) -> tuple[str, str] | None:
    """Claim the oldest job that is queued or whose lease has expired: (job id, lease), or None.

    ``after_table``: a build that has its table; there is none to claim while one without waits. Its server
    has its files, and for the length of a lease no other one claims it.
    """
    now = database_now(session)
    left_alone = or_(Job.owner.is_(None), Job.updated_at < now - timedelta(seconds=lease_s))
    claimable = and_(_claimable(now), or_(not_(AFTER_TABLE), Job.owner == owner, left_alone))
    waiting = select(Job.id, AFTER_TABLE).where(claimable, Job.kind.in_(kinds))
    first = session.execute(waiting.order_by(AFTER_TABLE, Job.created_at).limit(1)).first()
    if first is None or first[1] != after_table:
        return None
    job_id: str = first[0]
    values: dict[str, Any] = {
        "state": "running",
        "message": "Starting",
        "owner": owner,
        "lease": new_id(),
        "lease_until": now + timedelta(seconds=lease_s),
        "updated_at": utc_now(),
    }
    # the condition is repeated in the update, so that only one of several servers succeeds
    statement = update(Job).where(Job.id == job_id, claimable).values(**values).returning(Job.id)
    return (job_id, str(values["lease"])) if session.scalar(statement) else None


def claimable_kinds(session: Session) -> set[JobKind]:
    """The kinds of the jobs that could be claimed."""
    session.connection(execution_options={"isolation_level": "AUTOCOMMIT"})
    return set(session.scalars(select(Job.kind).where(_claimable(database_now(session))).distinct()))


def _claimable(now: Any) -> ColumnElement[bool]:
    expired = or_(Job.lease_until.is_(None), Job.lease_until < now)
    return or_(Job.state == "queued", and_(Job.state == "running", expired))


def renew(session: Session, job_id: str, lease: str, lease_s: float) -> bool:
    """Extend a lease. False if it is no longer valid."""
    until = database_now(session) + timedelta(seconds=lease_s)
    # keep updated_at: nothing visible to clients changed
    values = {"lease_until": until, "updated_at": Job.updated_at}
    statement = update(Job).where(Job.id == job_id, Job.lease == lease).values(**values).returning(Job.id)
    return session.scalar(statement) is not None


def is_awaited(session: Session, job_id: str, lease: str) -> bool:
    """Whether a build without a table waits, or runs on the server that holds this lease."""
    owner = select(Job.owner).where(Job.id == job_id, Job.lease == lease).scalar_subquery()
    here = and_(Job.state == "running", Job.owner == owner)
    others = select(Job.id).where(Job.kind == "build", Job.id != job_id, not_(AFTER_TABLE))
    return session.scalar(others.where(or_(Job.state == "queued", here)).limit(1)) is not None


def put_back(session: Session, job_id: str, lease: str) -> None:
    """Queue a running job again, if the lease is still valid: others come first."""
    values: dict[str, Any] = {
        "state": "queued",
        "message": "Waiting until other trees have their tables",
        "seconds_left": None,
        "lease": None,
        "lease_until": None,
        "updated_at": utc_now(),
    }
    session.execute(update(Job).where(Job.id == job_id, Job.lease == lease).values(**values))


def requeue_running(session: Session, owner: str) -> int:
    """Requeue the running jobs of a server, at its start and end. Returns their number."""
    values: dict[str, Any] = {
        "state": "queued",
        "message": "Interrupted; will resume from stored results",
        "lease": None,
        "lease_until": None,
        "updated_at": utc_now(),
    }
    statement = update(Job).where(Job.state == "running", Job.owner == owner).values(**values)
    return len(session.scalars(statement.returning(Job.id)).all())
