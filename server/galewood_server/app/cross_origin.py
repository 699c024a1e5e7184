"""Access from pages of other origins (CORS): the operator lists them in GALEWOOD_ALLOWED_ORIGINS."""

from __future__ import annotations

from collections.abc import Sequence

from fastapi import FastAPI
from starlette.middleware.cors import CORSMiddleware

METHODS = ("GET", "HEAD", "POST", "PATCH", "DELETE")
REQUEST_HEADERS = ("Authorization", "Content-Type", "If-None-Match", "Last-Event-ID", "Range")
RESPONSE_HEADERS = (
    "Accept-Ranges", "Content-Range", "ETag", "Location", "Retry-After", "X-Request-ID",
)  # fmt: skip
PREFLIGHT_S = 86_400


def allow_cross_origin(app: FastAPI, origins: Sequence[str]) -> None:
    """Answer cross-origin requests of these origins. Without any, browsers refuse all such requests."""
    if not origins:
        return
    app.add_middleware(
        CORSMiddleware,
        allow_origins=list(origins),
        allow_methods=METHODS,
        allow_headers=REQUEST_HEADERS,
        expose_headers=RESPONSE_HEADERS,
        max_age=PREFLIGHT_S,
    )
