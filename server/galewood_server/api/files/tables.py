"""List and metadata of tables. artefacts.py serves the files."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from fastapi import APIRouter, Request, Response
from galewood.table import TableError, read_metadata
from pydantic import BaseModel
from sqlalchemy import func, select

from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    NOT_MODIFIED,
    PageParams,
    ProblemError,
    TableList,
    TableOut,
    cursor_time,
    decode_cursor,
    encode_cursor,
    json_with_etag,
    not_found,
    problems,
    rows_after,
)
from galewood_server.storage import Tree

router = APIRouter(prefix="/api/tables", tags=["tables"])
ORDER = (Tree.created_at, Tree.id)
OWN_FIELDS = ("name", "species", "height_m", "mesh_sha256", "records_sha256", "bare_table_sha256")


class TableMetadata(BaseModel):
    """The metadata of a table (docs/formats/table.md)."""

    sha256: str
    metadata: dict[str, Any]


@router.get("", response_model=TableList, responses=NOT_MODIFIED)
def list_tables(request: Request, service: ServiceDep, query: PageParams) -> Response:
    """A page of the trees' current tables, ordered by the age of the tree."""
    rows = select(Tree).where(Tree.table_sha256.is_not(None)).order_by(*ORDER).limit(query.limit + 1)
    if query.after:
        rows = rows.where(rows_after(ORDER, _sort_key(query.after)))
    with service.sessions() as session:
        trees = session.scalars(rows).all()
        total = session.scalar(select(func.count(Tree.id)).where(Tree.table_sha256.is_not(None))) or 0
    last = trees[query.limit - 1] if len(trees) > query.limit else None
    cursor = encode_cursor([last.created_at.isoformat(), last.id]) if last else None
    tables = [out for tree in trees[: query.limit] if (out := _out(service, tree))]
    return json_with_etag(request, TableList(tables=tables, total=total, next=cursor))


def _sort_key(cursor: str) -> tuple[datetime, str]:
    created_at, tree_id = decode_cursor(cursor, 2)
    return cursor_time(created_at), tree_id


def _out(service: Service, tree: Tree) -> TableOut | None:
    """None if the file is missing, which `galewood doctor` reports."""
    size = service.stores.tables.size(tree.table_sha256 or "")
    if size is None:
        return None
    fields = {name: getattr(tree, name) for name in OWN_FIELDS}
    return TableOut(sha256=tree.table_sha256 or "", size_bytes=size, tree_id=tree.id, **fields)


@router.get(
    "/{sha256}/metadata", response_model=TableMetadata, responses={**NOT_MODIFIED, **problems(404, 409)}
)
def table_metadata(sha256: str, request: Request, service: ServiceDep) -> Response:
    """The metadata of a table: modes, records, winds, errors, frequencies and provenance."""
    if not service.stores.tables.has(sha256):
        raise not_found("table", sha256)
    try:
        metadata = read_metadata(service.stores.tables.get(sha256))
    except TableError as error:
        raise ProblemError(
            409, "unreadable-table", "The table's metadata is unreadable", detail=str(error)
        ) from None
    return json_with_etag(request, TableMetadata(sha256=sha256, metadata=metadata))
