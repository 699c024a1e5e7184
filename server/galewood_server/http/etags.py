"""Answers that a client need not be sent twice: tags that change with the bytes, and only with them."""

from __future__ import annotations

import hashlib
from typing import Any

from fastapi import Request, Response
from pydantic import BaseModel

NOT_MODIFIED: dict[int | str, dict[str, Any]] = {304: {"description": "The client has these very bytes."}}


def matches(given: str, etag: str) -> bool:
    """Whether an If-None-Match header names a tag (weak comparison, RFC 9110, section 13.1.2)."""
    names = [name.strip().removeprefix("W/") for name in given.split(",")]
    return "*" in names or etag in names


def tagged(request: Request, model: BaseModel) -> Response:
    """A model as JSON with a strong tag; 304 without a body if the client has these very bytes."""
    body = model.model_dump_json().encode()
    etag = f'"{hashlib.sha256(body).hexdigest()[:32]}"'
    headers = {"ETag": etag, "Cache-Control": "no-cache"}
    if matches(request.headers.get("if-none-match", ""), etag):
        return Response(status_code=304, headers=headers)
    return Response(body, media_type="application/json", headers=headers)
