"""A service that cannot start says why in a sentence, not in a traceback."""

from __future__ import annotations

import errno
import socket
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from galewood_server.settings import Settings
from galewood_server.storage import StartError, start_failure

FAILED_EVENT = "lifespan.startup.failed"


def with_clear_failures(app: ASGIApp, settings: Settings) -> ASGIApp:
    """The application, whose start fails with a sentence where the cause is known; uvicorn logs it."""

    async def serve(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await _start(app, settings, scope, receive, send)
        else:
            await app(scope, receive, send)

    return serve


async def _start(app: ASGIApp, settings: Settings, scope: Scope, receive: Receive, send: Send) -> None:
    failed: list[Message] = []

    async def keep_failure(message: Message) -> None:
        if message["type"] == FAILED_EVENT:
            failed.append(message)
        else:
            await send(message)

    try:
        await app(scope, receive, keep_failure)
    except Exception as error:
        if not failed:
            raise
        await send({"type": FAILED_EVENT, "message": start_failure(error, settings) or failed[0]["message"]})


def check_address(host: str, port: int) -> None:
    """Raise StartError if the server cannot listen here, before it takes the data folder and starts work."""
    try:
        addresses = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    except socket.gaierror as error:
        raise StartError(f"HOST={host} is not a known name or address ({error.strerror}).") from None
    errors = [_bind_error(family, address) for family, _, _, _, address in addresses]
    if errors and None not in errors:
        raise StartError(_refused(errors[0] or OSError(), host, port))


def _bind_error(family: int, address: Any) -> OSError | None:
    try:
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except OSError as error:
        return error
    return None


def _refused(error: OSError, host: str, port: int) -> str:
    if error.errno == errno.EADDRINUSE:
        return f"Port {port} is used by another program: end it, or set PORT to another number."
    if error.errno == errno.EADDRNOTAVAIL:
        return f"HOST={host} is not an address of this machine: set 127.0.0.1, or 0.0.0.0 for all addresses."
    return f"Port {port} of {host} cannot be opened ({error.strerror}): set PORT to a number above 1023."
