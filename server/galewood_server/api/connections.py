"""Limits of sockets and event streams: connections per address and in total."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager

from fastapi import WebSocket

from galewood_server.access import client_key, count_open, limited_by_descriptors
from galewood_server.context import Service
from galewood_server.http import Problem

SOCKET_SHARE, EVENT_SHARE = 0.5, 0.25
"""Of the file descriptors; the rest is for requests."""


@asynccontextmanager
async def limited_connection(websocket: WebSocket, service: Service) -> AsyncGenerator[bool]:
    """Count an open socket while the block runs. Yields False if it was rejected with an HTTP problem."""
    address = client_key(websocket.scope)
    problem = _limit_exceeded(websocket, service, address)
    if problem:
        await websocket.send_denial_response(problem.response())
        yield False
        return
    with count_open(service.socket_addresses, address):
        yield True


def streams_exceeded(service: Service, address: str) -> Problem | None:
    """The problem with which another event stream of an address is refused; None if it may open."""
    settings, here = service.settings, service.event_addresses.get(address, 0)
    full = service.event_streams >= limited_by_descriptors(settings.event_streams, EVENT_SHARE)
    if not full and here < settings.event_streams_per_address:
        return None
    return Problem(
        status=503 if full else 429,
        code="too-many-event-streams",
        title="Too many open event streams",
        detail=f"{here} streams are open from this address.",
        hint="Close some of them or try again later.",
    )


def _limit_exceeded(websocket: WebSocket, service: Service, address: str) -> Problem | None:
    settings = service.settings
    open_sockets = service.socket_addresses.get(address, 0)
    full = service.sockets >= limited_by_descriptors(settings.socket_connections, SOCKET_SHARE)
    if full or open_sockets >= settings.socket_connections_per_address:
        return Problem(
            status=503 if full else 429,
            code="too-many-sockets",
            title="Too many open sockets",
            detail=f"{open_sockets} sockets are open from this address.",
            hint="Close some of them or try again later.",
        )
    return None
