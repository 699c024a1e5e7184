"""The WebSocket /ws/forest: one session per client, using the protocol of spec/formats/wire.md."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Mapping
from typing import Any

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from galewood.constants import TICK_HZ, WIRE_VERSION
from galewood.motion.wind import Wind, WindError, WindState, parse_wind, parse_wind_or_state

from galewood_server.access import client_key
from galewood_server.api.connections import limited_connection
from galewood_server.context import Service, service_of
from galewood_server.http import ProblemError, check_query
from galewood_server.peers import RELAYED_HEADER, SERVICE_RESTART, PeerLostError, peer_of, relay
from galewood_server.storage import DamagedFileError
from galewood_server.stream import (
    INVALID_DATA,
    POLICY_VIOLATION,
    UNSUPPORTED_DATA,
    SessionError,
    Subscription,
    protocol_of,
    wire,
)

router = APIRouter()
log = logging.getLogger("galewood.stream")
CHUNK_BYTES = 256 * 1024
HELLO_S = 10.0
PULLS_PER_S = 40.0
GUSTS_PER_S, MOST_GUSTS = 0.5, 3.0
"""Gust fronts of one client per second, and in a row."""


@router.websocket("/ws/forest")
async def forest_socket(websocket: WebSocket) -> None:
    """Serve a client, if the connection limits permit, until either side closes the socket."""
    service = service_of(websocket)
    async with limited_connection(websocket, service) as accepted:
        if accepted:
            await _serve(websocket, service)


async def _serve(websocket: WebSocket, service: Service) -> None:
    """Serve a client here, or by the server that holds the shared forest which its address names."""
    session, share = Session(websocket, service), websocket.query_params.get("share")
    try:
        check_query(websocket.query_params, {"share"})
    except ProblemError as error:
        problem = error.problem
        await session.refuse(SessionError(problem.code, problem.title, problem.hint))
        return
    if share and not wire.is_share(share):  # FOREST will say what is wrong
        share = None
    async with service.owners.wanted(share):
        try:
            peer = await peer_of(service.owners, share, session.address, RELAYED_HEADER in websocket.headers)
        except SessionError as error:
            await session.refuse(error)
        except PeerLostError as error:
            log.info("asked a client to reconnect: %s", error)
            await websocket.accept()
            await websocket.close(SERVICE_RESTART, "Reconnect")
        else:
            if peer is None:
                await session.run()
            else:
                await relay(websocket, peer, service.settings.socket_stall_s)


class Allowance:
    """A token bucket: `rate` per second, at most `most` at once."""

    def __init__(self, rate: float, most: float) -> None:
        self._rate, self._most, self._left, self._counted_s = rate, most, most, time.monotonic()

    def take(self) -> bool:
        """Take one; False if there is none left."""
        now_s = time.monotonic()
        self._left = min(self._most, self._left + (now_s - self._counted_s) * self._rate)
        self._counted_s = now_s
        if self._left < 1:
            return False
        self._left -= 1
        return True


class Session:
    """One client's session: processes its requests and holds its forest subscription."""

    def __init__(self, websocket: WebSocket, service: Service) -> None:
        self._websocket = websocket
        self._service = service
        self._protocol = protocol_of(websocket.scope)
        self.address = client_key(websocket.scope)
        self._subscription: Subscription | None = None
        self._asked = False  # for a forest; in mode "table" there may be none on the server
        self._sending: asyncio.Task[None] | None = None
        self._allowance = service.settings.socket_messages_per_s
        self._counted_s = time.monotonic()
        self._pulls, self._gusts = Allowance(PULLS_PER_S, PULLS_PER_S), Allowance(GUSTS_PER_S, MOST_GUSTS)

    async def run(self) -> None:
        """Serve until the client disconnects or causes an error."""
        await self._websocket.accept()
        try:
            async with asyncio.TaskGroup() as tasks:
                await self._handshake()
                while True:
                    await self._answer(await self._receive(), tasks)
        except* WebSocketDisconnect:
            pass
        except* SessionError as group:
            self._leave()
            await self._close_with_error(_first_error(group))
        finally:
            self._leave()

    async def refuse(self, error: SessionError) -> None:
        """Accept the socket only to say why it is closed."""
        await self._websocket.accept()
        await self._close_with_error(error)

    async def _handshake(self) -> None:
        try:
            async with asyncio.timeout(HELLO_S):
                first = await self._receive()
        except TimeoutError:
            raise SessionError("no-hello", "HELLO was not received in time") from None
        if not isinstance(first, wire.Hello):
            raise SessionError("no-hello", "The first message must be HELLO")
        await self._send(wire.Welcome(self._service.server_name, WIRE_VERSION, TICK_HZ))

    async def _receive(self) -> wire.Request:
        message = await self._websocket.receive()
        if message["type"] == "websocket.disconnect":
            raise WebSocketDisconnect(message.get("code", 1005))
        data = message.get("bytes")
        if data is None:
            raise SessionError("not-binary", "Messages must be binary, not text", close=UNSUPPORTED_DATA)
        self._check_message_rate()
        try:
            return wire.decode_request(data)
        except wire.WireError as error:
            close = INVALID_DATA if error.code == "malformed-message" else POLICY_VIOLATION
            raise SessionError(error.code, f"{error}"[:1].upper() + f"{error}"[1:], close=close) from None

    def _check_message_rate(self) -> None:
        """Limit the message rate with a token bucket that holds two seconds of messages."""
        rate, now_s = self._service.settings.socket_messages_per_s, time.monotonic()
        self._allowance = min(2 * rate, self._allowance + (now_s - self._counted_s) * rate) - 1
        self._counted_s = now_s
        if self._allowance < 0:
            raise SessionError("too-many-messages", f"More than {rate:g} messages per second")

    async def _answer(self, request: wire.Request, tasks: asyncio.TaskGroup) -> None:
        if not self._asked and not isinstance(request, wire.Forest | wire.Ping | wire.Hello):
            raise SessionError(
                "no-forest", "This message concerns a forest, but none was requested", "Send FOREST first."
            )
        match request:
            case wire.Ping():
                await self._send(wire.Pong(request.t, asyncio.get_running_loop().time()))
            case wire.WindChange():
                wind = _wind(request.wind)
                if self._subscription:
                    forest = self._subscription.forest
                    await self._service.forests.change_wind(forest, wind, self.address)
            case wire.Pause():
                if self._subscription:
                    self._subscription.forest.pause(request.paused)
            case wire.Pull():
                self._pull(request)
            case wire.Release():
                if self._subscription:
                    self._subscription.forest.release(self._subscription.client_buffer)
            case wire.Gust():
                if self._subscription and self._gusts.take():
                    self._subscription.forest.send_front(request.x, request.z)
            case wire.Resync():
                if self._subscription:
                    self._subscription.client_buffer.resync()
            case wire.Forest():
                await self._subscribe(request, tasks)
            case wire.Hello():
                raise SessionError("second-hello", "HELLO may be sent only once")

    def _pull(self, pull: wire.Pull) -> None:
        """Continue or begin a pull. Above the rate, or where the forest has no room for it, it is ignored."""
        subscription = self._subscription
        if subscription and self._pulls.take():
            subscription.forest.pull(subscription.client_buffer, pull)

    async def _subscribe(self, forest: wire.Forest, tasks: asyncio.TaskGroup) -> None:
        """Replace the current subscription or table transfer by the requested one."""
        wind = self._check(forest)
        await self._service.forests.admit(forest, self.address)
        await asyncio.to_thread(self._check_tables, forest)  # a bucket is asked for each of them
        self._asked = True
        if self._sending:
            self._sending.cancel()
            await asyncio.wait([self._sending])
        before, self._subscription = self._subscription, None
        if before and before.forest.share is None:  # its trees make room for the new ones
            self._service.forests.leave(before)
            before = None
        if before:
            before.client_buffer.streams = False
        try:
            if forest.mode == "stream" or forest.share is not None:
                self._subscription = await self._join(forest, wind)
        finally:
            if before:
                self._service.forests.leave(before)
        if forest.mode == "table":
            self._sending = tasks.create_task(self._send_tables(forest))

    async def _join(self, forest: wire.Forest, wind: WindState) -> Subscription:
        owners = self._service.owners
        async with owners.wanted(forest.share):
            if await owners.elsewhere(forest.share):
                raise SessionError(
                    "elsewhere",
                    "Another server runs this shared forest",
                    "Name the forest in the address of the socket: /ws/forest?share=…",
                )
            return await self._service.forests.join(forest, wind, self._protocol, self.address)

    def _leave(self) -> None:
        if self._subscription:
            self._service.forests.leave(self._subscription)
            self._subscription = None

    def _check(self, forest: wire.Forest) -> WindState:
        most, wind = self._service.settings.forest_groups, _wind_state(forest.wind)
        if len(forest.groups) > most:
            raise SessionError("too-many-groups", f"A forest may have up to {most} groups")
        return wind

    def _check_tables(self, forest: wire.Forest) -> None:
        for sha256 in dict.fromkeys(group.table for group in forest.groups):
            if not (self._service.forests.has_table(sha256) or self._service.stores.tables.has(sha256)):
                raise SessionError(
                    "no-such-table", f"There is no table {sha256[:12]}…", "Reload the list of trees."
                )

    async def _send_tables(self, forest: wire.Forest) -> None:
        for sha256 in dict.fromkeys(group.table for group in forest.groups):
            data = await asyncio.to_thread(self._read_table, sha256)
            await self._send_table(sha256, data, forest.have.get(sha256, 0))

    def _read_table(self, sha256: str) -> bytes:
        try:
            return self._service.stores.tables.get(sha256)
        except FileNotFoundError:
            raise SessionError("no-such-table", "A table of this forest no longer exists") from None
        except DamagedFileError:
            raise SessionError("no-such-table", "A table of this forest cannot be used") from None

    async def _send_table(self, sha256: str, data: bytes, start: int) -> None:
        """Send a table from byte `start` to its end; at least one, possibly empty, chunk."""
        if start > len(data):
            raise SessionError("no-such-offset", f"The table has {len(data)} bytes, not {start}")
        for offset in range(start, max(len(data), start + 1), CHUNK_BYTES):
            chunk = data[offset : offset + CHUNK_BYTES]
            await self._send(wire.TableChunk(sha256, offset, len(data), chunk))

    async def _send(self, reply: wire.Reply) -> None:
        """Send a message. A client that does not read is disconnected without a closing handshake."""
        try:
            async with asyncio.timeout(self._service.settings.socket_stall_s):
                await self._websocket.send_bytes(wire.encode_reply(reply))
        except TimeoutError:
            log.info("disconnected a client that does not read")
            self._protocol.abort()
            raise WebSocketDisconnect(1006, "the client does not read") from None
        except RuntimeError:
            if self._protocol.closing:  # closed by a later message before this reply was sent
                raise WebSocketDisconnect(1006) from None
            raise

    async def _close_with_error(self, error: SessionError) -> None:
        try:
            await self._send(error.failure)
            reason = error.failure.title.encode()[:120].decode(errors="ignore")
            await self._websocket.close(error.close, reason)
        except (WebSocketDisconnect, RuntimeError):
            self._protocol.abort()


def _wind(document: Mapping[str, Any]) -> Wind:
    try:
        return parse_wind(document)
    except WindError as error:
        raise SessionError("bad-wind", str(error)) from None


def _wind_state(document: Mapping[str, Any]) -> WindState:
    try:
        return parse_wind_or_state(document)
    except WindError as error:
        raise SessionError("bad-wind", str(error)) from None


def _first_error(group: BaseExceptionGroup[SessionError]) -> SessionError:
    inner = group.exceptions[0]
    return _first_error(inner) if isinstance(inner, BaseExceptionGroup) else inner
