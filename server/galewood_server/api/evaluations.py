"""Evaluations: how far a tree's table is from the finite elements, under winds that it was not made from."""

from __future__ import annotations

from typing import Any, Self

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel, ConfigDict, Field, model_validator
from sse_starlette import EventSourceResponse

from galewood_server.api.analyses import (
    AnalysisOut,
    analysed_tree,
    fields_of,
    kept_file,
    need_place_in_queue,
    order_of,
)
from galewood_server.api.artefacts import BINARY
from galewood_server.api.events import feed_of, follow_job, stream
from galewood_server.api.trees import find_tree
from galewood_server.context import ServiceHere
from galewood_server.http import NOT_MODIFIED, problems
from galewood_server.jobs import PLOT, add_job, find_job, request_cancel
from galewood_server.storage import ACTIVE, Job, Tree, forget_old_analyses

router = APIRouter(prefix="/api", tags=["evaluations"])
JSON: dict[str, Any] = {"application/json": {"schema": {"type": "object"}}}


class EvaluationRequest(BaseModel):
    """Body of POST /api/trees/{id}/evaluations: how strong the winds are, by what they do or by their speed;
    without either they peak at 0.65 of the speed that the table was made for."""

    model_config = ConfigDict(extra="forbid")

    sway: float | None = Field(
        default=None, ge=0.005, le=0.5, description="Each wind sways the tree by this share of its height."
    )
    speed_m_s: float | None = Field(default=None, ge=0.5, le=60, description="Each wind peaks at this speed.")
    frames: int = Field(default=300, ge=60, le=1800, description="Of each wind, 1/30 s each.")
    seed: int = Field(default=20_001, ge=0, lt=2**31, description="Turns and times the winds.")

    @model_validator(mode="after")
    def _one_strength(self) -> Self:
        if self.sway is not None and self.speed_m_s is not None:
            raise ValueError("give sway or speed_m_s, not both")
        return self


class EvaluationOut(AnalysisOut):
    """An evaluation: a job with what was asked and, once done, its main figures by wind and method
    (`result`), the address of all figures (`report`) and of their picture (`plot`)."""

    report: str | None
    plot: str | None


class EvaluationList(BaseModel):
    """The evaluations of a tree, the newest first; only so many are kept."""

    evaluations: list[EvaluationOut]
    total: int


def evaluation_out(job: Job) -> EvaluationOut:
    """An evaluation as the interface shows it."""
    address = f"/api/evaluations/{job.id}"
    return EvaluationOut(
        **fields_of(job),
        report=f"{address}/report" if job.result_sha256 else None,
        plot=f"{address}/plot" if PLOT in job.pictures else None,
    )


QUEUED: dict[int | str, dict[str, Any]] = {
    200: {"model": EvaluationOut, "description": "This table was, or is being, evaluated exactly so."},
    **problems(404, 409, 413, 429),
}


@router.post("/trees/{tree_id}/evaluations", status_code=202, max_body_size=64 * 1024, responses=QUEUED)
def evaluate_tree(
    tree_id: str, response: Response, service: ServiceHere, body: EvaluationRequest | None = None
) -> EvaluationOut:
    """Queue an evaluation: what `galewood evaluate` does, in a process of its own, beside any build."""
    asked = (body or EvaluationRequest()).model_dump(exclude_none=True)
    with service.sessions.begin() as session:
        tree = analysed_tree(session, tree_id)
        order = order_of(tree, asked)
        job = _same(tree, order)
        response.status_code = 200 if job else 202
        if job is None:
            need_place_in_queue(session, "evaluation")
            forget_old_analyses(session, tree, "evaluation")
            job = add_job(session, tree, "evaluation", order)
        answer = evaluation_out(job)
    response.headers["Location"] = f"/api/evaluations/{answer.id}"
    service.wake_supervisor()
    return answer


def _same(tree: Tree, order: dict[str, Any]) -> Job | None:
    """The evaluation that was asked for in the same words of the same table and has not failed."""
    return next(
        (
            job
            for job in reversed(tree.jobs)
            if job.kind == "evaluation" and job.settings == order and job.state in (*ACTIVE, "done")
            and not job.cancel_requested
        ),
        None,
    )  # fmt: skip


@router.get("/trees/{tree_id}/evaluations", responses=problems(404))
def list_evaluations(tree_id: str, service: ServiceHere) -> EvaluationList:
    """The evaluations of a tree, the newest first."""
    with service.sessions() as session:
        jobs = [job for job in reversed(find_tree(session, tree_id).jobs) if job.kind == "evaluation"]
        return EvaluationList(evaluations=[evaluation_out(job) for job in jobs], total=len(jobs))


@router.get("/evaluations/{evaluation_id}", responses=problems(404))
def get_evaluation(evaluation_id: str, service: ServiceHere) -> EvaluationOut:
    """One evaluation as it stands."""
    with service.sessions() as session:
        return evaluation_out(find_job(session, evaluation_id, "evaluation"))


@router.post("/evaluations/{evaluation_id}/cancel", responses=problems(404))
def cancel_evaluation(evaluation_id: str, service: ServiceHere) -> EvaluationOut:
    """Ask an evaluation to stop, as a job."""
    with service.sessions.begin() as session:
        job = find_job(session, evaluation_id, "evaluation")
        request_cancel(session, job)
        answer = evaluation_out(job)
    service.wake_supervisor()
    return answer


@router.get(
    "/evaluations/{evaluation_id}/events", response_class=EventSourceResponse, responses=problems(404)
)
def evaluation_events(evaluation_id: str, request: Request, service: ServiceHere) -> EventSourceResponse:
    """Events named "progress" with the evaluation, until it ends."""

    def read() -> EvaluationOut:
        return get_evaluation(evaluation_id, service)

    read()  # 404 before the stream begins
    return stream(follow_job(feed_of(request), read))


@router.get(
    "/evaluations/{evaluation_id}/report",
    response_class=FileResponse,
    responses={200: {"content": JSON}, **NOT_MODIFIED, **problems(404)},
)
def get_report(evaluation_id: str, request: Request, service: ServiceHere) -> Response:
    """All figures, by wind and method, frame by frame, and what each means (docs/formats/evaluation.md)."""
    with service.sessions() as session:
        sha256 = find_job(session, evaluation_id, "evaluation").result_sha256
    return kept_file(request, service.stores.results, sha256, "report", "application/json")


@router.get(
    "/evaluations/{evaluation_id}/plot",
    response_class=FileResponse,
    responses={200: {"content": {"image/png": BINARY}}, **NOT_MODIFIED, **problems(404)},
)
def get_plot(evaluation_id: str, request: Request, service: ServiceHere) -> Response:
    """The errors over time as a picture (PNG)."""
    with service.sessions() as session:
        sha256 = find_job(session, evaluation_id, "evaluation").pictures.get(PLOT)
    return kept_file(request, service.stores.pictures, sha256, "plot", "image/png")
