"""Comparisons: one tree's motion under one wind, by the finite elements and by both methods of its table."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel, ConfigDict, Field
from sqlalchemy import func, select
from sqlalchemy.orm import Session
from sse_starlette import EventSourceResponse

from precompute.wind import parse_wind_or_state
from server.artefacts import FOREVER
from server.context import ServiceHere
from server.errors import ProblemError, not_found, problems
from server.etags import NOT_MODIFIED, matches
from server.events import feed_of, follow_job, stream
from server.jobs import add_job, find_job, request_cancel
from server.models import ACTIVE, Job, JobState, Tree
from server.retired import forget_old_studies

router = APIRouter(prefix="/api", tags=["comparisons"])
MOST_WAITING = 8


class ComparisonRequest(BaseModel):
    """Body of POST /api/trees/{id}/comparisons: a wind document (docs/formats/wind.md) or the state of a wind
    that glides, where the tree stands in it, and when it begins."""

    model_config = ConfigDict(extra="forbid")

    wind: dict[str, Any]
    x_m: float = Field(default=0.0, ge=-1e5, le=1e5)
    z_m: float = Field(default=0.0, ge=-1e5, le=1e5)
    yaw_rad: float = Field(default=0.0, ge=-100, le=100)
    start_s: float = Field(default=0.0, ge=0, le=1e6)
    frames: int = Field(default=300, ge=2, le=600)


class ComparisonOut(BaseModel):
    """A comparison: a job with what was asked and, once done, the largest figures and the tracks' address."""

    id: str
    tree_id: str
    state: JobState
    stage: str
    fraction: float
    message: str
    seconds_left: float | None
    error: str | None
    settings: dict[str, Any]
    result: dict[str, Any] | None
    tracks: str | None
    created_at: datetime
    updated_at: datetime


def comparison_out(job: Job) -> ComparisonOut:
    """A comparison as the interface shows it."""
    fields = {name: getattr(job, name) for name in ComparisonOut.model_fields if name != "tracks"}
    tracks = f"/api/comparisons/{job.id}/tracks" if job.result_sha256 else None
    return ComparisonOut(**fields, tracks=tracks)


@router.post(
    "/trees/{tree_id}/comparisons",
    status_code=202,
    max_body_size=64 * 1024,
    responses=problems(404, 409, 413, 429),
)
def compare_tree(
    tree_id: str, body: ComparisonRequest, response: Response, service: ServiceHere
) -> ComparisonOut:
    """Queue a comparison; the finite elements run in a process of their own, beside any build."""
    parse_wind_or_state(body.wind)
    with service.sessions.begin() as session:
        tree = _comparable(session, tree_id)
        asked = {**body.model_dump(), "table_sha256": tree.table_sha256, "model_sha256": tree.model_sha256}
        forget_old_studies(session, tree)
        job = add_job(session, tree, "comparison", asked)
        answer = comparison_out(job)
    response.headers["Location"] = f"/api/comparisons/{answer.id}"
    service.wake_supervisor()
    return answer


def _comparable(session: Session, tree_id: str) -> Tree:
    """A tree with table and model, while not too many wait. ProblemError."""
    tree = session.get(Tree, tree_id)
    if tree is None:
        raise not_found("tree", tree_id)
    if not tree.table_sha256 or not tree.model_sha256:
        title, hint = "This tree has no table to compare yet", "Compute the tree first."
        raise ProblemError(409, "not-computed", title, hint=hint)
    waiting = select(func.count(Job.id)).where(Job.kind == "comparison", Job.state.in_(ACTIVE))
    if (session.scalar(waiting) or 0) >= MOST_WAITING:
        title, hint = "Too many comparisons are waiting", "Wait for one to end, or cancel one."
        raise ProblemError(429, "too-many-comparisons", title, hint=hint)
    return tree


@router.get("/comparisons/{comparison_id}", responses=problems(404))
def get_comparison(comparison_id: str, service: ServiceHere) -> ComparisonOut:
    """One comparison as it stands."""
    with service.sessions() as session:
        return comparison_out(find_job(session, comparison_id, "comparison"))


@router.post("/comparisons/{comparison_id}/cancel", responses=problems(404))
def cancel_comparison(comparison_id: str, service: ServiceHere) -> ComparisonOut:
    """Ask a comparison to stop, as a job."""
    with service.sessions.begin() as session:
        job = find_job(session, comparison_id, "comparison")
        request_cancel(session, job)
        answer = comparison_out(job)
    service.wake_supervisor()
    return answer


@router.get(
    "/comparisons/{comparison_id}/events", response_class=EventSourceResponse, responses=problems(404)
)
def comparison_events(comparison_id: str, request: Request, service: ServiceHere) -> EventSourceResponse:
    """Events named "progress" with the comparison, until it ends."""

    def read() -> ComparisonOut:
        return get_comparison(comparison_id, service)

    read()  # 404 before the stream begins
    return stream(follow_job(feed_of(request), read))


@router.get(
    "/comparisons/{comparison_id}/tracks",
    response_class=FileResponse,
    responses={**NOT_MODIFIED, **problems(404)},
)
def get_tracks(comparison_id: str, request: Request, service: ServiceHere) -> Response:
    """The motion by each way (docs/formats/comparison.md)."""
    with service.sessions() as session:
        sha256 = find_job(session, comparison_id, "comparison").result_sha256
    if not sha256 or not service.stores.results.has(sha256):
        title, hint = "There are no tracks yet", "Follow the comparison until it is done."
        raise ProblemError(404, "no-tracks", title, hint=hint)
    headers = {"ETag": f'"{sha256}"', "Cache-Control": FOREVER}
    if matches(request.headers.get("if-none-match", ""), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    path = service.stores.results.path(sha256)
    return FileResponse(path, media_type="application/msgpack", headers=headers)
