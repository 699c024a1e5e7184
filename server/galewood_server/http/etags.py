"""Conditional requests with ETags that depend only on the content."""

from __future__ import annotations

import gzip
import hashlib
from functools import lru_cache
from typing import Any

from fastapi import Request, Response
from pydantic import BaseModel

from galewood_server.storage import preferred_coding

IMMUTABLE_CACHE = "public, max-age=31536000, immutable"
"""Cache-Control of a file whose address changes with its content."""
NOT_MODIFIED: dict[int | str, dict[str, Any]] = {304: {"description": "The client's copy is current."}}

COMPRESSED_BYTES, GZIP_LEVEL = 1000, 5
"""Size of a JSON response from which on it is compressed, and how thoroughly."""
KEPT_COMPRESSED = 16


def etag_matches(given: str, etag: str) -> bool:
    """Whether an If-None-Match header lists an ETag (weak comparison, RFC 9110, section 13.1.2)."""
    names = [name.strip().removeprefix("W/") for name in given.split(",")]
    return "*" in names or etag in names


def json_with_etag(request: Request, model: BaseModel) -> Response:
    """A model as JSON with a strong ETag, or 304 without a body if the client's copy is current."""
    return body_with_etag(request, model.model_dump_json().encode())


def body_with_etag(request: Request, body: bytes) -> Response:
    """JSON with a strong ETag, or 304 without a body if the client's copy is current."""
    etag = f'"{hashlib.sha256(body).hexdigest()[:32]}"'
    headers = {"ETag": etag, "Cache-Control": "no-cache"}
    if etag_matches(request.headers.get("if-none-match", ""), etag):
        return Response(status_code=304, headers=headers)
    accepted = request.headers.get("accept-encoding", "")
    if len(body) >= COMPRESSED_BYTES and preferred_coding(accepted, ("gzip",)):
        headers |= {"Content-Encoding": "gzip", "Vary": "Accept-Encoding"}
        body = _compressed(body)
    return Response(body, media_type="application/json", headers=headers)


@lru_cache(maxsize=KEPT_COMPRESSED)
def _compressed(body: bytes) -> bytes:
    """Kept, because many clients ask for the same list and compressing it costs more than all the rest."""
    return gzip.compress(body, GZIP_LEVEL, mtime=0)
