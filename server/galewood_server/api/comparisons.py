"""Comparisons: one tree's motion under one wind, by the finite elements and by both methods of its table."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse
from galewood.wind import parse_wind_or_state
from pydantic import BaseModel, ConfigDict, Field
from sse_starlette import EventSourceResponse

from galewood_server.api.analyses import (
    AnalysisOut,
    analysed_tree,
    fields_of,
    kept_file,
    need_place_in_queue,
    order_of,
)
from galewood_server.api.events import feed_of, follow_job, stream
from galewood_server.context import ServiceHere
from galewood_server.http import NOT_MODIFIED, problems
from galewood_server.jobs import add_job, find_job, request_cancel
from galewood_server.storage import Job, forget_old_analyses

router = APIRouter(prefix="/api", tags=["comparisons"])


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


class ComparisonOut(AnalysisOut):
    """A comparison: a job with what was asked and, once done, the largest figures and the tracks' address."""

    tracks: str | None


def comparison_out(job: Job) -> ComparisonOut:
    """A comparison as the interface shows it."""
    tracks = f"/api/comparisons/{job.id}/tracks" if job.result_sha256 else None
    return ComparisonOut(**fields_of(job), tracks=tracks)


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
        tree = analysed_tree(session, tree_id)
        need_place_in_queue(session, "comparison")
        forget_old_analyses(session, tree, "comparison")
        job = add_job(session, tree, "comparison", order_of(tree, body.model_dump()))
        answer = comparison_out(job)
    response.headers["Location"] = f"/api/comparisons/{answer.id}"
    service.wake_supervisor()
    return answer


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
    return kept_file(request, service.stores.results, sha256, "tracks", "application/msgpack")
