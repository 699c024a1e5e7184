"""The WebSocket /ws/forest: one session a client, the wire of docs/formats/wire.md."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Coroutine, Mapping
from typing import TYPE_CHECKING, Any

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from precompute.table import TableError
from precompute.wind import Wind, WindError, WindState, parse_wind, parse_wind_or_state
from server import wire
from server.admission import admitted
from server.context import Service, service_of
from server.envelope import VERSION, WireError
from server.frames import FrameSlot
from server.socket_protocol import abort_of

if TYPE_CHECKING:
    from server.forest import ForestWalk

router = APIRouter()
log = logging.getLogger("galewood.stream")
CHUNK_BYTES = 256 * 1024
HELLO_S = 10.0
LATE_S = 0.25
UNREADABLE, REFUSED, NOT_BINARY = 1007, 1008, 1003  # close codes of RFC 6455


class Refusal(Exception):
    """The end of a session by the server: told to the client, then the socket is closed."""

    def __init__(self, code: str, title: str, hint: str = "", close: int = REFUSED) -> None:
        super().__init__(title)
        self.failure = wire.Failure(code, title, hint)
        self.close = close


@router.websocket("/ws/forest")
async def forest_socket(websocket: WebSocket) -> None:
    """Admit a client and serve it until either side has had enough."""
    service = service_of(websocket)
    async with admitted(websocket, service) as welcome:
        if welcome:
            await Session(websocket, service).run()


class Session:
    """One client: reads its requests, and keeps one task at work on what it asked for last."""

    def __init__(self, websocket: WebSocket, service: Service) -> None:
        self._websocket = websocket
        self._service = service
        self._abort = abort_of(websocket.scope)
        self._walk: ForestWalk | None = None
        self._work: asyncio.Task[None] | None = None
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
            await self._refuse(_first(group))

    async def _greet(self) -> None:
        try:
            async with asyncio.timeout(HELLO_S):
                first = await self._receive()
        except TimeoutError:
            raise Refusal("no-hello", "HELLO did not arrive in time") from None
        if not isinstance(first, wire.Hello):
            raise Refusal("no-hello", "The first message must be HELLO")
        await self._send(wire.Welcome(self._service.server_name, VERSION, wire.TICK_HZ))

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
                await self._send(wire.Pong(request.t))
            case wire.WindChange():
                wind = _wind(request.wind)
                if self._walk:
                    await self._send(wire.WindState(self._walk.change_wind(wind).document()))
            case wire.Forest():
                await self._plant(request, tasks)
            case wire.Hello():
                raise Refusal("second-hello", "HELLO comes once")

    async def _plant(self, forest: wire.Forest, tasks: asyncio.TaskGroup) -> None:
        """Begin on a new forest in place of the one before."""
        self._check(forest)
        work: Coroutine[Any, Any, None]
        if forest.mode == "table":
            self._walk = None
            work = self._send_tables(forest)
        else:
            self._walk = await asyncio.to_thread(self._make_walk, forest)
            work = self._play(self._walk)
        if self._work:
            self._work.cancel()
            await asyncio.wait([self._work])
        self._work = tasks.create_task(work)

    def _check(self, forest: wire.Forest) -> None:
        settings = self._service.settings
        _wind_state(forest.wind)
        if len(forest.groups) > settings.forest_groups:
            raise Refusal("too-many-groups", f"A forest may have up to {settings.forest_groups} groups")
        if sum(group.count for group in forest.groups) > settings.forest_trees:
            raise Refusal("too-many-trees", f"A forest may have up to {settings.forest_trees} trees")
        for group in forest.groups:
            if not self._service.stores.tables.has(group.table):
                raise Refusal(
                    "no-such-table", f"There is no table {group.table[:12]}…", "List the trees again."
                )

    def _make_walk(self, forest: wire.Forest) -> ForestWalk:
        from server.forest import ForestWalk  # compiled lookups: the page need not wait for them to load

        try:
            tables = [self._service.shelf.take(group.table) for group in forest.groups]
        except (FileNotFoundError, TableError) as error:
            log.warning("a table cannot be used: %s", error)
            raise Refusal("no-such-table", "A table of this forest cannot be used") from None
        wind, easing = _wind_state(forest.wind), forest.pose_easing
        return ForestWalk(
            tables, forest.groups, forest.trees, wind,
            start_s=forest.time_s, pose_easing=easing, method=forest.method,
        )  # fmt: skip

    async def _send_tables(self, forest: wire.Forest) -> None:
        for sha256 in dict.fromkeys(group.table for group in forest.groups):
            data = await asyncio.to_thread(self._service.stores.tables.get, sha256)
            for offset in range(0, len(data), CHUNK_BYTES):
                piece = data[offset : offset + CHUNK_BYTES]
                await self._send(wire.TableChunk(sha256, offset, len(data), piece))

    async def _play(self, walk: ForestWalk) -> None:
        """Walk in time with the clock and send what is newest, each at its own pace."""
        slot = FrameSlot()
        slot.put(walk.time_s, walk.poses())
        async with asyncio.TaskGroup() as pair:
            pair.create_task(self._walk_in_time(walk, slot))
            pair.create_task(self._send_newest(slot))

    async def _walk_in_time(self, walk: ForestWalk, slot: FrameSlot) -> None:
        loop = asyncio.get_running_loop()
        due_s = loop.time()
        while True:
            due_s = max(
                due_s + 1 / wire.TICK_HZ, loop.time() - LATE_S
            )  # a late forest slows rather than races
            await asyncio.sleep(due_s - loop.time())
            await loop.run_in_executor(self._service.walkers, walk.step)
            slot.put(walk.time_s, walk.poses())

    async def _send_newest(self, slot: FrameSlot) -> None:
        while True:
            await self._send(await slot.take())

    async def _send(self, reply: wire.Reply) -> None:
        """Send, or cut off a client that does not read: closing politely would wait for it for ever."""
        try:
            async with asyncio.timeout(self._service.settings.socket_stall_s):
                await self._websocket.send_bytes(wire.encode_reply(reply))
        except TimeoutError:
            log.info("dropped a client that does not read")
            self._abort()
            raise WebSocketDisconnect(1006, "the client does not read") from None

    async def _refuse(self, refusal: Refusal) -> None:
        try:
            await self._send(refusal.failure)
            reason = refusal.failure.title.encode()[:120].decode(errors="ignore")
            await self._websocket.close(refusal.close, reason)
        except (WebSocketDisconnect, RuntimeError):
            self._abort()


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
