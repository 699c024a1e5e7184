"""Tables, records, compliances and meshes by content hash: immutable, cacheable, with range requests."""

from __future__ import annotations

import re
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse, Response

from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    IMMUTABLE_CACHE,
    NOT_MODIFIED,
    ProblemError,
    contents,
    etag_matches,
    not_found,
    problems,
)
from galewood_server.storage import PREFERRED_CODINGS, FileStore, coding_of, encoded_file

router = APIRouter(prefix="/api", tags=["artefacts"])
_RANGE = re.compile(r"bytes=\s*(\d+-\d*|-\d+)(\s*,\s*(\d+-\d*|-\d+)){0,15}\s*")
COMPRESSED_KINDS = ("table", "records", "compliance")


def _responses(media_type: str) -> dict[int | str, dict[str, Any]]:
    whole = contents("The file.", media_type)
    part = contents("The requested byte range.", media_type, status=206)
    return {**whole, **part, **NOT_MODIFIED, **problems(400, 404, 416)}


@router.get("/tables/{sha256}", response_class=FileResponse, responses=_responses("application/octet-stream"))
@router.head("/tables/{sha256}", include_in_schema=False)
def get_table(sha256: str, request: Request, service: ServiceDep) -> Response:
    """A table file (spec/formats/table.md), whole or in ranges, compressed with zstd or gzip if accepted."""
    return _file(request, service, service.stores.tables, "table", sha256, "application/octet-stream")


@router.get(
    "/records/{sha256}", response_class=FileResponse, responses=_responses("application/octet-stream")
)
@router.head("/records/{sha256}", include_in_schema=False)
def get_records(sha256: str, request: Request, service: ServiceDep) -> Response:
    """The records of the paper's state search for one table (spec/formats/table.md), like a table file."""
    return _file(request, service, service.stores.records, "records", sha256, "application/octet-stream")


@router.get(
    "/compliances/{sha256}", response_class=FileResponse, responses=_responses("application/octet-stream")
)
@router.head("/compliances/{sha256}", include_in_schema=False)
def get_compliance(sha256: str, request: Request, service: ServiceDep) -> Response:
    """How a tree yields to forces at its points (spec/formats/compliance.md), like a table file."""
    store = service.stores.compliances
    return _file(request, service, store, "compliance", sha256, "application/octet-stream")


@router.get("/meshes/{sha256}", response_class=FileResponse, responses=_responses("model/gltf-binary"))
@router.head("/meshes/{sha256}", include_in_schema=False)
def get_mesh(sha256: str, request: Request, service: ServiceDep) -> Response:
    """The render mesh of a tree: a GLB whose vertex order matches its table."""
    return _file(request, service, service.stores.meshes, "mesh", sha256, "model/gltf-binary")


def _byte_ranges(request: Request) -> str | None:
    """The Range header; None without one, or with an unknown unit, which is ignored (RFC 9110, 14.2)."""
    ranges = request.headers.get("range")
    unit, equals, _ = (ranges or "").partition("=")
    return None if equals and unit.strip().lower() != "bytes" else ranges


def _drop_range(request: Request) -> None:
    """Hide a Range header with an unknown unit from the response, which would refuse it."""
    request.scope["headers"] = [(name, value) for name, value in request.scope["headers"] if name != b"range"]


def _check_ranges(ranges: str, size: int) -> None:
    """ProblemError 400 or 416 for ranges of bytes that are malformed, or all beyond a file of this size."""
    if not _RANGE.fullmatch(ranges):
        raise ProblemError(400, "bad-range", "Invalid Range header", hint="Send bytes=FIRST-LAST.")
    spans = [span.strip().partition("-") for span in ranges.partition("=")[2].split(",")]
    if any(first and last and int(last) < int(first) for first, _, last in spans):
        raise ProblemError(400, "bad-range", "Invalid Range header", hint="FIRST must not exceed LAST.")
    if all((int(first) >= size) if first else int(last) == 0 for first, _, last in spans):
        raise ProblemError(
            416,
            "range-beyond-end",
            "The range lies beyond the end of the file",
            hint=f"The file has {size} bytes.",
            headers={"Content-Range": f"bytes */{size}"},
        )


def _file(
    request: Request, service: Service, store: FileStore, kind: str, sha256: str, media_type: str
) -> Response:
    if not store.has(sha256):
        raise not_found(kind, sha256)
    store.check(sha256)  # a damaged file must not be cached as immutable
    ranges = _byte_ranges(request)
    if ranges is None:
        _drop_range(request)
    else:
        _check_ranges(ranges, store.path(sha256).stat().st_size)
    # ranges refer to the uncompressed bytes
    compressed = kind in COMPRESSED_KINDS and not ranges
    coding = coding_of(request.headers.get("accept-encoding", "")) if compressed else None
    folder = service.settings.cache_dir / "encoded"
    path = encoded_file(folder, sha256, coding, lambda: store.get(sha256)) if coding else None
    etag = f'"{sha256}-{coding}"' if path else f'"{sha256}"'
    headers = {"ETag": etag, "Cache-Control": IMMUTABLE_CACHE, "Vary": "Accept-Encoding"}
    # the content never changes, so a copy in any encoding is current: the compressed file may have been
    # created between two requests of the same client
    if_none_match = request.headers.get("if-none-match", "")
    if any(
        etag_matches(if_none_match, f'"{sha256}{end}"')
        for end in ("", *(f"-{known}" for known in PREFERRED_CODINGS))
    ):
        return Response(status_code=304, headers=headers)
    if path is None or coding is None:
        return FileResponse(store.path(sha256), media_type=media_type, headers=headers)
    headers["Content-Encoding"] = coding
    return FileResponse(path, media_type=media_type, headers=headers)
