"""Why a server ends a session."""

from __future__ import annotations

from galewood_server.stream.wire import Failure

UNREADABLE, REFUSED, NOT_BINARY, BUSY = 1007, 1008, 1003, 1013
"""Close codes of RFC 6455 and its registry."""


class Refusal(Exception):
    """The end of a session by the server: told to the client, then the socket is closed."""

    def __init__(self, code: str, title: str, hint: str = "", close: int = REFUSED) -> None:
        super().__init__(title)
        self.failure = Failure(code, title, hint)
        self.close = close
