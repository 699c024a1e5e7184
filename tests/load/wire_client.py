"""Sparing HTTP and WebSocket clients, each with an address of its own (`X-Forwarded-For`)."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

from galewood.constants import WIRE_FRAME
from galewood_server.cli.bench_client import masked
from galewood_server.stream import wire

PATIENCE_S = 30.0


class Refused(Exception):
    """The server refused a connection or closed it; the text is its status or close code."""


@dataclass
class Target:
    """The server, and what a client needs to know of it."""

    port: int
    key: str
    table: str = ""
    mesh: str = ""
    may_fail: bool = False
    """Whether servers are killed, so that connections may break."""

    async def connect(self, limit: int = 1 << 16) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """A connection. `limit` is the size of its read buffer in bytes."""
        async with asyncio.timeout(PATIENCE_S):
            return await asyncio.open_connection("127.0.0.1", self.port, limit=limit)


@contextmanager
def aborted(writer: asyncio.StreamWriter) -> Generator[None]:
    """Drop a connection after the block, also when its task is cancelled."""
    try:
        yield
    finally:
        writer.transport.abort()


def request_bytes(
    method: str, path: str, address: str, headers: Mapping[str, str] | None = None, body: bytes = b""
) -> bytes:
    """An HTTP/1.1 request."""
    lines = [f"{method} {path} HTTP/1.1", "Host: localhost", f"X-Forwarded-For: {address}"]
    lines += [f"{name}: {value}" for name, value in (headers or {}).items()]
    if body or method == "POST":
        lines.append(f"Content-Length: {len(body)}")
    return "\r\n".join([*lines, "", ""]).encode() + body


async def read_head(reader: asyncio.StreamReader) -> tuple[int, dict[str, str]]:
    """Status and headers of a response."""
    async with asyncio.timeout(PATIENCE_S):
        head = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1")
    first, *rest = head.split("\r\n")
    headers = {name.lower(): value.strip() for name, _, value in (line.partition(":") for line in rest)}
    return int(first.split()[1]), headers


async def ask(
    target: Target,
    method: str,
    path: str,
    address: str,
    headers: Mapping[str, str] | None = None,
    body: bytes = b"",
) -> tuple[int, bytes]:
    """One request on a connection of its own: status and body."""
    reader, writer = await target.connect()
    try:
        asked = {"Connection": "close", "Accept-Encoding": "identity", **(headers or {})}
        writer.write(request_bytes(method, path, address, asked, body))
        await writer.drain()
        status, _ = await read_head(reader)
        async with asyncio.timeout(PATIENCE_S):
            return status, await reader.read()
    finally:
        writer.close()


@dataclass
class Watcher:
    """A client of the stream that counts its frames."""

    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    frames: int = field(default=0)
    on_frame: Callable[[], None] = field(default=lambda: None)

    async def follow(self) -> None:
        """Read frames until the server closes the socket. Refused with the close code."""
        while True:
            head = await self.reader.readexactly(2)
            opcode, length = head[0] & 15, head[1] & 127
            if length > 125:
                length = int.from_bytes(await self.reader.readexactly(2 if length == 126 else 8))
            payload = await self.reader.readexactly(length)
            if opcode == 8:
                code = struct.unpack("!H", payload[:2])[0] if len(payload) >= 2 else 1005
                raise Refused(str(code))
            if opcode == 9:
                self.writer.write(masked(payload, 10))
            elif opcode == 2 and payload[3] == WIRE_FRAME:
                self.frames += 1
                self.on_frame()

    def send(self, request: wire.Request) -> None:
        """Send a message."""
        self.writer.write(masked(wire.encode_request(request)))


async def open_socket(
    target: Target, address: str, hello: str = "load-test", share: str | None = None
) -> Watcher:
    """A WebSocket after HELLO; its address may name a shared forest. Refused with the HTTP status."""
    reader, writer = await target.connect(1 << 21)
    headers = {
        "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "Z2FsZXdvb2QtYmVuY2gtMQ==",
    }  # fmt: skip
    writer.write(
        request_bytes("GET", f"/ws/forest?share={share}" if share else "/ws/forest", address, headers)
    )
    status, _ = await read_head(reader)
    if status != 101:
        writer.close()
        raise Refused(str(status))
    watcher = Watcher(reader, writer)
    watcher.send(wire.Hello(hello))
    return watcher
