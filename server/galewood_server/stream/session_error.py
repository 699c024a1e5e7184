"""Errors that end a WebSocket session."""

from __future__ import annotations

from galewood_server.stream.wire import Failure

INVALID_DATA, POLICY_VIOLATION, UNSUPPORTED_DATA, TRY_AGAIN_LATER = 1007, 1008, 1003, 1013
"""Close codes (RFC 6455, section 7.4, and the IANA registry)."""


class SessionError(Exception):
    """Ends a session: the client receives the error, then the socket is closed with code `close`."""

    def __init__(self, code: str, title: str, hint: str = "", close: int = POLICY_VIOLATION) -> None:
        super().__init__(title)
        self.failure = Failure(code, title, hint)
        self.close = close
