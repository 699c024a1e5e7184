"""The interface's own description, completed by what holds for every route alike."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from galewood_server.access import HARMLESS, UNSAFE
from galewood_server.http import ProblemOut, problems

ABOUT = """Trees go in as meshes and come out as tables of simulated motion.

Errors are problems (RFC 9457): `code` for programs, `title`, `detail` and `hint` for people. What changes
anything needs a key (`Authorization: Bearer KEY`), or, where the operator set none, a client on the server's
own machine. Lists come in pages: pass `next` on as `after`. Answers carry `ETag` and `X-Request-ID`.
Forests are streamed by the WebSocket `/ws/forest` (docs/formats/wire.md)."""


def describe(app: FastAPI) -> None:
    """Let the app describe itself with the problems and the key that every route shares."""

    def description() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = _complete(
                get_openapi(title=app.title, version=app.version, description=ABOUT, routes=app.routes)
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
    shared: set[int] = {429} if path.startswith("/api/") else set()
    shared |= {404} if "{" in path else set()
    if "422" in operation["responses"]:
        shared.add(422)
    if "requestBody" in operation:
        shared |= {408, 413, 422}
    if method in UNSAFE and path not in HARMLESS:
        shared |= {401, 403}
        operation["security"] = [{"key": []}, {}]
    for status, answer in problems(*sorted(shared)).items():
        operation["responses"][str(status)] = answer
