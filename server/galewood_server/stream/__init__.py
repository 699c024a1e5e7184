"""Forest streaming: wire protocol, simulation on the server, and delivery to clients."""

from galewood_server.stream import wire
from galewood_server.stream.envelope import WireError, pack_msgpack, unpack_msgpack
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
from galewood_server.stream.wire import Failure, Hello, Reply, decode_reply, encode_request
from galewood_server.stream.wire_forest import Forest

__all__ = [
    "INVALID_DATA",
    "POLICY_VIOLATION",
    "TRY_AGAIN_LATER",
    "UNSUPPORTED_DATA",
    "Failure",
    "Forest",
    "Forests",
    "Hello",
    "Reply",
    "SessionError",
    "SocketLimits",
    "Subscription",
    "WireError",
    "decode_reply",
    "encode_request",
    "metered_protocol",
    "pack_msgpack",
    "protocol_of",
    "unpack_msgpack",
    "warm_up",
    "wire",
]
