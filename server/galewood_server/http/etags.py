"""Conditional requests with ETags that depend only on the content."""

from __future__ import annotations

import hashlib
from typing import Any

from fastapi import Request, Response
from pydantic import BaseModel

NOT_MODIFIED: dict[int | str, dict[str, Any]] = {304: {"description": "The client's copy is current."}}


def etag_matches(given: str, etag: str) -> bool:
    """Whether an If-None-Match header lists an ETag (weak comparison, RFC 9110, section 13.1.2)."""
    names = [name.strip().removeprefix("W/") for name in given.split(",")]
    return "*" in names or etag in names


def json_with_etag(request: Request, model: BaseModel) -> Response:
    """A model as JSON with a strong ETag, or 304 without a body if the client's copy is current."""
    body = model.model_dump_json().encode()
    etag = f'"{hashlib.sha256(body).hexdigest()[:32]}"'
    headers = {"ETag": etag, "Cache-Control": "no-cache"}
    if etag_matches(request.headers.get("if-none-match", ""), etag):
        return Response(status_code=304, headers=headers)
    return Response(body, media_type="application/json", headers=headers)
