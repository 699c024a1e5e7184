"""List and metadata of tables. artefacts.py serves the files."""

from __future__ import annotations

from datetime import datetime
from functools import lru_cache
from typing import Any

from fastapi import APIRouter, Request, Response
from galewood.table import TableError, read_metadata
from pydantic import BaseModel, Field
from sqlalchemy import func, select

from galewood_server.context import ServiceDep
from galewood_server.http import (
    NOT_MODIFIED,
    PageParams,
    ProblemError,
    StoredTime,
    TableList,
    TableOut,
    cursor_of_time,
    cursor_time,
    decode_cursor,
    json_with_etag,
    not_found,
    paged,
    problems,
    read_page,
    row_as_json,
    rows_after,
)
from galewood_server.storage import RawRow, Tree, is_hash, raw_column

router = APIRouter(prefix="/api/tables", tags=["tables"])
ORDER_COLUMNS = (Tree.created_at, Tree.id)
FIELDS = (
    "id",
    "table_sha256",
    "name",
    "species",
    "height_m",
    "mesh_sha256",
    "records_sha256",
    "bare_table_sha256",
    "created_at",
)
HAS_TABLE = Tree.table_sha256.is_not(None)
COUNT_QUERY = select(func.count(Tree.id)).where(HAS_TABLE)
LIST_QUERY = paged(
    select(*(raw_column(getattr(Tree, name)) for name in FIELDS)).where(HAS_TABLE).order_by(*ORDER_COLUMNS)
)
KEPT_ROWS = 1024


class _TableRow(TableOut):
    """With the time by which the list is ordered: a row whose time is unreadable is damaged."""

    created_at: StoredTime = Field(exclude=True)


class TableMetadata(BaseModel):
    """The metadata of a table (spec/formats/table.md)."""

    sha256: str
    metadata: dict[str, Any]


@router.get("", response_model=TableList, responses=NOT_MODIFIED)
def list_tables(request: Request, service: ServiceDep, query: PageParams) -> Response:
    """A page of the trees' current tables, ordered by the age of the tree."""
    rows = LIST_QUERY.where(rows_after(ORDER_COLUMNS, _sort_key(query.after))) if query.after else LIST_QUERY
    stored_bytes = service.stores.tables.size

    def as_json(row: RawRow) -> bytes | None:
        return _table_json(row, stored_bytes(row[1]) if is_hash(str(row[1])) else None)

    with service.sessions() as session:
        page = read_page(session, rows, COUNT_QUERY, query, as_json)
    return page.response(request, "tables", _cursor_parts)


@lru_cache(maxsize=KEPT_ROWS)
def _table_json(row: RawRow, size_bytes: int | None) -> bytes | None:
    """A table as JSON; None, with the id of its tree in the log, if the row is damaged or has no file."""
    found = dict(zip(FIELDS, row, strict=True))
    own = {"sha256": found["table_sha256"], "size_bytes": size_bytes, "tree_id": found["id"]}
    return row_as_json("tree", _TableRow, {**found, **own})


def _cursor_parts(row: RawRow) -> list[str]:
    found = dict(zip(FIELDS, row, strict=True))
    return [cursor_of_time(found["created_at"]), found["id"]]


def _sort_key(cursor: str) -> tuple[datetime, str]:
    created_at, tree_id = decode_cursor(cursor, 2)
    return cursor_time(created_at), tree_id


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
