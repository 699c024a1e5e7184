"""Comparisons: one tree's motion under one wind by FEM and by the methods of its table."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse
from galewood.motion.wind import parse_wind_or_state
from pydantic import BaseModel, ConfigDict, Field
from sse_starlette import EventSourceResponse

from galewood_server.api.analyses.common import (
    AnalysisOut,
    analysis_fields,
    analysis_settings,
    check_queue_length,
    computed_tree,
    result_file,
)
from galewood_server.api.events import feed_of, follow_job, stream
from galewood_server.context import ServiceDep
from galewood_server.http import EVENT_STREAM, NOT_MODIFIED, contents, problems, serialisable
from galewood_server.jobs import add_job, find_job, request_cancel
from galewood_server.storage import Job, forget_old_analyses

router = APIRouter(prefix="/api", tags=["comparisons"])


class ComparisonRequest(BaseModel):
    """Body of POST /api/trees/{id}/comparisons: a wind document (spec/formats/wind.md) or the state of a wind
    transition, the tree's position and rotation, the start time and the number of frames."""

    model_config = ConfigDict(extra="forbid")

    wind: dict[str, Any]
    x_m: float = Field(default=0.0, ge=-1e5, le=1e5)
    z_m: float = Field(default=0.0, ge=-1e5, le=1e5)
    yaw_rad: float = Field(default=0.0, ge=-100, le=100)
    start_s: float = Field(default=0.0, ge=0, le=1e6)
    frames: int = Field(default=300, ge=2, le=600)


class ComparisonOut(AnalysisOut):
    """A comparison job: its settings and, once it is done, the largest errors and the URL of the tracks."""

    tracks: str | None


def comparison_out(job: Job) -> ComparisonOut:
    """The response model of a comparison."""
    tracks = f"/api/comparisons/{job.id}/tracks" if job.result_sha256 else None
    return ComparisonOut(**analysis_fields(job), tracks=tracks)


@router.post(
    "/trees/{tree_id}/comparisons",
    status_code=202,
    max_body_size=64 * 1024,
    responses=problems(404, 409, 413, 429),
)
def compare_tree(
    tree_id: str, body: ComparisonRequest, response: Response, service: ServiceDep
) -> ComparisonOut:
    """Queue a comparison. It runs in its own process, concurrently with builds."""
    parse_wind_or_state(body.wind)
    with service.sessions.begin() as session:
        tree = computed_tree(session, tree_id)
        check_queue_length(session, "comparison")
        forget_old_analyses(session, tree, "comparison")
        job = add_job(session, tree, "comparison", analysis_settings(tree, body.model_dump()))
        out = serialisable(comparison_out(job))
    response.headers["Location"] = f"/api/comparisons/{out.id}"
    service.wake_supervisor()
    return out


@router.get("/comparisons/{comparison_id}", responses=problems(404))
def get_comparison(comparison_id: str, service: ServiceDep) -> ComparisonOut:
    """The current state of a comparison."""
    with service.sessions() as session:
        return comparison_out(find_job(session, comparison_id, "comparison"))


@router.post("/comparisons/{comparison_id}/cancel", responses=problems(404))
def cancel_comparison(comparison_id: str, service: ServiceDep) -> ComparisonOut:
    """Cancel a comparison."""
    with service.sessions.begin() as session:
        out = serialisable(comparison_out(request_cancel(session, comparison_id, "comparison")))
    service.wake_supervisor()
    return out


@router.get(
    "/comparisons/{comparison_id}/events",
    response_class=EventSourceResponse,
    responses={**EVENT_STREAM, **problems(404)},
)
def comparison_events(comparison_id: str, request: Request, service: ServiceDep) -> EventSourceResponse:
    """Server-sent events named "progress" with the comparison, until it ends."""

    def read() -> ComparisonOut:
        return get_comparison(comparison_id, service)

    read()  # 404 before the stream begins
    return stream(service, follow_job(feed_of(request), read))


@router.get(
    "/comparisons/{comparison_id}/tracks",
    response_class=FileResponse,
    responses={**contents("The tracks.", "application/msgpack"), **NOT_MODIFIED, **problems(404)},
)
def get_tracks(comparison_id: str, request: Request, service: ServiceDep) -> Response:
    """The motion by each method (spec/formats/comparison.md)."""
    with service.sessions() as session:
        sha256 = find_job(session, comparison_id, "comparison").result_sha256
    return result_file(request, service.stores.results, sha256, "tracks", "application/msgpack")
