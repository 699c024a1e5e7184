"""Jobs: queued, looked at, cancelled. The processes that do the work are in supervisor.py."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter
from sqlalchemy import select, update
from sqlalchemy.orm import Session

from server.context import ServiceHere
from server.errors import ProblemError, not_found
from server.models import ACTIVE, Job, Tree, utc_now
from server.schemas import JobOut

router = APIRouter(prefix="/api/jobs", tags=["jobs"])


def queue_job(session: Session, tree: Tree, settings: dict[str, Any]) -> Job:
    """Add a job for a tree. ProblemError 409 if one is queued or running already."""
    if tree.job and tree.job.state in ACTIVE:
        raise ProblemError(
            409,
            "already-building",
            "This tree is being computed already",
            hint="Wait for the job or cancel it.",
        )
    job = Job(tree_id=tree.id, settings=settings, message="Waiting for its turn")
    tree.jobs.append(job)
    session.flush()
    return job


def requeue_interrupted(session: Session) -> int:
    """At a start of the service: jobs that were running go on from what they stored. How many there were."""
    waiting = {
        "state": "queued",
        "message": "Interrupted; goes on from what was stored",
        "updated_at": utc_now(),
    }
    running = session.scalars(select(Job).where(Job.state == "running")).all()
    for job in running:
        session.execute(update(Job).where(Job.id == job.id).values(**waiting))
    return len(running)


def next_queued(session: Session) -> Job | None:
    """The job that has waited longest."""
    return session.scalars(select(Job).where(Job.state == "queued").order_by(Job.created_at).limit(1)).first()


def end_job(session: Session, job_id: str, state: str, *, message: str, error: str | None = None) -> bool:
    """Give a job that is still active its last state; whether it was."""
    end = {"state": state, "message": message, "error": error, "seconds_left": None, "updated_at": utc_now()}
    active = update(Job).where(Job.id == job_id, Job.state.in_(ACTIVE))
    return session.scalar(active.values(**end).returning(Job.id)) is not None


@router.get("/{job_id}")
def get_job(job_id: str, service: ServiceHere) -> JobOut:
    """One job as it stands."""
    with service.sessions() as session:
        return JobOut.model_validate(_job(session, job_id))


@router.post("/{job_id}/cancel")
def cancel_job(job_id: str, service: ServiceHere) -> JobOut:
    """Ask a job to stop: a waiting one ends at once, a running one within two seconds."""
    with service.sessions.begin() as session:
        job = _job(session, job_id)
        if job.state == "queued":
            end_job(session, job_id, "cancelled", message="Cancelled before it began")
        elif job.state == "running":
            job.cancel_requested = True
        session.flush()
        session.refresh(job)
        answer = JobOut.model_validate(job)
    service.wake_supervisor()
    return answer


def _job(session: Session, job_id: str) -> Job:
    job = session.get(Job, job_id)
    if job is None:
        raise not_found("job", job_id)
    return job
