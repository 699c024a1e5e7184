"""Keyset pagination: a cursor holds the sort key of the last row sent, so that inserts shift nothing."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Annotated, Any, cast

from fastapi import Query, Request, Response
from pydantic import BaseModel, TypeAdapter
from sqlalchemy import ColumnElement, Integer, Select, and_, bindparam, or_
from sqlalchemy.orm import Session

from galewood_server.http.errors import ProblemError
from galewood_server.http.etags import body_with_etag
from galewood_server.http.schemas import StoredTime
from galewood_server.http.texts import is_storable
from galewood_server.storage import RawRow

MAX_PAGE_LENGTH = 500


class PageQuery(BaseModel):
    """Query parameters of a page."""

    limit: int = Query(default=100, ge=1, le=MAX_PAGE_LENGTH)
    after: str | None = Query(default=None, max_length=400, description="`next` of the previous page.")


PageParams = Annotated[PageQuery, Query()]
_TIME = TypeAdapter[datetime](StoredTime)


@dataclass(frozen=True)
class Page:
    """The rows of a page as JSON, and the ids of damaged rows between them, which are left out."""

    rows: list[bytes]
    damaged: list[str]
    last: RawRow | None
    """The last row, if more follow."""
    total: int
    """The number of rows on all pages, damaged ones included."""

    def response(self, request: Request, name: str, sort_key: Callable[[RawRow], list[str]]) -> Response:
        """The page as JSON with an ETag, its rows under this name."""
        cursor = encode_cursor(sort_key(self.last)) if self.last else None
        rest = json.dumps({"total": self.total, "next": cursor, "damaged": self.damaged}).encode()
        return body_with_etag(request, b'{"%b":[%b],%b' % (name.encode(), b",".join(self.rows), rest[1:]))


def paged(rows: Select[Any]) -> Select[Any]:
    """A query of which `read_page` reads a part."""
    return rows.limit(bindparam("limit", type_=Integer)).offset(bindparam("offset", type_=Integer))


def read_page(
    session: Session,
    rows: Select[Any],
    count: Select[int],
    query: PageQuery,
    as_json: Callable[[RawRow], bytes | None],
) -> Page:
    """Up to `limit` readable rows of a `paged` query; the first column of each is its id. `count` counts
    those of all pages.

    `as_json` returns None for a damaged row. Damaged rows do not count, so that a page ends with a row whose
    sort key is readable.
    """
    limit = query.limit
    kept: list[tuple[RawRow, bytes]] = []
    damaged: list[str] = []
    offset, missing = 0, limit + 1
    connection = session.connection()  # half of the cost of the session, which would look for objects
    while missing:
        found = connection.execute(rows, {"limit": missing, "offset": offset}).all()
        for row in map(tuple, found):
            data = as_json(row)
            if data is None:
                damaged.append(str(row[0]))
            else:
                kept.append((row, data))
        offset += len(found)
        missing = limit + 1 - len(kept) if len(found) == missing else 0
    last = kept[limit - 1][0] if len(kept) > limit else None
    whole = last is None and query.after is None
    total = len(kept) + len(damaged) if whole else connection.scalar(count) or 0
    return Page([data for _, data in kept[:limit]], damaged, last, total)


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


def cursor_of_time(stored: object) -> str:
    """The part of a cursor for a time as the database holds it."""
    return _TIME.validate_python(stored).isoformat()


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
