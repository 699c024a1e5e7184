"""The wire protocol of /ws/forest, version 1: specified in spec/formats/wire.md.

Used as a namespace: `wire.Frame`, `wire.encode_request`. Decoders validate all fields, so that later code
need not check them.
"""

from galewood_server.stream.wire.envelope import WireError, decode_message, pack_msgpack
from galewood_server.stream.wire.forest import Forest, Group, Shared, Trees, is_share
from galewood_server.stream.wire.frame import Frame, Poses, Rows, encode_frame
from galewood_server.stream.wire.messages import (
    Clock,
    Failure,
    Hello,
    Pause,
    Ping,
    Pong,
    Presence,
    Reply,
    Request,
    Resync,
    TableChunk,
    Welcome,
    WindChange,
    WindState,
    decode_reply,
    decode_request,
    encode_reply,
    encode_request,
)
from galewood_server.stream.wire.pull import Gust, Pull, Pulling, Pulls, Release, Vector

__all__ = [
    "Clock",
    "Failure",
    "Forest",
    "Frame",
    "Group",
    "Gust",
    "Hello",
    "Pause",
    "Ping",
    "Pong",
    "Poses",
    "Presence",
    "Pull",
    "Pulling",
    "Pulls",
    "Release",
    "Reply",
    "Request",
    "Resync",
    "Rows",
    "Shared",
    "TableChunk",
    "Trees",
    "Vector",
    "Welcome",
    "WindChange",
    "WindState",
    "WireError",
    "decode_message",
    "decode_reply",
    "decode_request",
    "encode_frame",
    "encode_reply",
    "encode_request",
    "is_share",
    "pack_msgpack",
]
