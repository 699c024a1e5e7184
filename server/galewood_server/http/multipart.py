"""Parses the multipart form of an upload (one file and a few short fields) with a size limit."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

from fastapi import Request
from galewood.util import shown_text
from python_multipart.multipart import parse_options_header
from starlette.datastructures import FormData, UploadFile
from starlette.formparsers import MultiPartParser

from galewood_server.http.errors import ProblemError

FORM_OVERHEAD_BYTES = 64 * 1024  # boundaries, part headers and the text fields
DRAIN_S = 2.0
MOST_FIELDS = 16
FIELDS = (
    "species", "height_m", "name", "up_axis", "wood_materials", "leaves", "drop", "tree", "dbh_cm",
    "min_radius_mm", "bare", "complete",
)  # fmt: skip
UPLOAD_FORM: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "additionalProperties": False,
                    "properties": {
                        "file": {
                            "type": "string",
                            "format": "binary",
                            "description": "GLB, OBJ, PLY, STL, FBX, DAE or 3DS, a ZIP archive of one model "
                            "with its buffers and textures, or the cylinders of a scanned tree: MAT or CSV",
                        },
                        "species": {"type": "string", "description": "See GET /api/species"},
                        "height_m": {"type": "number", "exclusiveMinimum": 0.1, "maximum": 150},
                        "name": {"type": "string", "maxLength": 200},
                        "up_axis": {"type": "string", "enum": ["x", "y", "z", "-x", "-y", "-z"]},
                        "wood_materials": {
                            "type": "string",
                            "description": "Comma-separated names of wood materials, nodes or meshes, or "
                            "ids of pieces that are wood",
                        },
                        "leaves": {
                            "type": "string",
                            "description": "Comma-separated names or ids of pieces that are leaves",
                        },
                        "drop": {
                            "type": "string",
                            "description": "Comma-separated names or ids of pieces that are left out",
                        },
                        "tree": {
                            "type": "integer",
                            "minimum": 1,
                            "description": "Which tree of a file with several",
                        },
                        "dbh_cm": {
                            "type": "number",
                            "exclusiveMinimum": 0.5,
                            "maximum": 1500,
                            "description": "Scanned tree: diameter of the trunk at 1.3 m",
                        },
                        "min_radius_mm": {
                            "type": "number",
                            "minimum": 0,
                            "maximum": 500,
                            "description": "Scanned tree: thinner branches are dropped",
                        },
                        "bare": {"type": "boolean", "description": "Scanned tree: add no leaves"},
                        "complete": {
                            "type": "boolean",
                            "description": "Whether wood is added where foliage has none; default: where "
                            "it is needed",
                        },
                    },
                }
            }
        },
    }
}


@dataclass(frozen=True)
class Upload:
    """An uploaded file's bytes, its base name and the given text fields."""

    data: bytes
    filename: str
    fields: dict[str, str]


async def read_upload(request: Request, limit_bytes: int) -> Upload:
    """Parse the form of an upload. ProblemError 400, 413, 415 or 422."""
    if not request.headers.get("content-type", "").startswith("multipart/form-data"):
        raise ProblemError(
            415,
            "not-a-form",
            "The upload is not a multipart form",
            hint="Send multipart/form-data with a part named 'file'.",
        )
    body = _few_parts(_limited(request, limit_bytes), _delimiter(request))
    parser = MultiPartParser(
        request.headers, body, max_files=1, max_fields=MOST_FIELDS, max_part_size=FORM_OVERHEAD_BYTES
    )
    form = await parser.parse()
    try:
        return await _upload_of(form, limit_bytes)
    finally:
        await form.close()


async def _upload_of(form: FormData, limit_bytes: int) -> Upload:
    file = form.get("file")
    if not isinstance(file, UploadFile):
        raise ProblemError(400, "no-file", "The form has no file", hint="Name the part with the mesh 'file'.")
    fields = {key: value for key, value in form.multi_items() if isinstance(value, str)}
    unknown = sorted(set(fields) - set(FIELDS))
    if unknown:
        raise ProblemError(
            422,
            "unknown-field",
            f"Unknown field {unknown[0][:40]!r}",
            hint=f"Allowed fields: file, {', '.join(FIELDS)}.",
        )
    data = await file.read(limit_bytes + 1)
    if len(data) > limit_bytes:
        raise _too_large(limit_bytes)
    return Upload(data, bare_name(file.filename or ""), {key: value.strip() for key, value in fields.items()})


def bare_name(filename: str) -> str:
    """The base name of a client's file name, fit to be shown; only for display."""
    last = PurePosixPath(filename.replace("\\", "/")).name
    return shown_text(last[-120:]) or "mesh"


async def _limited(request: Request, limit_bytes: int) -> AsyncGenerator[bytes, None]:
    """The request body in chunks. ProblemError 413 if its declared or actual length exceeds the limit."""
    room = limit_bytes + FORM_OVERHEAD_BYTES
    declared = request.headers.get("content-length", "")
    stream = request.stream()
    if declared.isdigit() and int(declared) > room:
        await _drain(stream)
        raise _too_large(limit_bytes)
    received = 0
    async for chunk in stream:
        received += len(chunk)
        if received > room:
            await _drain(stream)
            raise _too_large(limit_bytes)
        yield chunk


def _delimiter(request: Request) -> bytes:
    """What separates the parts of the form. ProblemError 400."""
    _, parameters = parse_options_header(request.headers["content-type"])
    boundary = parameters.get(b"boundary")
    if not boundary:
        raise _broken_form("Its Content-Type has no boundary.")
    return b"\r\n--" + boundary


async def _few_parts(chunks: AsyncGenerator[bytes, None], delimiter: bytes) -> AsyncGenerator[bytes, None]:
    """The chunks of a body. ProblemError 400 for more delimiters than a form has.

    The parser looks at each of them step by step, on the event loop: 64 MB of delimiters would take seconds.
    """
    found, rest = 0, b"\r\n"  # the first delimiter is at the beginning of a line that none precedes
    async for chunk in chunks:
        piece = rest + chunk
        found += piece.count(delimiter)
        if found > MOST_FIELDS + 2:  # the file, and the end
            await _drain(chunks)
            raise _broken_form("It has too many parts, or the file contains the boundary.")
        # a delimiter that is complete here does not begin in the rest
        rest = piece[max(0, len(piece) - len(delimiter) + 1) :]
        yield chunk


def _broken_form(detail: str) -> ProblemError:
    title, hint = "The form could not be read", "Send multipart/form-data with one part named 'file'."
    return ProblemError(400, "broken-form", title, detail=detail, hint=hint)


async def _drain(stream: AsyncGenerator[bytes, None]) -> None:
    # A client that is still sending would see a connection reset instead of the response: discard its data.
    try:
        async with asyncio.timeout(DRAIN_S):
            async for _ in stream:
                pass
    except TimeoutError:
        pass


def _too_large(limit_bytes: int) -> ProblemError:
    return ProblemError(
        413,
        "upload-too-large",
        f"The file is larger than {limit_bytes // 1024 // 1024} MB",
        detail=f"The limit is {limit_bytes} bytes.",
        hint="Reduce the texture size or the number of triangles, or send text formats in a ZIP archive.",
    )
