"""Tables and meshes by their hash: immutable, cacheable for ever, with ranges."""

from __future__ import annotations

import re
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse, Response

from galewood_server.context import Service, ServiceHere
from galewood_server.http import NOT_MODIFIED, ProblemError, matches, not_found, problems
from galewood_server.storage import PREFERRED, FileStore, coding_of, encoded_file

router = APIRouter(prefix="/api", tags=["artefacts"])
FOREVER = "public, max-age=31536000, immutable"
_RANGE = re.compile(r"bytes=\s*(\d+-\d*|-\d+)(\s*,\s*(\d+-\d*|-\d+)){0,15}\s*")
BINARY: dict[str, Any] = {"schema": {"type": "string", "format": "binary"}}


def _answers(media_type: str) -> dict[int | str, dict[str, Any]]:
    content = {media_type: BINARY}
    part = {"description": "The part that the Range header asked for.", "content": content}
    whole = {"description": "The file.", "content": content}
    beyond = {"description": "The range begins beyond the file.", "content": {"text/plain": {}}}
    return {200: whole, 206: part, 416: beyond, **NOT_MODIFIED, **problems(400, 404)}


@router.get("/tables/{sha256}", response_class=FileResponse, responses=_answers("application/octet-stream"))
@router.head("/tables/{sha256}", include_in_schema=False)
def get_table(sha256: str, request: Request, service: ServiceHere) -> Response:
    """A table file (docs/formats/table.md), whole or in ranges, by zstd or gzip where the client can."""
    return _file(request, service, service.stores.tables, "table", sha256, "application/octet-stream")


@router.get("/meshes/{sha256}", response_class=FileResponse, responses=_answers("model/gltf-binary"))
@router.head("/meshes/{sha256}", include_in_schema=False)
def get_mesh(sha256: str, request: Request, service: ServiceHere) -> Response:
    """A tree as it is drawn: GLB whose vertices are in the order of its table."""
    return _file(request, service, service.stores.meshes, "mesh", sha256, "model/gltf-binary")


def _file(
    request: Request, service: Service, store: FileStore, kind: str, sha256: str, media_type: str
) -> Response:
    if not store.has(sha256):
        raise not_found(kind, sha256)
    ranges = request.headers.get("range")
    if ranges is not None and not _RANGE.fullmatch(ranges):
        raise ProblemError(400, "bad-range", "The Range header cannot be read", hint="Send bytes=FIRST-LAST.")
    # a range is of the plain bytes, so that whoever asks for one need not know of compression
    coding = coding_of(request.headers.get("accept-encoding", "")) if kind == "table" and not ranges else None
    folder = service.settings.cache_dir / "encoded"
    path = encoded_file(folder, sha256, coding, lambda: store.get(sha256)) if coding else None
    etag = f'"{sha256}-{coding}"' if path else f'"{sha256}"'
    headers = {"ETag": etag, "Cache-Control": FOREVER, "Vary": "Accept-Encoding"}
    # the bytes never change, so whoever holds them in any coding holds them: the compressed file may
    # have been made between two requests of one client
    held = request.headers.get("if-none-match", "")
    if any(matches(held, f'"{sha256}{end}"') for end in ("", *(f"-{known}" for known in PREFERRED))):
        return Response(status_code=304, headers=headers)
    if path is None or coding is None:
        return FileResponse(store.path(sha256), media_type=media_type, headers=headers)
    headers["Content-Encoding"] = coding
    return FileResponse(path, media_type=media_type, headers=headers)
