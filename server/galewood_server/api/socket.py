"""The WebSocket /ws/forest: one session a client, the wire of docs/formats/wire.md."""

from __future__ import annotations

import asyncio
import hashlib
import logging
import time
from collections.abc import Mapping
from typing import Any

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from galewood.wind import Wind, WindError, WindState, parse_wind, parse_wind_or_state

from galewood_server.api.connections import counted_connection
from galewood_server.context import Service, service_of
from galewood_server.stream import (
    NOT_BINARY,
    REFUSED,
    UNREADABLE,
    WIRE_VERSION,
    Refusal,
    Subscription,
    WireError,
    protocol_of,
    wire,
)

router = APIRouter()
log = logging.getLogger("galewood.stream")
CHUNK_BYTES = 256 * 1024
HELLO_S = 10.0


@router.websocket("/ws/forest")
async def forest_socket(websocket: WebSocket) -> None:
    """Admit a client and serve it until either side has had enough."""
    service = service_of(websocket)
    async with counted_connection(websocket, service) as welcome:
        if welcome:
            await Session(websocket, service).run()


class Session:
    """One client: reads its requests, and keeps it in the forest that it asked for last."""

    def __init__(self, websocket: WebSocket, service: Service) -> None:
        self._websocket = websocket
        self._service = service
        self._protocol = protocol_of(websocket.scope)
        self._subscription: Subscription | None = None
        self._sending: asyncio.Task[None] | None = None
        self._allowance = service.settings.socket_messages_per_s
        self._counted_s = time.monotonic()

    async def run(self) -> None:
        """Serve until the client leaves or is refused."""
        await self._websocket.accept()
        try:
            async with asyncio.TaskGroup() as tasks:
                await self._greet()
                while True:
                    await self._answer(await self._receive(), tasks)
        except* WebSocketDisconnect:
            pass
        except* Refusal as group:
            self._leave()
            await self._refuse(_first(group))
        finally:
            self._leave()

    async def _greet(self) -> None:
        try:
            async with asyncio.timeout(HELLO_S):
                first = await self._receive()
        except TimeoutError:
            raise Refusal("no-hello", "HELLO did not arrive in time") from None
        if not isinstance(first, wire.Hello):
            raise Refusal("no-hello", "The first message must be HELLO")
        await self._send(wire.Welcome(self._service.server_name, WIRE_VERSION, wire.TICK_HZ))

    async def _receive(self) -> wire.Request:
        message = await self._websocket.receive()
        if message["type"] == "websocket.disconnect":
            raise WebSocketDisconnect(message.get("code", 1005))
        data = message.get("bytes")
        if data is None:
            raise Refusal("not-binary", "Messages are binary, not text", close=NOT_BINARY)
        self._count()
        try:
            return wire.decode_request(data)
        except WireError as error:
            close = UNREADABLE if error.code == "malformed-message" else REFUSED
            raise Refusal(error.code, f"{error}"[:1].upper() + f"{error}"[1:], close=close) from None

    def _count(self) -> None:
        """A client may send so many messages a second, and save up two seconds' worth."""
        rate, now_s = self._service.settings.socket_messages_per_s, time.monotonic()
        self._allowance = min(2 * rate, self._allowance + (now_s - self._counted_s) * rate) - 1
        self._counted_s = now_s
        if self._allowance < 0:
            raise Refusal("too-many-messages", f"More than {rate:g} messages a second")

    async def _answer(self, request: wire.Request, tasks: asyncio.TaskGroup) -> None:
        match request:
            case wire.Ping():
                await self._send(wire.Pong(request.t, asyncio.get_running_loop().time()))
            case wire.WindChange():
                wind = _wind(request.wind)
                if self._subscription:
                    self._subscription.forest.change_wind(wind)
            case wire.Pause():
                if self._subscription:
                    self._subscription.forest.pause(request.paused)
            case wire.Resync():
                if self._subscription:
                    self._subscription.client_buffer.resync()
            case wire.Forest():
                await self._subscribe(request, tasks)
            case wire.Hello():
                raise Refusal("second-hello", "HELLO comes once")

    async def _subscribe(self, forest: wire.Forest, tasks: asyncio.TaskGroup) -> None:
        """Go over to another forest, or begin to send tables, in place of what was before."""
        wind = self._check(forest)
        if self._sending:
            self._sending.cancel()
            await asyncio.wait([self._sending])
        before, self._subscription = self._subscription, None
        try:
            if forest.mode == "stream" or forest.share is not None:
                self._subscription = await self._service.forests.join(forest, wind, self._protocol)
        finally:
            if before:
                self._service.forests.leave(before)
        if forest.mode == "table":
            self._sending = tasks.create_task(self._send_tables(forest))

    def _leave(self) -> None:
        if self._subscription:
            self._service.forests.leave(self._subscription)
            self._subscription = None

    def _check(self, forest: wire.Forest) -> WindState:
        settings, wind = self._service.settings, _wind_state(forest.wind)
        if len(forest.groups) > settings.forest_groups:
            raise Refusal("too-many-groups", f"A forest may have up to {settings.forest_groups} groups")
        if sum(group.count for group in forest.groups) > settings.forest_trees:
            raise Refusal("too-many-trees", f"A forest may have up to {settings.forest_trees} trees")
        for group in forest.groups:
            if not self._service.stores.tables.has(group.table):
                raise Refusal(
                    "no-such-table", f"There is no table {group.table[:12]}…", "List the trees again."
                )
        return wind

    async def _send_tables(self, forest: wire.Forest) -> None:
        for sha256 in dict.fromkeys(group.table for group in forest.groups):
            data = await asyncio.to_thread(self._read_table, sha256)
            await self._send_table(sha256, data, forest.have.get(sha256, 0))

    def _read_table(self, sha256: str) -> bytes:
        try:
            data = self._service.stores.tables.get(sha256)
        except FileNotFoundError:
            raise Refusal("no-such-table", "A table of this forest is gone") from None
        if hashlib.sha256(data).hexdigest() != sha256:
            log.error("the stored table %s is damaged", sha256)
            raise Refusal("no-such-table", "A table of this forest cannot be used")
        return data

    async def _send_table(self, sha256: str, data: bytes, begin: int) -> None:
        """From byte `begin` to the end; a client that has all gets one empty piece."""
        if begin > len(data):
            raise Refusal("no-such-offset", f"The table has {len(data)} bytes, not {begin}")
        for offset in range(begin, max(len(data), begin + 1), CHUNK_BYTES):
            piece = data[offset : offset + CHUNK_BYTES]
            await self._send(wire.TableChunk(sha256, offset, len(data), piece))

    async def _send(self, reply: wire.Reply) -> None:
        """Send, or cut off a client that does not read: closing politely would wait for it for ever."""
        try:
            async with asyncio.timeout(self._service.settings.socket_stall_s):
                await self._websocket.send_bytes(wire.encode_reply(reply))
        except TimeoutError:
            log.info("dropped a client that does not read")
            self._protocol.abort()
            raise WebSocketDisconnect(1006, "the client does not read") from None
        except RuntimeError:
            if self._protocol.closing:  # what it sent next closed the socket before we could answer
                raise WebSocketDisconnect(1006) from None
            raise

    async def _refuse(self, refusal: Refusal) -> None:
        try:
            await self._send(refusal.failure)
            reason = refusal.failure.title.encode()[:120].decode(errors="ignore")
            await self._websocket.close(refusal.close, reason)
        except (WebSocketDisconnect, RuntimeError):
            self._protocol.abort()


def _wind(document: Mapping[str, Any]) -> Wind:
    try:
        return parse_wind(document)
    except WindError as error:
        raise Refusal("bad-wind", str(error)) from None


def _wind_state(document: Mapping[str, Any]) -> WindState:
    try:
        return parse_wind_or_state(document)
    except WindError as error:
        raise Refusal("bad-wind", str(error)) from None


def _first(group: BaseExceptionGroup[Refusal]) -> Refusal:
    inner = group.exceptions[0]
    return _first(inner) if isinstance(inner, BaseExceptionGroup) else inner
