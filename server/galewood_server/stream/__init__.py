"""Forest streaming: wire protocol, simulation on the server, and delivery to clients."""

from galewood_server.stream import wire
from galewood_server.stream.forests import Forests, Subscription
from galewood_server.stream.frame_meter import SocketLimits
from galewood_server.stream.session_error import (
    INVALID_DATA,
    POLICY_VIOLATION,
    TRY_AGAIN_LATER,
    UNSUPPORTED_DATA,
    SessionError,
)
from galewood_server.stream.socket_protocol import metered_protocol, protocol_of
from galewood_server.stream.warming import warm_up
from galewood_server.stream.wire import pack_msgpack

__all__ = [
    "INVALID_DATA",
    "POLICY_VIOLATION",
    "TRY_AGAIN_LATER",
    "UNSUPPORTED_DATA",
    "Forests",
    "SessionError",
    "SocketLimits",
    "Subscription",
    "metered_protocol",
    "pack_msgpack",
    "protocol_of",
    "warm_up",
    "wire",
]
