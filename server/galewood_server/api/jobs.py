"""Jobs as a client starts, lists and repeats them; what becomes of them is in jobs.py and supervisor.py."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from sqlalchemy import func, select

from galewood_server.api.trees import find_tree
from galewood_server.context import Service, ServiceHere
from galewood_server.http import (
    NOT_MODIFIED,
    JobList,
    JobOut,
    JobRequest,
    PageQuery,
    bad_cursor,
    beyond,
    cursor_of,
    parts_of,
    problems,
    tagged,
)
from galewood_server.jobs import find_job, fingerprint, queue_job, request_cancel
from galewood_server.storage import Job, JobState, Tree

router = APIRouter(prefix="/api/jobs", tags=["jobs"])
ORDER = (Job.created_at, Job.id)


class JobQuery(PageQuery):
    """Which jobs: all, or those in one state or of one tree."""

    state: JobState | None = Query(default=None)
    tree_id: str | None = Query(default=None, max_length=64)


@router.get("", response_model=JobList, responses=NOT_MODIFIED)
def list_jobs(request: Request, service: ServiceHere, asked: Annotated[JobQuery, Query()]) -> Response:
    """A page of the builds, the newest first."""
    wanted = [Job.kind == "build"]
    wanted += [Job.state == asked.state] if asked.state else []
    wanted += [Job.tree_id == asked.tree_id] if asked.tree_id else []
    with service.sessions() as session:
        total = session.scalar(select(func.count(Job.id)).where(*wanted)) or 0
        if asked.after:
            wanted.append(beyond(ORDER, _sort_key(asked.after), descending=True))
        newest = select(Job).where(*wanted).order_by(*(column.desc() for column in ORDER))
        jobs = session.scalars(newest.limit(asked.limit + 1)).all()
        last = jobs[asked.limit - 1] if len(jobs) > asked.limit else None
        page = [JobOut.model_validate(job) for job in jobs[: asked.limit]]
    more = cursor_of([last.created_at.isoformat(), last.id]) if last else None
    return tagged(request, JobList(jobs=page, total=total, next=more))


def _sort_key(cursor: str) -> tuple[datetime, str]:
    created_at, job_id = parts_of(cursor, 2)
    try:
        return datetime.fromisoformat(created_at), job_id
    except ValueError:
        raise bad_cursor() from None


STARTED = {
    200: {"model": JobOut, "description": "The tree has the table of exactly these settings; its job."},
    **problems(404, 409, 413),
}


@router.post("", status_code=202, max_body_size=64 * 1024, responses=STARTED)
def start_job(body: JobRequest, service: ServiceHere, response: Response) -> JobOut:
    """Queue the computation of a tree's table, under the tree's own assumptions or these settings."""
    answer, new = start_build(service, body.tree_id, body.settings.model_dump(exclude_none=True))
    response.status_code = 202 if new else 200
    return answer


def start_build(service: Service, tree_id: str, settings: dict[str, Any]) -> tuple[JobOut, bool]:
    """Queue a build, unless its very table is there already; whether it was queued. ProblemError 404, 409."""
    with service.sessions.begin() as session:
        tree = find_tree(session, tree_id)
        done = _done_already(tree, settings)
        answer = JobOut.model_validate(done or queue_job(session, tree, settings))
    service.wake_supervisor()
    return answer, done is None


def _done_already(tree: Tree, settings: dict[str, Any]) -> Job | None:
    """The job that made the present table, if it would come out the same again."""
    job = tree.job
    if job is None or job.state != "done" or tree.state != "ready" or job.settings != settings:
        return None
    same = tree.fingerprint == fingerprint(tree.source_sha256, tree.options, settings)
    return job if same else None


@router.post("/{job_id}/retry", status_code=202, responses={**STARTED})
def retry_job(job_id: str, service: ServiceHere, response: Response) -> JobOut:
    """Queue a job that failed or was cancelled once more, as it was; it goes on from what was stored."""
    with service.sessions() as session:
        job = find_job(session, job_id)
        tree_id, settings = job.tree_id, job.settings
    answer, new = start_build(service, tree_id, settings)
    response.status_code = 202 if new else 200
    return answer


@router.get("/{job_id}")
def get_job(job_id: str, service: ServiceHere) -> JobOut:
    """One job as it stands."""
    with service.sessions() as session:
        return JobOut.model_validate(find_job(session, job_id))


@router.post("/{job_id}/cancel")
def cancel_job(job_id: str, service: ServiceHere) -> JobOut:
    """Ask a job to stop: a waiting one ends at once, a running one within two seconds."""
    with service.sessions.begin() as session:
        job = find_job(session, job_id)
        request_cancel(session, job)
        answer = JobOut.model_validate(job)
    service.wake_supervisor()
    return answer
