"""Forest streaming: wire protocol, simulation on the server, and delivery to clients."""

from galewood_server.stream import wire
from galewood_server.stream.envelope import WIRE_VERSION, WireError
from galewood_server.stream.forests import Forests
from galewood_server.stream.socket_protocol import SocketProtocol
from galewood_server.stream.wire import Failure, Hello, Reply, decode_reply, encode_request
from galewood_server.stream.wire_forest import Forest, Method
from galewood_server.stream.wire_frame import FRAME

__all__ = [
    "FRAME",
    "WIRE_VERSION",
    "Failure",
    "Forest",
    "Forests",
    "Hello",
    "Method",
    "Reply",
    "SocketProtocol",
    "WireError",
    "decode_reply",
    "encode_request",
    "wire",
]
