"""Pages of long lists: a cursor names the last row that was sent, so rows that come or go shift nothing."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from typing import Annotated, Any

from fastapi import Query
from pydantic import BaseModel
from sqlalchemy import ColumnElement, and_, or_

from galewood_server.http.errors import ProblemError

LARGEST = 500


class PageQuery(BaseModel):
    """Which page of a list."""

    limit: int = Query(default=100, ge=1, le=LARGEST)
    after: str | None = Query(default=None, max_length=400, description="`next` of the page before.")


Asked = Annotated[PageQuery, Query()]


def cursor_of(values: Sequence[str]) -> str:
    """A cursor that holds the sort key of a row, each part as text."""
    return base64.urlsafe_b64encode(json.dumps(list(values)).encode()).decode().rstrip("=")


def parts_of(cursor: str, count: int) -> list[str]:
    """The sort key in a cursor. ProblemError 422 if it is none of ours."""
    try:
        parts = json.loads(base64.urlsafe_b64decode(cursor + "=" * (-len(cursor) % 4)))
    except ValueError:
        parts = None
    if isinstance(parts, list) and len(parts) == count and all(isinstance(part, str) for part in parts):
        return parts
    raise bad_cursor()


def bad_cursor() -> ProblemError:
    """422 for a cursor that was not handed out here."""
    return ProblemError(
        422, "bad-cursor", "This is no page", hint="Pass on 'next' as it came, or leave it out."
    )


def beyond(columns: Sequence[Any], values: Sequence[Any], *, descending: bool = False) -> ColumnElement[bool]:
    """Rows after a sort key, in the order of the columns."""
    rows: list[ColumnElement[bool]] = []
    for k, (column, value) in enumerate(zip(columns, values, strict=True)):
        equal = [left == right for left, right in zip(columns[:k], values[:k], strict=True)]
        rows.append(and_(*equal, column < value if descending else column > value))
    return or_(*rows)
