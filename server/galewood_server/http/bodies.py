"""Bodies of requests, received with a limit of their size."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import AsyncGenerator, Callable
from typing import TypeVar

import numpy as np
from fastapi import Request
from galewood.util import Cancelled
from starlette.requests import ClientDisconnect

from galewood_server.http.errors import ProblemError

DRAIN_S = 2.0
Result = TypeVar("Result")


async def read_body(request: Request, limit_bytes: int, too_large: ProblemError) -> Body:
    """Receive the whole body. Raises `too_large` if its declared or actual length exceeds the limit."""
    return Body([chunk async for chunk in body_in_chunks(request, limit_bytes, too_large)])


class Body:
    """A body as it was received: in pieces, because to join or to free many MB would keep the event loop."""

    def __init__(self, chunks: list[bytes]) -> None:
        self._chunks = chunks

    def take(self) -> memoryview:
        """The bytes, which this object has no longer. Call it in a thread."""
        chunks, self._chunks = self._chunks, []
        # not bytes: NumPy has large arrays in large pages, which are freed at once
        data = np.empty(sum(map(len, chunks)), np.uint8)
        start = 0
        for chunk in chunks:
            data[start : start + len(chunk)] = np.frombuffer(chunk, np.uint8)
            start += len(chunk)
        return data.data


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


async def while_connected(request: Request, work: Callable[[Callable[[], bool]], Result]) -> Result:
    """Do work in a thread for a request whose body is received.

    `work` is given a function that says whether the client still waits; if not it may raise Cancelled, which
    becomes a ClientDisconnect.
    """
    left = threading.Event()

    async def watch() -> None:
        while (await request.receive())["type"] != "http.disconnect":
            pass
        left.set()

    watching = asyncio.create_task(watch())
    try:
        return await asyncio.to_thread(work, lambda: not left.is_set())
    except Cancelled:
        raise ClientDisconnect from None
    finally:
        watching.cancel()
