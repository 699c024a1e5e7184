"""Shared by comparisons and evaluations: response model, queue limit, input check and result files."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Any

from fastapi import Request, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from galewood_server.http import IMMUTABLE_CACHE, ProblemError, etag_matches, not_found
from galewood_server.storage import ACTIVE_STATES, ANALYSIS_INPUTS, FileStore, Job, JobKind, JobState, Tree

MAX_ACTIVE = 8


class AnalysisOut(BaseModel):
    """An analysis job: its settings and, once it is done, its main figures (`result`)."""

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
    created_at: datetime
    updated_at: datetime


def analysis_fields(job: Job) -> dict[str, Any]:
    """The field values of an AnalysisOut."""
    return {name: getattr(job, name) for name in AnalysisOut.model_fields}


def computed_tree(session: Session, tree_id: str) -> Tree:
    """A tree that has a complete table. ProblemError 404, 409."""
    tree = session.get(Tree, tree_id)
    if tree is None:
        raise not_found("tree", tree_id)
    if not tree.table_sha256 or tree.preliminary:
        title, hint = "This tree has no complete table yet", "Compute the tree first."
        raise ProblemError(409, "not-computed", title, hint=hint)
    return tree


def analysis_settings(tree: Tree, request: dict[str, Any]) -> dict[str, Any]:
    """The settings of an analysis job: the request and the hashes of its input files."""
    return {**request, **{field: getattr(tree, field) for field in ANALYSIS_INPUTS}}


def check_queue_length(session: Session, kind: JobKind, most: int = MAX_ACTIVE) -> None:
    """Raise ProblemError 429 if too many jobs of a kind are queued or running."""
    waiting = select(func.count(Job.id)).where(Job.kind == kind, Job.state.in_(ACTIVE_STATES))
    if (session.scalar(waiting) or 0) >= most:
        title, hint = f"Too many {kind}s are queued", "Wait until one has finished, or cancel one."
        raise ProblemError(429, f"too-many-{kind}s", title, hint=hint)


def result_file(
    request: Request, store: FileStore, sha256: str | None, what: str, media_type: str
) -> Response:
    """An immutable result file of an analysis. ProblemError 404 until it exists."""
    if not sha256 or not store.has(sha256):
        hint = "Wait until the job is done."
        raise ProblemError(404, f"no-{what}", f"There is no {what} yet", hint=hint)
    headers = {"ETag": f'"{sha256}"', "Cache-Control": IMMUTABLE_CACHE}
    if etag_matches(request.headers.get("if-none-match", ""), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    path: Path = store.path(sha256)
    return FileResponse(path, media_type=media_type, headers=headers)
