"""Trees: listed, computed, deleted. How they come in is in uploading.py."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from fastapi import APIRouter, Request, Response
from sqlalchemy import case, func, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from galewood_server.context import Service, ServiceHere
from galewood_server.http import (
    NOT_MODIFIED,
    Asked,
    JobOut,
    PrecomputeRequest,
    ProblemError,
    TreeList,
    TreeOut,
    bad_cursor,
    beyond,
    cursor_of,
    not_found,
    parts_of,
    problems,
    tagged,
)
from galewood_server.jobs import queue_job
from galewood_server.storage import ACTIVE, FileStore, Tree, mark_tree_files

router = APIRouter(prefix="/api/trees", tags=["trees"])
ORDER = (case((Tree.builtin, 0), else_=1), Tree.created_at, Tree.id)


def tree_out(tree: Tree) -> TreeOut:
    """A tree as the interface shows it."""
    job = tree.job
    fields = {name: getattr(tree, name) for name in TreeOut.model_fields if name != "job_id"}
    return TreeOut(**fields, job_id=job.id if job else None)


def job_out(tree: Tree) -> JobOut | None:
    """The newest job of a tree."""
    return JobOut.model_validate(tree.job) if tree.job else None


@router.get("", response_model=TreeList, responses=NOT_MODIFIED)
def list_trees(request: Request, service: ServiceHere, asked: Asked) -> Response:
    """A page of the trees, the built-in species first, then by age."""
    with service.sessions() as session:
        rows = select(Tree).order_by(*ORDER).limit(asked.limit + 1)
        if asked.after:
            rows = rows.where(beyond(ORDER, _sort_key(asked.after)))
        trees = session.scalars(rows).all()
        total = session.scalar(select(func.count(Tree.id))) or 0
        more = cursor_of(_cursor_parts(trees[asked.limit - 1])) if len(trees) > asked.limit else None
        page = TreeList(trees=[tree_out(tree) for tree in trees[: asked.limit]], total=total, next=more)
    return tagged(request, page)


def _cursor_parts(tree: Tree) -> list[str]:
    return [str(int(not tree.builtin)), tree.created_at.isoformat(), tree.id]


def _sort_key(cursor: str) -> tuple[int, datetime, str]:
    uploaded, created_at, tree_id = parts_of(cursor, 3)
    try:
        return int(uploaded), datetime.fromisoformat(created_at), tree_id
    except ValueError:
        raise bad_cursor() from None


@router.get("/{tree_id}", response_model=TreeOut, responses={**NOT_MODIFIED, **problems(404)})
def get_tree(tree_id: str, request: Request, service: ServiceHere) -> Response:
    """One tree with the report of its intake."""
    with service.sessions() as session:
        return tagged(request, tree_out(find_tree(session, tree_id)))


@router.post(
    "/{tree_id}/precompute", status_code=202, max_body_size=64 * 1024, responses=problems(404, 409, 413)
)
def precompute_tree(tree_id: str, service: ServiceHere, body: PrecomputeRequest | None = None) -> JobOut:
    """Queue the computation of a tree's table."""
    settings = (body or PrecomputeRequest()).settings.model_dump(exclude_none=True)
    with service.sessions.begin() as session:
        answer = JobOut.model_validate(queue_job(session, find_tree(session, tree_id), settings))
    service.wake_supervisor()
    return answer


@router.delete("/{tree_id}", status_code=204, responses=problems(404, 409))
def delete_tree(tree_id: str, service: ServiceHere) -> Response:
    """Forget an uploaded tree with its jobs, and its files where no other tree shares them."""
    with service.files_lock, service.sessions.begin() as session:
        tree = find_tree(session, tree_id)
        if tree.builtin:
            raise ProblemError(
                403, "builtin-tree", "The built-in species stay", hint="Only uploads are deleted."
            )
        if any(job.state in ACTIVE for job in tree.jobs):
            raise ProblemError(
                409, "still-building", "This tree is being computed", hint="Cancel its job first."
            )
        mark_tree_files(session, tree)
        session.delete(tree)
        session.flush()
        _remove_files(session, service, tree)
    return Response(status_code=204)


def _remove_files(session: Session, service: Service, tree: Tree) -> None:
    remove_unshared(session, service.stores.sources, Tree.source_sha256, tree.source_sha256)
    remove_unshared(session, service.stores.meshes, Tree.mesh_sha256, tree.mesh_sha256)
    remove_unshared(session, service.stores.tables, Tree.table_sha256, tree.table_sha256)


def remove_unshared(
    session: Session, store: FileStore, column: InstrumentedAttribute[Any], sha256: str | None
) -> None:
    """Remove a file unless a tree names it in that column; hold `files_lock`."""
    if sha256 and not session.scalars(select(Tree.id).where(column == sha256)).first():
        store.remove(sha256)


def find_tree(session: Session, tree_id: str) -> Tree:
    """A tree by its name. ProblemError 404."""
    tree = session.get(Tree, tree_id)
    if tree is None:
        raise not_found("tree", tree_id)
    return tree
