"""Build jobs: start, list, retry and cancel. jobs/supervisor.py runs them."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from sqlalchemy import func, select

from galewood_server.api.trees import find_tree
from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    NOT_MODIFIED,
    JobList,
    JobOut,
    JobRequest,
    PageQuery,
    cursor_time,
    decode_cursor,
    encode_cursor,
    json_with_etag,
    problems,
    rows_after,
)
from galewood_server.jobs import AFTER_TABLE, find_job, fingerprint, queue_job, request_cancel
from galewood_server.storage import Job, JobState, Tree

router = APIRouter(prefix="/api/jobs", tags=["jobs"])
ORDER = (Job.created_at, Job.id)


class JobQuery(PageQuery):
    """Query parameters of the job list: page, state and tree."""

    state: JobState | None = Query(default=None)
    tree_id: str | None = Query(default=None, max_length=64)


@router.get("", response_model=JobList, responses=NOT_MODIFIED)
def list_jobs(request: Request, service: ServiceDep, query: Annotated[JobQuery, Query()]) -> Response:
    """A page of the build jobs, newest first."""
    conditions = [Job.kind == "build"]
    conditions += [Job.state == query.state] if query.state else []
    conditions += [Job.tree_id == query.tree_id] if query.tree_id else []
    with service.sessions() as session:
        total = session.scalar(select(func.count(Job.id)).where(*conditions)) or 0
        if query.after:
            conditions.append(rows_after(ORDER, _sort_key(query.after), descending=True))
        statement = select(Job).where(*conditions).order_by(*(column.desc() for column in ORDER))
        jobs = session.scalars(statement.limit(query.limit + 1)).all()
        last = jobs[query.limit - 1] if len(jobs) > query.limit else None
        page = [JobOut.model_validate(job) for job in jobs[: query.limit]]
    cursor = encode_cursor([last.created_at.isoformat(), last.id]) if last else None
    return json_with_etag(request, JobList(jobs=page, total=total, next=cursor))


def _sort_key(cursor: str) -> tuple[datetime, str]:
    created_at, job_id = decode_cursor(cursor, 2)
    return cursor_time(created_at), job_id


STARTED = {
    200: {
        "model": JobOut,
        "description": "The tree's table was computed with exactly these settings; the job that computed it.",
    },
    **problems(404, 409, 413),
}


@router.post("", status_code=202, max_body_size=64 * 1024, responses=STARTED)
def start_job(body: JobRequest, service: ServiceDep, response: Response) -> JobOut:
    """Queue the computation of a tree's table; the settings override the tree's import options."""
    out, new = start_build(service, body.tree_id, body.settings.model_dump(exclude_none=True))
    response.status_code = 202 if new else 200
    response.headers["Location"] = f"/api/jobs/{out.id}"
    return out


def start_build(service: Service, tree_id: str, settings: dict[str, Any]) -> tuple[JobOut, bool]:
    """Queue a build unless the identical table exists. Returns the job and whether it is new.

    ProblemError 404, 409.
    """
    with service.sessions.begin() as session:
        tree = find_tree(session, tree_id)
        existing = _existing_build(tree, settings)
        out = JobOut.model_validate(existing or queue_job(session, tree, settings))
    service.wake_supervisor()
    return out, existing is None


def _existing_build(tree: Tree, settings: dict[str, Any]) -> Job | None:
    """The job that computed the current table, if a new build would give the same table.

    It may still be computing the paper's records or the bare table.
    """
    job = tree.job
    if job is None or tree.state != "ready" or job.settings != settings:
        return None
    if job.state != "done" and not (job.state == "running" and job.stage in AFTER_TABLE):
        return None
    unchanged = tree.fingerprint == fingerprint(tree.source_sha256, tree.options, settings)
    return job if unchanged else None


@router.post("/{job_id}/retry", status_code=202, responses={**STARTED})
def retry_job(job_id: str, service: ServiceDep, response: Response) -> JobOut:
    """Queue a failed or cancelled job again with its settings; it resumes from stored results."""
    with service.sessions() as session:
        job = find_job(session, job_id)
        tree_id, settings = job.tree_id, job.settings
    out, new = start_build(service, tree_id, settings)
    response.status_code = 202 if new else 200
    response.headers["Location"] = f"/api/jobs/{out.id}"
    return out


@router.get("/{job_id}")
def get_job(job_id: str, service: ServiceDep) -> JobOut:
    """The current state of a job."""
    with service.sessions() as session:
        return JobOut.model_validate(find_job(session, job_id))


@router.post("/{job_id}/cancel")
def cancel_job(job_id: str, service: ServiceDep) -> JobOut:
    """Cancel a job: a queued job ends at once, a running one within two seconds."""
    with service.sessions.begin() as session:
        job = find_job(session, job_id)
        request_cancel(session, job)
        out = JobOut.model_validate(job)
    service.wake_supervisor()
    return out
