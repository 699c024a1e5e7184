"""Tables: which there are and what they hold. Their bytes are served by artefacts.py."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from fastapi import APIRouter, Request, Response
from galewood.table import TableError, read_metadata
from pydantic import BaseModel
from sqlalchemy import func, select

from galewood_server.context import Service, ServiceHere
from galewood_server.http import (
    NOT_MODIFIED,
    Asked,
    ProblemError,
    TableList,
    TableOut,
    bad_cursor,
    beyond,
    cursor_of,
    not_found,
    parts_of,
    problems,
    tagged,
)
from galewood_server.storage import Tree

router = APIRouter(prefix="/api/tables", tags=["tables"])
ORDER = (Tree.created_at, Tree.id)


class TableMetadata(BaseModel):
    """What a table says of itself (docs/formats/table.md)."""

    sha256: str
    metadata: dict[str, Any]


@router.get("", response_model=TableList, responses=NOT_MODIFIED)
def list_tables(request: Request, service: ServiceHere, asked: Asked) -> Response:
    """A page of the tables that trees have now, by the age of their tree."""
    rows = select(Tree).where(Tree.table_sha256.is_not(None)).order_by(*ORDER).limit(asked.limit + 1)
    if asked.after:
        rows = rows.where(beyond(ORDER, _sort_key(asked.after)))
    with service.sessions() as session:
        found = session.scalars(rows).all()
        total = session.scalar(select(func.count(Tree.id)).where(Tree.table_sha256.is_not(None))) or 0
    last = found[asked.limit - 1] if len(found) > asked.limit else None
    more = cursor_of([last.created_at.isoformat(), last.id]) if last else None
    tables = [out for tree in found[: asked.limit] if (out := _out(service, tree))]
    return tagged(request, TableList(tables=tables, total=total, next=more))


def _sort_key(cursor: str) -> tuple[datetime, str]:
    created_at, tree_id = parts_of(cursor, 2)
    try:
        return datetime.fromisoformat(created_at), tree_id
    except ValueError:
        raise bad_cursor() from None


def _out(service: Service, tree: Tree) -> TableOut | None:
    """None if the file is gone, which `galewood doctor` tells."""
    size = service.stores.tables.size(tree.table_sha256 or "")
    if size is None:
        return None
    fields = {name: getattr(tree, name) for name in ("name", "species", "height_m", "mesh_sha256")}
    return TableOut(sha256=tree.table_sha256 or "", size_bytes=size, tree_id=tree.id, **fields)


@router.get(
    "/{sha256}/metadata", response_model=TableMetadata, responses={**NOT_MODIFIED, **problems(404, 409)}
)
def table_metadata(sha256: str, request: Request, service: ServiceHere) -> Response:
    """The header of a table: modes, records, winds, errors, frequencies, provenance."""
    if not service.stores.tables.has(sha256):
        raise not_found("table", sha256)
    try:
        metadata = read_metadata(service.stores.tables.get(sha256))
    except TableError as error:
        raise ProblemError(
            409, "unreadable-table", "The table says nothing of itself", detail=str(error)
        ) from None
    return tagged(request, TableMetadata(sha256=sha256, metadata=metadata))
