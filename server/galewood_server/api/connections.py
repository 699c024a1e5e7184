"""Connection limits of the forest socket: allowed origins, sockets per address and in total."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager

from fastapi import WebSocket

from galewood_server.access import origin_allowed
from galewood_server.context import Service
from galewood_server.http import Problem


@asynccontextmanager
async def limited_connection(websocket: WebSocket, service: Service) -> AsyncGenerator[bool]:
    """Count an open socket while the block runs. Yields False if it was rejected with an HTTP problem."""
    address = websocket.client.host if websocket.client else ""
    problem = _limit_exceeded(websocket, service, address)
    if problem:
        await websocket.send_denial_response(problem.response())
        yield False
        return
    counts = service.socket_addresses
    counts[address] = counts.get(address, 0) + 1
    try:
        yield True
    finally:
        counts[address] -= 1
        if not counts[address]:
            del counts[address]


def _limit_exceeded(websocket: WebSocket, service: Service, address: str) -> Problem | None:
    settings = service.settings
    if not origin_allowed(
        websocket.headers.get("origin"), websocket.headers.get("host"), settings.allowed_origins
    ):
        return Problem(
            status=403,
            code="foreign-origin",
            title="Connections from other websites are not allowed",
            detail="The Origin header does not match this server.",
            hint="Add the origin to GALEWOOD_ALLOWED_ORIGINS.",
        )
    open_sockets = service.socket_addresses.get(address, 0)
    if (
        service.sockets >= settings.socket_connections
        or open_sockets >= settings.socket_connections_per_address
    ):
        return Problem(
            status=503 if service.sockets >= settings.socket_connections else 429,
            code="too-many-sockets",
            title="Too many open sockets",
            detail=f"{open_sockets} sockets are open from this address.",
            hint="Close some of them or try again later.",
        )
    return None
