"""Conversion of exceptions to problem details (RFC 9457)."""

from __future__ import annotations

import errno
import logging
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from galewood.motion.wind import WindError
from galewood.util import MeshError, Reason
from starlette.exceptions import HTTPException
from starlette.formparsers import MultiPartException
from starlette.routing import BaseRoute

from galewood_server.http.methods import allowed_methods
from galewood_server.storage import CONTENT_OF_STORE, DamagedFileError, is_database_busy, is_disk_full

log = logging.getLogger("galewood.errors")


@dataclass(frozen=True, kw_only=True)
class Problem:
    """An error response: `code` is machine-readable; `title`, `detail` and `hint` are for users."""

    status: int
    code: str
    title: str
    hint: str
    detail: str = ""
    """What title and hint do not say; empty: nothing, and then the response has none."""
    retry_after_s: int | None = None

    def response(self, headers: Mapping[str, str] | None = None) -> JSONResponse:
        """The response with media type application/problem+json."""
        said = ("", self.title.rstrip("."), self.hint.rstrip("."))
        body = {
            "type": f"urn:galewood:problem:{self.code}",
            "title": self.title,
            "status": self.status,
            **({"detail": self.detail} if self.detail.rstrip(".") not in said else {}),
            "hint": self.hint,
            "code": self.code,
        }
        response = JSONResponse(body, self.status, headers, media_type="application/problem+json")
        if self.retry_after_s is not None:
            response.headers.setdefault("Retry-After", str(self.retry_after_s))
        return response


class ProblemError(Exception):
    """A request failed; converted to a Problem response."""

    def __init__(
        self,
        status: int,
        code: str,
        title: str,
        *,
        detail: str = "",
        hint: str = "",
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(title)
        self.problem = Problem(status=status, code=code, title=title, detail=detail, hint=hint)
        self.headers = headers


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The OpenAPI `responses` of statuses that are answered with a problem."""
    content = {"application/problem+json": {"schema": {"$ref": "#/components/schemas/ProblemOut"}}}
    return {status: {"description": HTTPStatus(status).phrase, "content": content} for status in statuses}


def not_found(kind: str, name: str) -> ProblemError:
    """404 for an unknown tree, job, table or mesh."""
    title = f"There {'are' if kind == 'records' else 'is'} no such {kind}"
    return ProblemError(404, f"no-such-{kind}", title, detail=f"{name[:80]!r} was not found.", hint="")


MESH_STATUS: dict[Reason, int] = {"malformed": 400, "too-large": 413, "unsupported": 415, "unsuitable": 422}
"""HTTP status for each kind of mesh error."""


def _from_mesh(error: MeshError) -> Problem:
    return Problem(status=MESH_STATUS[error.reason], code=error.code, title=error.title, hint=error.hint)


def _from_wind(error: WindError) -> Problem:
    title, hint = "Invalid wind document", f"{error.path}: {error.expected}."
    return Problem(status=422, code="bad-wind", title=title, detail=str(error), hint=hint)


def _from_validation(error: RequestValidationError) -> Problem:
    lines = [f"{'.'.join(str(part) for part in item['loc'])}: {item['msg']}" for item in error.errors()[:8]]
    return Problem(
        status=422,
        code="invalid-request",
        title="The request has invalid fields",
        detail="; ".join(lines),
        hint="See /docs for the fields and their allowed values.",
    )


def _from_http(error: HTTPException) -> Problem:
    title = str(error.detail) or HTTPStatus(error.status_code).phrase
    code = HTTPStatus(error.status_code).phrase.lower().replace(" ", "-")
    return Problem(status=error.status_code, code=code, title=title, hint="See /docs.")


def _from_multipart(error: MultiPartException) -> Problem:
    return Problem(
        status=400,
        code="broken-form",
        title="The form could not be read",
        detail=error.message,
        hint="Send multipart/form-data with one part named 'file'.",
    )


def _from_damaged_file(error: DamagedFileError) -> Problem:
    what = CONTENT_OF_STORE[error.kind]
    again = "Upload it again" if error.kind == "sources" else "Compute the tree again"
    return Problem(
        status=500,
        code=f"damaged-{what.replace(' ', '-')}",
        title=f"The stored {what} is damaged",
        detail="The content of the file does not match its hash.",
        hint=f"{again}, or ask the operator to restore the file from a backup.",
    )


def _from_anything(_error: Exception) -> Problem:
    return Problem(
        status=500,
        code="internal-error",
        title="Internal server error",
        detail="The server log has the details.",
        hint="Try again. Stored data is not affected.",
    )


PROBLEMS_BY_TYPE: Mapping[type[Exception], Callable[[Any], Problem]] = {
    ProblemError: lambda error: error.problem,
    MeshError: _from_mesh,
    WindError: _from_wind,
    RequestValidationError: _from_validation,
    MultiPartException: _from_multipart,
    HTTPException: _from_http,
    DamagedFileError: _from_damaged_file,
    Exception: _from_anything,
}


DISK_FULL = Problem(
    status=507,
    code="disk-full",
    title="The server's disk is full",
    detail="Nothing was changed.",
    hint="Try again later, or ask the operator for space.",
)


NO_DESCRIPTORS = Problem(
    status=503,
    code="server-busy",
    title="The server has too many open files",
    detail="Nothing was changed.",
    hint="Try again in a few seconds.",
    retry_after_s=5,
)
DATABASE_BUSY = Problem(
    status=503,
    code="database-busy",
    title="The database is busy",
    detail="It is locked, overloaded or not reachable. Nothing was changed.",
    hint="Try again in a few seconds.",
    retry_after_s=5,
)


def problem_from(error: Exception) -> Problem:
    """The problem for an exception, by the first matching type in PROBLEMS_BY_TYPE."""
    if is_disk_full(error):
        return DISK_FULL
    if is_database_busy(error):
        return DATABASE_BUSY
    if isinstance(error, OSError) and error.errno in (errno.EMFILE, errno.ENFILE):
        return NO_DESCRIPTORS
    return next(make(error) for kind, make in PROBLEMS_BY_TYPE.items() if isinstance(error, kind))


def install_error_handlers(app: FastAPI, routes: Sequence[BaseRoute] = ()) -> None:
    """Register handlers that answer every exception with its problem; `routes` are those of the API."""

    async def answer(request: Request, error: Exception) -> Response:
        headers = getattr(error, "headers", None)
        if isinstance(error, HTTPException) and error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            headers = {"Allow": allowed_methods(routes, request.scope)}
        return problem_from(error).response(headers)

    handler: Callable[[Request, Exception], Awaitable[Response]] = answer
    for kind in PROBLEMS_BY_TYPE:
        app.add_exception_handler(kind, handler)
