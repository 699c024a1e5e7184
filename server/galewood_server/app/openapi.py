"""The OpenAPI description, completed with the problems and the API key that all routes share."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from galewood_server.access import READ_ONLY_POSTS, WRITE_METHODS
from galewood_server.http import ProblemOut, problems

API_DESCRIPTION = """Computes lookup tables of simulated motion from tree meshes.

Errors are problem details (RFC 9457): `code` is machine-readable; `title`, `detail` and `hint` are for users.
Write access requires an API key (`Authorization: Bearer KEY`) or, if the operator configured none, a client
on the server's own machine. Lists are paginated: pass `next` as `after`. A query parameter that an address
does not have is refused with 422. Responses have `ETag` and `X-Request-ID` headers. Forests are streamed over
the WebSocket `/ws/forest` (spec/formats/wire.md)."""

_HEADERS = {
    "Location": {"201", "202"},
    "ETag": {"200", "206", "304"},
    "Retry-After": {"429", "503"},
}
"""Headers of responses, by status; ETag only where a copy can be current."""


def describe(app: FastAPI) -> None:
    """Replace the app's OpenAPI function by one that adds the shared problems and the API key."""

    def description() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = _complete(
                get_openapi(
                    title=app.title, version=app.version, description=API_DESCRIPTION, routes=app.routes
                )
            )
        return app.openapi_schema

    app.openapi = description  # type: ignore[method-assign]  # FastAPI's documented way to extend it


def _complete(schema: dict[str, Any]) -> dict[str, Any]:
    components = schema.setdefault("components", {})
    schemas = components.setdefault("schemas", {})
    schemas["ProblemOut"] = ProblemOut.model_json_schema()
    for unused in ("HTTPValidationError", "ValidationError"):
        schemas.pop(unused, None)
    components["securitySchemes"] = {"key": {"type": "http", "scheme": "bearer"}}
    for path, operations in schema["paths"].items():
        for method, operation in operations.items():
            _complete_operation(path, method.upper(), operation)
    return schema


def _complete_operation(path: str, method: str, operation: dict[str, Any]) -> None:
    shared = {421, 422, 429} if path.startswith("/api/") else {421, 422}
    shared |= {404} if "{" in path else set()
    if "requestBody" in operation:
        shared |= {408, 413}
    if method in WRITE_METHODS and path not in READ_ONLY_POSTS:
        shared |= {401, 403}
        operation["security"] = [{"key": []}, {}]
    responses = operation["responses"]
    for status, answer in problems(*sorted(shared)).items():
        responses[str(status)] = answer
    for name, statuses in _HEADERS.items():
        for status in statuses & responses.keys():
            if name != "ETag" or "304" in responses:
                responses[status].setdefault("headers", {})[name] = {"schema": {"type": "string"}}
