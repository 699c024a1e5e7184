"""Keyset pagination: a cursor holds the sort key of the last row sent, so that inserts shift nothing."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Annotated, Any, cast

from fastapi import Query
from pydantic import BaseModel
from sqlalchemy import ColumnElement, and_, or_

from galewood_server.http.errors import ProblemError
from galewood_server.http.texts import is_storable

MAX_PAGE_LENGTH = 500


class PageQuery(BaseModel):
    """Query parameters of a page."""

    limit: int = Query(default=100, ge=1, le=MAX_PAGE_LENGTH)
    after: str | None = Query(default=None, max_length=400, description="`next` of the previous page.")


PageParams = Annotated[PageQuery, Query()]


def encode_cursor(values: Sequence[str]) -> str:
    """Encode the sort key of a row, with all parts as text."""
    return base64.urlsafe_b64encode(json.dumps(list(values)).encode()).decode().rstrip("=")


def decode_cursor(cursor: str, count: int) -> list[str]:
    """Decode a cursor to `count` text parts. ProblemError 422 if it is invalid."""
    try:
        parts: object = json.loads(base64.urlsafe_b64decode(cursor + "=" * (-len(cursor) % 4)))
    except ValueError:
        parts = None
    if isinstance(parts, list):
        texts = [part for part in cast(list[object], parts) if isinstance(part, str)]
        if len(texts) == count == len(cast(list[object], parts)) and all(map(is_storable, texts)):
            return texts
    raise invalid_cursor()


def cursor_time(text: str) -> datetime:
    """The time in a cursor, in UTC. ProblemError 422 without a zone or outside the years 1 to 9999."""
    try:
        time = datetime.fromisoformat(text)
        if time.tzinfo is not None:
            return time.astimezone(UTC)
    except (ValueError, OverflowError):
        pass
    raise invalid_cursor()


def invalid_cursor() -> ProblemError:
    """422 for an invalid cursor."""
    return ProblemError(
        422,
        "bad-cursor",
        "Invalid cursor",
        hint="Use the unchanged value of 'next', or omit 'after' for the first page.",
    )


def rows_after(
    columns: Sequence[Any], values: Sequence[Any], *, descending: bool = False
) -> ColumnElement[bool]:
    """SQL condition for the rows after a sort key, in lexicographic order of the columns."""
    rows: list[ColumnElement[bool]] = []
    for k, (column, value) in enumerate(zip(columns, values, strict=True)):
        equal = [left == right for left, right in zip(columns[:k], values[:k], strict=True)]
        rows.append(and_(*equal, column < value if descending else column > value))
    return or_(*rows)
