"""Leases: each running job belongs to one server at a time, and to nobody once that server falls silent.

A claim writes a new word, the lease, beside the job. Everything that its process writes afterwards asks for
that word, so a server that was only slow, and lost the job meanwhile, changes nothing any more.
"""

from __future__ import annotations

import os
from collections.abc import Collection
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

from sqlalchemy import ColumnElement, and_, or_, select, update
from sqlalchemy.orm import Session

from galewood_server.storage import Job, JobKind, database_now, new_id, utc_now


def server_identity(data_dir: Path) -> str:
    """A name that stays with a data folder: after a crash the server at once takes up what was its own."""
    path = data_dir / "server-id"
    if not path.exists():
        path.write_text(new_id())
    return path.read_text().strip() or f"process-{os.getpid()}"


def claim(session: Session, owner: str, kinds: Collection[JobKind], lease_s: float) -> tuple[str, str] | None:
    """Take the job that waited longest, or one whose server fell silent: (job, lease), or None."""
    now = database_now(session)
    free = _free(now)
    job_id = session.scalars(
        select(Job.id).where(free, Job.kind.in_(kinds)).order_by(Job.created_at).limit(1)
    ).first()
    if job_id is None:
        return None
    taken: dict[str, Any] = {
        "state": "running",
        "message": "Starting",
        "owner": owner,
        "lease": new_id(),
        "lease_until": now + timedelta(seconds=lease_s),
        "updated_at": utc_now(),
    }
    # Asked again in the same breath: of several servers exactly one gets it.
    won = update(Job).where(Job.id == job_id, free).values(**taken).returning(Job.id)
    return (job_id, str(taken["lease"])) if session.scalar(won) else None


def _free(now: datetime) -> ColumnElement[bool]:
    silent = or_(Job.lease_until.is_(None), Job.lease_until < now)
    return or_(Job.state == "queued", and_(Job.state == "running", silent))


def renew(session: Session, job_id: str, lease: str, lease_s: float) -> bool:
    """Keep a job for another while; False if it is not ours any more."""
    until = database_now(session) + timedelta(seconds=lease_s)
    # updated_at stays: nothing changed that anybody is shown
    kept = {"lease_until": until, "updated_at": Job.updated_at}
    ours = update(Job).where(Job.id == job_id, Job.lease == lease).values(**kept).returning(Job.id)
    return session.scalar(ours) is not None


def give_back(session: Session, owner: str) -> int:
    """Queue whatever this server has running: at its start, after a crash, and at its end. How many."""
    waiting: dict[str, Any] = {
        "state": "queued",
        "message": "Interrupted; goes on from what was stored",
        "lease": None,
        "lease_until": None,
        "updated_at": utc_now(),
    }
    mine = update(Job).where(Job.state == "running", Job.owner == owner).values(**waiting)
    return len(session.scalars(mine.returning(Job.id)).all())
