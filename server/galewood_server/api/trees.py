"""Trees: list and delete. uploads/upload.py adds them."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from functools import lru_cache
from typing import Any

from fastapi import APIRouter, Request, Response
from sqlalchemy import bindparam, case, delete, func, or_, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    NOT_MODIFIED,
    JobOut,
    PageParams,
    ProblemError,
    TreeList,
    TreeOut,
    TreeSummary,
    body_with_etag,
    cursor_of_time,
    cursor_time,
    damaged,
    decode_cursor,
    invalid_cursor,
    not_found,
    paged,
    problems,
    read_page,
    row_as_json,
    rows_after,
    serialisable,
)
from galewood_server.storage import (
    ACTIVE_STATES,
    TREE_FIELDS,
    FileStore,
    Job,
    RawRow,
    Tree,
    mark_tree_files,
    raw_column,
    tree_rows,
    tree_state,
)

router = APIRouter(prefix="/api/trees", tags=["trees"])
ORDER_COLUMNS = (case((Tree.builtin, 0), else_=1), Tree.created_at, Tree.id)
COUNT_QUERY = select(func.count(Tree.id))
LIST_QUERY = paged(tree_rows().order_by(*ORDER_COLUMNS))
ONE_QUERY = tree_rows(Tree.report).where(Tree.id == bindparam("id"))
TABLE_COLUMNS = (Tree.table_sha256, Tree.bare_table_sha256, Tree.beams_sha256)
KEPT_ROWS, KEPT_REPORTS = 4096, 16
DELETE_IT = "Delete it (DELETE /api/trees/{id}), which also deletes its jobs, then upload its file again."


def tree_out(tree: Tree) -> TreeOut:
    """The response model of a tree. ProblemError 500 if it cannot be serialised: nothing is then stored."""
    return serialisable(TreeOut(**_stored(tree, TreeOut)))


def summary_out(tree: Tree) -> TreeSummary:
    """The response model of a tree without its report."""
    return TreeSummary(**_stored(tree, TreeSummary))


def _stored(tree: Tree, model: type[TreeSummary]) -> dict[str, Any]:
    """The fields of a response model of a tree."""
    job = tree.job
    fields = {name: getattr(tree, name) for name in model.model_fields if name != "job_id"}
    return {**fields, "job_id": job.id if job else None}


def job_out(job: Job) -> JobOut:
    """The response model of a build job. ProblemError 500 like `tree_out`."""
    return serialisable(JobOut.model_validate(job))


@lru_cache(maxsize=KEPT_ROWS)
def tree_json(row: RawRow) -> bytes | None:
    """The summary of a row of `tree_rows` as JSON; None, with its id in the log, if it is damaged.

    What was serialised once is found by the row itself, so that it is always that of the present row.
    """
    return row_as_json("tree", TreeSummary, _fields(row))


@lru_cache(maxsize=KEPT_REPORTS)
def _whole_tree_json(row: RawRow) -> bytes | None:
    *summary, report = row
    return row_as_json("tree", TreeOut, {**_fields(tuple(summary)), "report": report})


def _fields(row: RawRow) -> dict[str, Any]:
    found = dict(zip(TREE_FIELDS, row, strict=True))
    state = tree_state(found["table_sha256"], found["preliminary"], found["job_state"])
    return {**found, "state": state}


@router.get("", response_model=TreeList, responses=NOT_MODIFIED)
def list_trees(request: Request, service: ServiceDep, query: PageParams) -> Response:
    """A page of the trees, without their reports: built-in trees first, then uploads by age."""
    rows = LIST_QUERY.where(rows_after(ORDER_COLUMNS, _sort_key(query.after))) if query.after else LIST_QUERY
    with service.sessions() as session:
        page = read_page(session, rows, COUNT_QUERY, query, tree_json)
    return page.response(request, "trees", _cursor_parts)


def _cursor_parts(row: RawRow) -> list[str]:
    found = dict(zip(TREE_FIELDS, row, strict=True))
    return [str(int(not found["builtin"])), cursor_of_time(found["created_at"]), found["id"]]


def _sort_key(cursor: str) -> tuple[int, datetime, str]:
    uploaded, created_at, tree_id = decode_cursor(cursor, 3)
    if uploaded not in ("0", "1"):
        raise invalid_cursor()
    return int(uploaded), cursor_time(created_at), tree_id


@router.get("/{tree_id}", response_model=TreeOut, responses={**NOT_MODIFIED, **problems(404, 500)})
def get_tree(tree_id: str, request: Request, service: ServiceDep) -> Response:
    """A tree with its report. 500 `damaged-tree` if its record cannot be read; it can still be deleted."""
    with service.sessions() as session:
        row = session.execute(ONE_QUERY, {"id": tree_id}).one_or_none()
    if row is None:
        raise not_found("tree", tree_id)
    body = _whole_tree_json(tuple(row))
    if body is None:
        raise damaged("tree", tree_id, DELETE_IT)
    return body_with_etag(request, body)


@router.delete("/{tree_id}", status_code=204, responses=problems(404, 409))
def delete_tree(tree_id: str, service: ServiceDep) -> Response:
    """Delete an uploaded tree with its jobs and the files that no other tree uses."""
    with service.files_lock, service.sessions.begin() as session:
        # a damaged tree is deleted like any other: its row is not converted to an object
        builtin = session.execute(select(raw_column(Tree.builtin)).where(Tree.id == tree_id)).one_or_none()
        if builtin is None:
            raise not_found("tree", tree_id)
        if builtin[0]:
            raise ProblemError(
                403, "builtin-tree", "Built-in trees cannot be deleted", hint="Only uploads can be deleted."
            )
        active = select(Job.id).where(Job.tree_id == tree_id, Job.state.in_(ACTIVE_STATES))
        if session.execute(active).first():
            raise ProblemError(
                409, "still-building", "This tree is being computed", hint="Cancel its job first."
            )
        files = mark_tree_files(session, tree_id)
        session.execute(delete(Tree).where(Tree.id == tree_id))  # with its jobs, by the foreign key
        _remove_files(session, service, files)
    return Response(status_code=204)


def _remove_files(session: Session, service: Service, files: dict[str, str]) -> None:
    for store, name, columns in (
        (service.stores.sources, "source_sha256", (Tree.source_sha256,)),
        (service.stores.meshes, "mesh_sha256", (Tree.mesh_sha256,)),
        (service.stores.imports, "import_sha256", (Tree.import_sha256,)),
        (service.stores.tables, "beams_sha256", TABLE_COLUMNS),
        (service.stores.tables, "table_sha256", TABLE_COLUMNS),
        (service.stores.tables, "bare_table_sha256", TABLE_COLUMNS),
        (service.stores.records, "records_sha256", (Tree.records_sha256,)),
        (service.stores.compliances, "compliance_sha256", (Tree.compliance_sha256,)),
    ):
        remove_unshared(session, store, columns, files.get(name))
    mesh_sha256 = files.get("mesh_sha256")
    if mesh_sha256 and not service.stores.meshes.has(mesh_sha256):
        service.settings.light_copy(mesh_sha256).unlink(missing_ok=True)


def remove_unshared(
    session: Session, store: FileStore, columns: Sequence[InstrumentedAttribute[Any]], sha256: str | None
) -> None:
    """Remove a file that no tree references in any of the columns. The caller must hold `files_lock`."""
    named = or_(*(column == sha256 for column in columns))
    if sha256 and not session.scalars(select(Tree.id).where(named)).first():
        store.remove(sha256)


def check_from_file(tree: Tree) -> None:
    """Raise ProblemError 403 for an individual: it has no file that could be imported with other options."""
    if tree.grown:
        hint = "Ask for another one (POST /api/individuals)."
        raise ProblemError(403, "grown-tree", "This tree was grown by the service", hint=hint)


def find_tree(session: Session, tree_id: str) -> Tree:
    """A tree by its id. ProblemError 404, or 500 if its row or a job's cannot be read."""
    try:
        tree = session.get(Tree, tree_id)
    except (ValueError, TypeError) as error:  # of a stored time or JSON document
        raise damaged("tree", tree_id, DELETE_IT) from error
    if tree is None:
        raise not_found("tree", tree_id)
    return tree
