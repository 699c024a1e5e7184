"""The job queue: add, find, cancel and end jobs. supervisor.py runs them."""

from __future__ import annotations

from typing import Any

from galewood.options import AFTER_BEAMS
from sqlalchemy import select, update
from sqlalchemy.orm import Session

from galewood_server.storage import ACTIVE_STATES, TABLE_JOBS, Job, JobKind, Tree, utc_now


def queue_job(session: Session, tree: Tree, settings: dict[str, Any], kind: JobKind = "build") -> Job:
    """Queue a job of TABLE_JOBS. ProblemError 409 if one of this tree is already queued or running.

    The tree moves at once, by the table that its import has made, unless the settings need another one.
    """
    if tree.job and tree.job.state in ACTIVE_STATES:
        from galewood_server.http import ProblemError  # loads FastAPI, which job processes do not need

        raise ProblemError(
            409,
            "already-building",
            "This tree is already being computed",
            hint="Wait for its job to finish, or cancel it.",
        )
    if tree.table_sha256 is None and tree.beams_sha256 and settings.keys() <= AFTER_BEAMS:
        tree.table_sha256, tree.preliminary = tree.beams_sha256, True
    return add_job(session, tree, kind, settings)


def add_job(session: Session, tree: Tree, kind: JobKind, settings: dict[str, Any]) -> Job:
    """Add a job at the end of the queue."""
    job = Job(tree_id=tree.id, kind=kind, settings=settings, message="Queued")
    tree.jobs.append(job)
    session.flush()
    return job


def end_job(
    session: Session,
    job_id: str,
    state: str,
    *,
    message: str,
    error: str | None = None,
    lease: str | None = None,
    **more: Any,
) -> bool:
    """Set the final state of an active job, if `lease` is None or still valid. Returns whether it was set."""
    values = {
        "state": state,
        "message": message,
        "error": error,
        "seconds_left": None,
        "updated_at": utc_now(),
    }
    active = update(Job).where(Job.id == job_id, Job.state.in_(ACTIVE_STATES))
    if lease is not None:
        active = active.where(Job.lease == lease)
    return session.scalar(active.values(**values, **more).returning(Job.id)) is not None


def request_cancel(session: Session, job_id: str, *kinds: JobKind) -> Job:
    """End a queued job; request the cancellation of a running one. Returns the job.

    ProblemError like `find_job`, also if its tree is deleted meanwhile.
    """
    job = find_job(session, job_id, *kinds)
    if job.state == "queued":
        end_job(session, job_id, "cancelled", message="Cancelled before it started")
    elif job.state == "running":
        running = update(Job).where(Job.id == job_id, Job.state == "running")
        session.execute(running.values(cancel_requested=True))
    session.expire(job)
    return find_job(session, job_id, *kinds)


def find_job(session: Session, job_id: str, *kinds: JobKind) -> Job:
    """A job by its id, if it is of one of these kinds (default: TABLE_JOBS).

    ProblemError 404, or 500 if its row cannot be read.
    """
    what = kinds[0] if kinds else "job"
    try:
        job = session.scalars(
            select(Job).where(Job.id == job_id, Job.kind.in_(kinds or TABLE_JOBS))
        ).one_or_none()
    except (ValueError, TypeError) as error:  # of a stored time or JSON document
        from galewood_server.http import damaged

        raise damaged(what, job_id, "Delete its tree, then upload its file again.") from error
    if job is None:
        from galewood_server.http import not_found

        raise not_found(what, job_id)
    return job
