"""What comparisons and evaluations have in common: who may be studied, what it looks like, its files."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Any

from fastapi import Request, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from galewood_server.api.artefacts import FOREVER
from galewood_server.http import ProblemError, matches, not_found
from galewood_server.storage import ACTIVE, ASKED, FileStore, Job, JobKind, JobState, Tree

MOST_WAITING = 8


class AnalysisOut(BaseModel):
    """A study: a job with what was asked and, once done, the largest figures."""

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


def fields_of(job: Job) -> dict[str, Any]:
    """The values of a StudyOut."""
    return {name: getattr(job, name) for name in AnalysisOut.model_fields}


def analysed_tree(session: Session, tree_id: str) -> Tree:
    """A tree with table and model. ProblemError 404, 409."""
    tree = session.get(Tree, tree_id)
    if tree is None:
        raise not_found("tree", tree_id)
    if not tree.table_sha256 or not tree.model_sha256:
        title, hint = "This tree has no table to compare yet", "Compute the tree first."
        raise ProblemError(409, "not-computed", title, hint=hint)
    return tree


def order_of(tree: Tree, asked: dict[str, Any]) -> dict[str, Any]:
    """The settings of a study: what was asked, and of which files."""
    return {**asked, **{field: getattr(tree, field) for field in ASKED}}


def need_place_in_queue(session: Session, kind: JobKind) -> None:
    """ProblemError 429 while too many wait."""
    waiting = select(func.count(Job.id)).where(Job.kind == kind, Job.state.in_(ACTIVE))
    if (session.scalar(waiting) or 0) >= MOST_WAITING:
        title, hint = f"Too many {kind}s are waiting", "Wait for one to end, or cancel one."
        raise ProblemError(429, f"too-many-{kind}s", title, hint=hint)


def kept_file(request: Request, store: FileStore, sha256: str | None, what: str, media_type: str) -> Response:
    """A file of a study, which never changes. ProblemError 404 until it is there."""
    if not sha256 or not store.has(sha256):
        hint = "Follow the study until it is done."
        raise ProblemError(404, f"no-{what}", f"There is no {what} yet", hint=hint)
    headers = {"ETag": f'"{sha256}"', "Cache-Control": FOREVER}
    if matches(request.headers.get("if-none-match", ""), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    path: Path = store.path(sha256)
    return FileResponse(path, media_type=media_type, headers=headers)
