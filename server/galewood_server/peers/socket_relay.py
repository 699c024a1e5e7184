"""Passes a client's socket on to the server that holds its shared forest."""

from __future__ import annotations

import asyncio
import logging
import socket
from urllib.parse import urlencode

from fastapi import WebSocket
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus, WebSocketException

from galewood_server.stream import TRY_AGAIN_LATER, SessionError, protocol_of

log = logging.getLogger("galewood.stream")
RELAYED_HEADER = "Galewood-Relayed"
"""Header of a relayed request: its server does not pass it on again."""
ANSWER_S = 1.5
"""A server that does not respond for so long is considered dead."""
QUEUED_MESSAGES = 4
KERNEL_BYTES = 256 * 1024  # what waits here, the other server takes for received
SERVICE_RESTART, ABNORMAL_CLOSURE = 1012, 1006


class PeerLostError(Exception):
    """The server that holds a forest was not reached; another attempt of the client may succeed."""


async def open_peer(server_url: str, share: str, address: str) -> ClientConnection:
    """A socket to another server for a client of `address`. PeerLostError, SessionError if it is refused."""
    uri = f"ws{server_url.removeprefix('http')}/ws/forest?{urlencode({'share': share})}"
    try:
        peer = await connect(
            uri,
            additional_headers={RELAYED_HEADER: "1", "X-Forwarded-For": address},
            compression=None,
            max_size=None,
            max_queue=QUEUED_MESSAGES,
            open_timeout=ANSWER_S,
            close_timeout=ANSWER_S,
            ping_interval=None,
            proxy=None,
            user_agent_header=None,
        )
    except InvalidStatus as error:
        status = error.response.status_code
        raise SessionError(
            "server-full",
            f"The server of this shared forest refuses connections (HTTP {status})",
            "Try again later.",
            TRY_AGAIN_LATER,
        ) from None
    except (OSError, TimeoutError, WebSocketException) as error:
        raise PeerLostError(str(error)) from None
    kernel: socket.socket | None = peer.transport.get_extra_info("socket")
    if kernel is not None:
        kernel.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, KERNEL_BYTES)
    return peer


async def relay(websocket: WebSocket, peer: ClientConnection, stall_s: float) -> None:
    """Accept a socket and pass all messages on in both directions until either side closes.

    A slow client slows the other server down, which then sends fewer frames; one that does not read for
    `stall_s` is disconnected.
    """
    await websocket.accept()
    down = asyncio.create_task(_to_client(peer, websocket, stall_s))
    up = asyncio.create_task(_to_server(websocket, peer))
    try:
        await asyncio.wait({down, up}, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in (down, up):
            task.cancel()
        await asyncio.gather(down, up, return_exceptions=True)
        await peer.close()


async def _to_client(peer: ClientConnection, websocket: WebSocket, stall_s: float) -> None:
    protocol = protocol_of(websocket.scope)
    try:
        while True:
            data = await peer.recv(decode=False)
            async with asyncio.timeout(stall_s):
                await websocket.send_bytes(data)
    except ConnectionClosed:
        code = peer.close_code or ABNORMAL_CLOSURE
        await websocket.close(SERVICE_RESTART if code == ABNORMAL_CLOSURE else code, peer.close_reason or "")
    except TimeoutError:
        log.info("disconnected a client that does not read")
        protocol.abort()
    except RuntimeError:  # the client has closed its socket
        if not protocol.closing:
            raise


async def _to_server(websocket: WebSocket, peer: ClientConnection) -> None:
    while True:
        message = await websocket.receive()
        if message["type"] == "websocket.disconnect":
            return
        data: bytes | str | None = message.get("bytes")
        try:
            await peer.send(message["text"] if data is None else data)
        except ConnectionClosed:
            await asyncio.Event().wait()  # until the client has been told why
