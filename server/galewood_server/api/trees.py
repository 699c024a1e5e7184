"""Trees: list, compute and delete. uploads.py adds them."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import Any

from fastapi import APIRouter, Request, Response
from sqlalchemy import case, func, or_, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    NOT_MODIFIED,
    JobOut,
    PageParams,
    PrecomputeRequest,
    ProblemError,
    TreeList,
    TreeOut,
    cursor_time,
    decode_cursor,
    encode_cursor,
    invalid_cursor,
    json_with_etag,
    not_found,
    problems,
    rows_after,
)
from galewood_server.jobs import queue_job
from galewood_server.storage import ACTIVE, FileStore, Tree, mark_tree_files

router = APIRouter(prefix="/api/trees", tags=["trees"])
ORDER = (case((Tree.builtin, 0), else_=1), Tree.created_at, Tree.id)


def tree_out(tree: Tree) -> TreeOut:
    """The response model of a tree."""
    job = tree.job
    fields = {name: getattr(tree, name) for name in TreeOut.model_fields if name != "job_id"}
    return TreeOut(**fields, job_id=job.id if job else None)


def job_out(tree: Tree) -> JobOut | None:
    """The newest build job of a tree."""
    return JobOut.model_validate(tree.job) if tree.job else None


@router.get("", response_model=TreeList, responses=NOT_MODIFIED)
def list_trees(request: Request, service: ServiceDep, query: PageParams) -> Response:
    """A page of the trees: built-in trees first, then uploads by age."""
    with service.sessions() as session:
        rows = select(Tree).order_by(*ORDER).limit(query.limit + 1)
        if query.after:
            rows = rows.where(rows_after(ORDER, _sort_key(query.after)))
        trees = session.scalars(rows).all()
        total = session.scalar(select(func.count(Tree.id))) or 0
        cursor = encode_cursor(_cursor_parts(trees[query.limit - 1])) if len(trees) > query.limit else None
        page = TreeList(trees=[tree_out(tree) for tree in trees[: query.limit]], total=total, next=cursor)
    return json_with_etag(request, page)


def _cursor_parts(tree: Tree) -> list[str]:
    return [str(int(not tree.builtin)), tree.created_at.isoformat(), tree.id]


def _sort_key(cursor: str) -> tuple[int, datetime, str]:
    uploaded, created_at, tree_id = decode_cursor(cursor, 3)
    if uploaded not in ("0", "1"):
        raise invalid_cursor()
    return int(uploaded), cursor_time(created_at), tree_id


@router.get("/{tree_id}", response_model=TreeOut, responses={**NOT_MODIFIED, **problems(404)})
def get_tree(tree_id: str, request: Request, service: ServiceDep) -> Response:
    """A tree with its mesh import report."""
    with service.sessions() as session:
        return json_with_etag(request, tree_out(find_tree(session, tree_id)))


@router.post(
    "/{tree_id}/precompute", status_code=202, max_body_size=64 * 1024, responses=problems(404, 409, 413)
)
def precompute_tree(
    tree_id: str, service: ServiceDep, response: Response, body: PrecomputeRequest | None = None
) -> JobOut:
    """Queue the computation of a tree's table."""
    settings = (body or PrecomputeRequest()).settings.model_dump(exclude_none=True)
    with service.sessions.begin() as session:
        out = JobOut.model_validate(queue_job(session, find_tree(session, tree_id), settings))
    response.headers["Location"] = f"/api/jobs/{out.id}"
    service.wake_supervisor()
    return out


@router.delete("/{tree_id}", status_code=204, responses=problems(404, 409))
def delete_tree(tree_id: str, service: ServiceDep) -> Response:
    """Delete an uploaded tree with its jobs and the files that no other tree uses."""
    with service.files_lock, service.sessions.begin() as session:
        tree = find_tree(session, tree_id)
        if tree.builtin:
            raise ProblemError(
                403, "builtin-tree", "Built-in trees cannot be deleted", hint="Only uploads can be deleted."
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
    remove_unshared(session, service.stores.sources, (Tree.source_sha256,), tree.source_sha256)
    remove_unshared(session, service.stores.meshes, (Tree.mesh_sha256,), tree.mesh_sha256)
    tables = (Tree.table_sha256, Tree.bare_table_sha256)
    for sha256 in (tree.table_sha256, tree.bare_table_sha256):
        remove_unshared(session, service.stores.tables, tables, sha256)
    remove_unshared(session, service.stores.records, (Tree.records_sha256,), tree.records_sha256)
    compliances = (Tree.compliance_sha256,)
    remove_unshared(session, service.stores.compliances, compliances, tree.compliance_sha256)


def remove_unshared(
    session: Session, store: FileStore, columns: Sequence[InstrumentedAttribute[Any]], sha256: str | None
) -> None:
    """Remove a file that no tree references in any of the columns. The caller must hold `files_lock`."""
    named = or_(*(column == sha256 for column in columns))
    if sha256 and not session.scalars(select(Tree.id).where(named)).first():
        store.remove(sha256)


def find_tree(session: Session, tree_id: str) -> Tree:
    """A tree by its id. ProblemError 404."""
    tree = session.get(Tree, tree_id)
    if tree is None:
        raise not_found("tree", tree_id)
    return tree
