"""Forests played on the server: wire format, stepping, one encoded stream per client."""

from galewood_server.stream import wire
from galewood_server.stream.envelope import WIRE_VERSION, WireError
from galewood_server.stream.forests import Forests, Subscription
from galewood_server.stream.refusal import NOT_BINARY, REFUSED, UNREADABLE, Refusal
from galewood_server.stream.socket_protocol import SocketProtocol, protocol_of
from galewood_server.stream.wire import Failure, Hello, Reply, decode_reply, encode_request
from galewood_server.stream.wire_forest import Forest, Method
from galewood_server.stream.wire_frame import FRAME

__all__ = [
    "FRAME",
    "NOT_BINARY",
    "REFUSED",
    "UNREADABLE",
    "WIRE_VERSION",
    "Failure",
    "Forest",
    "Forests",
    "Hello",
    "Method",
    "Refusal",
    "Reply",
    "SocketProtocol",
    "Subscription",
    "WireError",
    "decode_reply",
    "encode_request",
    "protocol_of",
    "wire",
]
