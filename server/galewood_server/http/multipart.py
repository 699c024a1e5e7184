"""Parses the multipart form of an upload (one file and a few short fields) with a size limit."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

from fastapi import Request
from galewood.options import list_fields
from galewood.util import shown_text
from pydantic import ValidationError
from python_multipart.multipart import parse_options_header
from starlette.datastructures import FormData, UploadFile
from starlette.formparsers import MultiPartParser

from galewood_server.http.bodies import body_in_chunks, drain
from galewood_server.http.errors import ProblemError
from galewood_server.http.schemas import TreeChanges

FORM_OVERHEAD_BYTES = 64 * 1024  # boundaries, part headers and the text fields
MOST_FIELDS = 16
FIELDS = tuple(TreeChanges.model_fields)
LISTS = list_fields(TreeChanges)


def _form_field(name: str, described: dict[str, Any]) -> dict[str, Any]:
    """The description of a field as text: a form has no null, and a list is separated by commas."""
    kind: dict[str, Any] = next(one for one in described["anyOf"] if one["type"] != "null")
    if name in LISTS:
        return {"type": "string", "description": f"{described['description']} Separated by commas."}
    return {**kind, "description": described["description"]}


def _upload_form() -> dict[str, Any]:
    """What OpenAPI says of the form: a file and the fields of `TreeChanges`."""
    fields: dict[str, Any] = TreeChanges.model_json_schema()["properties"]
    file = {
        "type": "string",
        "format": "binary",
        "description": "GLB, OBJ, PLY, STL, FBX, DAE or 3DS, a ZIP archive of one model with its buffers and "
        "textures, or the cylinders of a scanned tree: MAT or CSV",
    }
    schema = {
        "type": "object",
        "required": ["file"],
        "additionalProperties": False,
        "properties": {"file": file, **{name: _form_field(name, one) for name, one in fields.items()}},
    }
    return {"requestBody": {"required": True, "content": {"multipart/form-data": {"schema": schema}}}}


UPLOAD_FORM = _upload_form()


@dataclass(frozen=True)
class Upload:
    """An uploaded file's bytes, its base name and the given name and import options."""

    data: bytes
    filename: str
    changes: TreeChanges


async def read_upload(request: Request, limit_bytes: int) -> Upload:
    """Parse and validate the form of an upload. ProblemError 400, 413, 415 or 422."""
    if not request.headers.get("content-type", "").startswith("multipart/form-data"):
        raise ProblemError(
            415,
            "not-a-form",
            "The upload is not a multipart form",
            hint="Send multipart/form-data with a part named 'file'.",
        )
    room = limit_bytes + FORM_OVERHEAD_BYTES
    chunks = body_in_chunks(request, room, _too_large(limit_bytes))
    body = _few_parts(chunks, _delimiter(request))
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
    return Upload(data, bare_name(file.filename or ""), _changes(fields))


def _changes(fields: dict[str, str]) -> TreeChanges:
    """The validated fields; empty ones are left out. ProblemError 422."""
    given = {name: text.strip() for name, text in fields.items() if text.strip()}
    values = {
        name: [one.strip() for one in text.split(",")] if name in LISTS else text
        for name, text in given.items()
    }
    try:
        return TreeChanges.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"])
        raise ProblemError(422, "invalid-field", f"Invalid field {field!r}", detail=first["msg"]) from None


def bare_name(filename: str) -> str:
    """The base name of a client's file name, fit to be shown; only for display."""
    last = PurePosixPath(filename.replace("\\", "/")).name
    return shown_text(last[-120:]) or "mesh"


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
            await drain(chunks)
            raise _broken_form("It has too many parts, or the file contains the boundary.")
        # a delimiter that is complete here does not begin in the rest
        rest = piece[max(0, len(piece) - len(delimiter) + 1) :]
        yield chunk


def _broken_form(detail: str) -> ProblemError:
    title, hint = "The form could not be read", "Send multipart/form-data with one part named 'file'."
    return ProblemError(400, "broken-form", title, detail=detail, hint=hint)


def _too_large(limit_bytes: int) -> ProblemError:
    return ProblemError(
        413,
        "upload-too-large",
        f"The file is larger than {limit_bytes // 1024 // 1024} MB",
        detail=f"The limit is {limit_bytes} bytes.",
        hint="Reduce the texture size or the number of triangles, or send text formats in a ZIP archive.",
    )
