"""Validation of wind documents, with the parser that the socket and the simulation use."""

from __future__ import annotations

import asyncio
import json
from typing import Any

from fastapi import APIRouter, Request
from galewood.motion.wind import parse_wind
from pydantic import BaseModel

from galewood_server.http import ProblemError, problems, read_body

router = APIRouter(prefix="/api/winds", tags=["winds"])
LARGEST_BYTES = 64 * 1024


class WindOut(BaseModel):
    """A valid wind document (spec/formats/wind.md)."""

    wind: dict[str, Any]


WIND_BODY: dict[str, Any] = {
    "requestBody": {"required": True, "content": {"application/json": {"schema": {"type": "object"}}}}
}


@router.post("/validate", openapi_extra=WIND_BODY, responses=problems(413, 422))
async def validate(request: Request) -> WindOut:
    """Validate a wind document (spec/formats/wind.md) and return it in its shortest form as `wind`.

    422 `bad-wind` names the path of the invalid field and the allowed values.
    """
    title, hint = "The wind document is too large", f"At most {LARGEST_BYTES} bytes."
    too_large = ProblemError(413, "wind-too-large", title, hint=hint)
    body = await read_body(request, LARGEST_BYTES, too_large)
    return await asyncio.to_thread(lambda: WindOut(wind=parse_wind(_json(body.take().tobytes())).document()))


def _json(body: bytes) -> object:
    try:
        return json.loads(body)
    except (ValueError, RecursionError):
        raise ProblemError(
            422, "bad-wind", "The wind document is not JSON", detail="wind: expected a JSON object"
        ) from None
