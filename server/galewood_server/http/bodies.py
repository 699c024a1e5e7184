"""Bodies of requests, received with a limit of their size."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator

from fastapi import Request

from galewood_server.http.errors import ProblemError

DRAIN_S = 2.0


async def read_body(request: Request, limit_bytes: int, too_large: ProblemError) -> bytearray:
    """The whole body, without a copy, which would keep the event loop.

    Raises `too_large` if its declared or actual length exceeds the limit.
    """
    body = bytearray()
    async for chunk in body_in_chunks(request, limit_bytes, too_large):
        body += chunk
    return body


async def body_in_chunks(
    request: Request, limit_bytes: int, too_large: ProblemError
) -> AsyncGenerator[bytes, None]:
    """The body as it arrives. Raises `too_large` if its declared or actual length exceeds the limit."""
    declared = request.headers.get("content-length", "")
    stream = request.stream()
    if declared.isdigit() and int(declared) > limit_bytes:
        await drain(stream)
        raise too_large
    received = 0
    async for chunk in stream:
        received += len(chunk)
        if received > limit_bytes:
            await drain(stream)
            raise too_large
        yield chunk


async def drain(stream: AsyncGenerator[bytes, None]) -> None:
    """Discard what a client is still sending: otherwise it sees a reset instead of the response."""
    try:
        async with asyncio.timeout(DRAIN_S):
            async for _ in stream:
                pass
    except TimeoutError:
        pass
