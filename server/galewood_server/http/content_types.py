"""What responses that are not JSON contain, for the OpenAPI description."""

from __future__ import annotations

from typing import Any

Responses = dict[int | str, dict[str, Any]]
_TEXT: dict[str, Any] = {"type": "string"}
_BINARY: dict[str, Any] = {"type": "string", "format": "binary"}
_TEXT_TYPES = ("application/geo+json",)


def contents(description: str, *media_types: str, status: int = 200) -> Responses:
    """The OpenAPI `responses` of a status that is answered with a file or a text of one of these types."""
    schemas = {
        kind: _TEXT if kind.startswith("text/") or kind in _TEXT_TYPES else _BINARY for kind in media_types
    }
    content = {kind: {"schema": schema} for kind, schema in schemas.items()}
    return {status: {"description": description, "content": content}}


EVENT_STREAM = contents("Server-sent events, each with a JSON object as its data.", "text/event-stream")
