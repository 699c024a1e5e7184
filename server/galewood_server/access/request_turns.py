"""Requests take turns with the streams: however many wait, frames are computed and sent on time."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable

from starlette.types import ASGIApp, Receive, Scope, Send

from galewood_server.access.rates import client_key

LOOK_S = 0.001
"""Time between two looks at whether the frames are sent."""
LONGEST_S = 0.02
"""The longest time for which frames keep the next request waiting, so that streams never stop the rest."""


class RequestTurns:
    """ASGI middleware that begins at most one request in each turn of the event loop, and none while
    `frames_in_work()`.

    A request takes milliseconds of the loop. Those of many clients, begun in the same turn, would delay the
    frames of all streams by their sum. The addresses of clients take turns too: many requests of one make
    the others wait no longer.
    """

    def __init__(self, app: ASGIApp, frames_in_work: Callable[[], bool]) -> None:
        self._app = app
        self._frames_in_work = frames_in_work
        self._waiting: dict[str, deque[asyncio.Future[None]]] = {}
        self._free = True
        """Whether no request has begun in this turn of the loop, and none waits."""
        self._wait_until_s = 0.0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request or the opening of a WebSocket on when it is its turn."""
        if scope["type"] in ("http", "websocket"):
            await self._turn(client_key(scope))
        await self._app(scope, receive, send)

    async def _turn(self, address: str) -> None:
        loop = asyncio.get_running_loop()
        if self._free and not self._frames_in_work():
            self._free = False
            loop.call_soon(self._next, loop)
            return
        place: asyncio.Future[None] = loop.create_future()
        self._waiting.setdefault(address, deque()).append(place)
        if self._free:
            self._free = False
            self._wait_until_s = loop.time() + LONGEST_S
            loop.call_later(LOOK_S, self._next, loop)
        await place

    def _next(self, loop: asyncio.AbstractEventLoop) -> None:
        """Begin the request that has waited longest of the address whose turn it is."""
        if self._waiting and self._frames_in_work() and loop.time() < self._wait_until_s:
            loop.call_later(LOOK_S, self._next, loop)
            return
        place = self._first()
        self._free = place is None
        if place is not None:
            self._wait_until_s = loop.time() + LONGEST_S
            place.set_result(None)
            loop.call_soon(self._next, loop)

    def _first(self) -> asyncio.Future[None] | None:
        while self._waiting:
            address = next(iter(self._waiting))
            places = self._waiting.pop(address)
            place = places.popleft()
            if places:
                self._waiting[address] = places
            if not place.done():  # not that of a request that was cancelled
                return place
        return None
