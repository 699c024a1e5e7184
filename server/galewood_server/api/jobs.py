"""Build jobs: start, list, retry and cancel. jobs/supervisor.py runs them."""

from __future__ import annotations

from datetime import datetime
from functools import lru_cache
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from galewood.constants import STAGES_AFTER_TABLE
from sqlalchemy import func, select

from galewood_server.api.trees import KEPT_ROWS, find_tree, job_out
from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    NOT_MODIFIED,
    JobList,
    JobOut,
    JobRequest,
    PageQuery,
    cursor_of_time,
    cursor_time,
    damaged,
    decode_cursor,
    not_found,
    paged,
    problems,
    read_page,
    row_as_json,
    rows_after,
)
from galewood_server.jobs import find_job, fingerprint, queue_job, request_cancel
from galewood_server.storage import JOB_FIELDS, TABLE_JOBS, Job, JobKind, JobState, RawRow, Tree, job_rows

router = APIRouter(prefix="/api/jobs", tags=["jobs"])
ORDER_COLUMNS = (Job.created_at, Job.id)
LIST_QUERY = paged(job_rows().order_by(*(column.desc() for column in ORDER_COLUMNS)))


@lru_cache(maxsize=KEPT_ROWS)
def job_json(row: RawRow) -> bytes | None:
    """A row of `job_rows` as JSON; None, with its id in the log, if it is damaged. Serialised once."""
    return row_as_json("job", JobOut, dict(zip(JOB_FIELDS, row, strict=True)))


class JobQuery(PageQuery):
    """Query parameters of the job list: page, state and tree."""

    state: JobState | None = Query(default=None)
    tree_id: str | None = Query(default=None, max_length=64)


@router.get("", response_model=JobList, responses=NOT_MODIFIED)
def list_jobs(request: Request, service: ServiceDep, query: Annotated[JobQuery, Query()]) -> Response:
    """A page of the build jobs, newest first."""
    conditions = [Job.state == query.state] if query.state else []
    conditions += [Job.tree_id == query.tree_id] if query.tree_id else []
    count = select(func.count(Job.id)).where(Job.kind.in_(TABLE_JOBS), *conditions)
    if query.after:
        conditions.append(rows_after(ORDER_COLUMNS, _sort_key(query.after), descending=True))
    with service.sessions() as session:
        page = read_page(
            session, LIST_QUERY.where(*conditions) if conditions else LIST_QUERY, count, query, job_json
        )
    return page.response(request, "jobs", _cursor_parts)


def _cursor_parts(row: RawRow) -> list[str]:
    found = dict(zip(JOB_FIELDS, row, strict=True))
    return [cursor_of_time(found["created_at"]), found["id"]]


def _sort_key(cursor: str) -> tuple[datetime, str]:
    created_at, job_id = decode_cursor(cursor, 2)
    return cursor_time(created_at), job_id


STARTED_RESPONSES = {
    200: {
        "model": JobOut,
        "description": "The tree's table was computed with exactly these settings; the job that computed it.",
    },
    **problems(404, 409, 413),
}


@router.post("", status_code=202, max_body_size=64 * 1024, responses=STARTED_RESPONSES)
def start_job(body: JobRequest, service: ServiceDep, response: Response) -> JobOut:
    """Queue the computation of a tree's table; the settings override the tree's import options."""
    out, new = start_build(service, body.tree_id, body.settings.given())
    response.status_code = 202 if new else 200
    response.headers["Location"] = f"/api/jobs/{out.id}"
    return out


def start_build(
    service: Service, tree_id: str, settings: dict[str, Any], kind: JobKind = "build"
) -> tuple[JobOut, bool]:
    """Queue a job of TABLE_JOBS unless the identical table exists. Returns the job and whether it is new.

    ProblemError 404, 409.
    """
    with service.sessions.begin() as session:
        tree = find_tree(session, tree_id)
        existing = existing_build(service, tree, settings)
        out = job_out(existing or queue_job(session, tree, settings, kind))
    service.wake_supervisor()
    return out, existing is None


def existing_build(service: Service, tree: Tree, settings: dict[str, Any]) -> Job | None:
    """The job that computed the current table, if a new build would give the same table.

    It may still be computing the paper's records or the bare table.
    """
    job = tree.job
    if job is None or tree.state != "ready" or job.settings != settings:
        return None
    if job.state != "done" and not (job.state == "running" and job.stage in STAGES_AFTER_TABLE):
        return None
    unchanged = tree.fingerprint == fingerprint(tree.source_sha256, tree.options, settings)
    return job if unchanged and _is_intact(service, tree.table_sha256 or "") else None


def _is_intact(service: Service, table_sha256: str) -> bool:
    """Whether a table's file is there and not damaged: a build replaces it otherwise."""
    try:
        return service.stores.tables.is_intact(table_sha256)
    except OSError:
        return False


@router.post("/{job_id}/retry", status_code=202, responses={**STARTED_RESPONSES})
def retry_job(job_id: str, service: ServiceDep, response: Response) -> JobOut:
    """Queue a failed or cancelled job again with its settings; it resumes from stored results."""
    with service.sessions() as session:
        job = find_job(session, job_id)
        tree_id, settings, kind = job.tree_id, job.settings, job.kind
    out, new = start_build(service, tree_id, settings, kind)
    response.status_code = 202 if new else 200
    response.headers["Location"] = f"/api/jobs/{out.id}"
    return out


@router.get("/{job_id}", response_model=JobOut)
def get_job(job_id: str, service: ServiceDep) -> Response:
    """The current state of a job."""
    with service.sessions() as session:
        row = session.execute(job_rows().where(Job.id == job_id)).one_or_none()
    if row is None:
        raise not_found("job", job_id)
    body = job_json(tuple(row))
    if body is None:
        raise damaged("job", job_id, "Delete its tree, then upload its file again.")
    return Response(body, media_type="application/json")


@router.post("/{job_id}/cancel")
def cancel_job(job_id: str, service: ServiceDep) -> JobOut:
    """Cancel a job: a queued job ends at once, a running one within two seconds."""
    with service.sessions.begin() as session:
        out = job_out(request_cancel(session, job_id))
    service.wake_supervisor()
    return out
