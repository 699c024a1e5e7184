"""Evaluations: the error of a tree's table against the FEM reference solution under unseen winds."""

from __future__ import annotations

from typing import Any, Self

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse
from galewood.options import EVALUATION_FRAMES, EVALUATION_SEED, EvaluationSeed
from pydantic import BaseModel, ConfigDict, Field, model_validator
from sqlalchemy import select
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
from galewood_server.http import (
    EVENT_STREAM,
    NOT_MODIFIED,
    ProblemError,
    contents,
    not_found,
    problems,
    serialisable,
)
from galewood_server.jobs import PLOT_FILE, add_job, find_job, request_cancel
from galewood_server.storage import ACTIVE_STATES, Job, Tree, forget_old_analyses

router = APIRouter(prefix="/api", tags=["evaluations"])
JSON_CONTENT: dict[str, Any] = {"application/json": {"schema": {"type": "object"}}}


class EvaluationRequest(BaseModel):
    """Body of POST /api/trees/{id}/evaluations. The tree is evaluated in gusts that differ within its crown,
    then in winds that are the same over the whole crown. Their strength is given by sway; or that of the
    uniform winds by their peak speed, by default 0.65 of the table's design speed."""

    model_config = ConfigDict(extra="forbid")

    sway: float | None = Field(
        default=None,
        ge=0.005,
        le=0.5,
        description="Sway of the tree under each wind, as a fraction of its height.",
    )
    speed_m_s: float | None = Field(
        default=None, ge=0.5, le=60, description="Peak speed of each uniform wind."
    )
    frames: int = Field(
        default=EVALUATION_FRAMES, ge=60, le=1800, description="Frames per wind, 1/30 s each."
    )
    seed: EvaluationSeed = EVALUATION_SEED

    @model_validator(mode="after")
    def _one_strength(self) -> Self:
        if self.sway is not None and self.speed_m_s is not None:
            raise ValueError("set either sway or speed_m_s, not both")
        return self


class EvaluationOut(AnalysisOut):
    """An evaluation job: its settings and, once it is done, the main figures in gusts and in uniform winds
    (`result`) and the URLs of the full report (`report`) and of the error plot (`plot`)."""

    report: str | None
    plot: str | None


class EvaluationList(BaseModel):
    """The evaluations of a tree, newest first. Only the newest are kept. `damaged`: ids of records that
    cannot be read and are left out; `total` counts them."""

    evaluations: list[EvaluationOut]
    total: int
    damaged: list[str]


def evaluation_out(job: Job) -> EvaluationOut:
    """The response model of an evaluation."""
    address = f"/api/evaluations/{job.id}"
    return EvaluationOut(
        **analysis_fields(job),
        report=f"{address}/report" if job.result_sha256 else None,
        plot=f"{address}/plot" if PLOT_FILE in job.pictures else None,
    )


RESPONSES: dict[int | str, dict[str, Any]] = {
    200: {"model": EvaluationOut, "description": "An identical evaluation of this table already exists."},
    **problems(404, 409, 413, 429),
}


@router.post("/trees/{tree_id}/evaluations", status_code=202, max_body_size=64 * 1024, responses=RESPONSES)
def evaluate_tree(
    tree_id: str, response: Response, service: ServiceDep, body: EvaluationRequest | None = None
) -> EvaluationOut:
    """Queue an evaluation like `galewood evaluate`. It runs in its own process, concurrently with builds."""
    given = (body or EvaluationRequest()).model_dump(exclude_none=True)
    with service.sessions.begin() as session:
        tree = computed_tree(session, tree_id)
        settings = analysis_settings(tree, given)
        job = _find_same(tree, settings)
        response.status_code = 200 if job else 202
        if job is None:
            check_queue_length(session, "evaluation")
            forget_old_analyses(session, tree, "evaluation")
            job = add_job(session, tree, "evaluation", settings)
        out = serialisable(evaluation_out(job))
    response.headers["Location"] = f"/api/evaluations/{out.id}"
    service.wake_supervisor()
    return out


def _find_same(tree: Tree, settings: dict[str, Any]) -> Job | None:
    """The newest evaluation with the same settings of the same files that has not failed."""
    return next(
        (
            job
            for job in reversed(tree.jobs)
            if job.kind == "evaluation" and job.settings == settings and job.state in (*ACTIVE_STATES, "done")
            and not job.cancel_requested
        ),
        None,
    )  # fmt: skip


@router.get("/trees/{tree_id}/evaluations", responses=problems(404))
def list_evaluations(tree_id: str, service: ServiceDep) -> EvaluationList:
    """The evaluations of a tree, newest first."""
    found: list[EvaluationOut] = []
    left_out: list[str] = []
    with service.sessions() as session:
        if session.execute(select(Tree.id).where(Tree.id == tree_id)).first() is None:
            raise not_found("tree", tree_id)
        names = select(Job.id).where(Job.tree_id == tree_id, Job.kind == "evaluation")
        for name in session.scalars(names.order_by(Job.created_at.desc(), Job.id.desc())).all():
            try:
                found.append(serialisable(evaluation_out(find_job(session, name, "evaluation"))))
            except (ValueError, ProblemError):
                left_out.append(name)
    return EvaluationList(evaluations=found, total=len(found) + len(left_out), damaged=left_out)


@router.get("/evaluations/{evaluation_id}", responses=problems(404))
def get_evaluation(evaluation_id: str, service: ServiceDep) -> EvaluationOut:
    """The current state of an evaluation."""
    with service.sessions() as session:
        return evaluation_out(find_job(session, evaluation_id, "evaluation"))


@router.post("/evaluations/{evaluation_id}/cancel", responses=problems(404))
def cancel_evaluation(evaluation_id: str, service: ServiceDep) -> EvaluationOut:
    """Cancel an evaluation."""
    with service.sessions.begin() as session:
        out = serialisable(evaluation_out(request_cancel(session, evaluation_id, "evaluation")))
    service.wake_supervisor()
    return out


@router.get(
    "/evaluations/{evaluation_id}/events",
    response_class=EventSourceResponse,
    responses={**EVENT_STREAM, **problems(404)},
)
def evaluation_events(evaluation_id: str, request: Request, service: ServiceDep) -> EventSourceResponse:
    """Server-sent events named "progress" with the evaluation, until it ends."""

    def read() -> EvaluationOut:
        return get_evaluation(evaluation_id, service)

    read()  # 404 before the stream begins
    return stream(service, follow_job(feed_of(request), read))


@router.get(
    "/evaluations/{evaluation_id}/report",
    response_class=FileResponse,
    responses={200: {"content": JSON_CONTENT}, **NOT_MODIFIED, **problems(404)},
)
def get_report(evaluation_id: str, request: Request, service: ServiceDep) -> Response:
    """The full report: all figures by wind, method and frame (spec/formats/evaluation.md)."""
    with service.sessions() as session:
        sha256 = find_job(session, evaluation_id, "evaluation").result_sha256
    return result_file(request, service.stores.results, sha256, "report", "application/json")


@router.get(
    "/evaluations/{evaluation_id}/plot",
    response_class=FileResponse,
    responses={**contents("The plot.", "image/png"), **NOT_MODIFIED, **problems(404)},
)
def get_plot(evaluation_id: str, request: Request, service: ServiceDep) -> Response:
    """The plot of the errors over time (PNG)."""
    with service.sessions() as session:
        sha256 = find_job(session, evaluation_id, "evaluation").pictures.get(PLOT_FILE)
    return result_file(request, service.stores.pictures, sha256, "plot", "image/png")
