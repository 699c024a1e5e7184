"""The messages of clients (requests) and of the server (replies), and which of them is which."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from galewood.constants import (
    WIRE_CLOCK,
    WIRE_ERROR,
    WIRE_FOREST,
    WIRE_FRAME,
    WIRE_GUST,
    WIRE_HELLO,
    WIRE_PAUSE,
    WIRE_PING,
    WIRE_PONG,
    WIRE_PRESENCE,
    WIRE_PULL,
    WIRE_PULLS,
    WIRE_RELEASE,
    WIRE_RESYNC,
    WIRE_SHARED,
    WIRE_TABLE,
    WIRE_WELCOME,
    WIRE_WIND,
    WIRE_WIND_STATE,
)

from galewood_server.stream.wire.envelope import (
    Header,
    WireError,
    boolean,
    check_fields,
    decode_message,
    encode_message,
    number,
    text,
    text_map,
    whole_number,
)
from galewood_server.stream.wire.forest import (
    Forest,
    Shared,
    decode_forest,
    decode_shared,
    encode_forest,
    encode_shared,
)
from galewood_server.stream.wire.frame import Frame, decode_frame, encode_frame
from galewood_server.stream.wire.pull import (
    Gust,
    Pull,
    Pulls,
    Release,
    decode_gust,
    decode_pull,
    decode_pulls,
    decode_release,
    encode_gust,
    encode_pull,
    encode_pulls,
    encode_release,
)

# ---- client to server ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Hello:
    """First message of a client, with its name."""

    client: str


@dataclass(frozen=True)
class WindChange:
    """Changes the wind to a wind document (spec/formats/wind.md)."""

    wind: Mapping[str, Any]


@dataclass(frozen=True)
class Ping:
    """Requests a Pong with the same number."""

    t: float


@dataclass(frozen=True)
class Pause:
    """Pauses or resumes the forest's clock."""

    paused: bool


@dataclass(frozen=True)
class Resync:
    """Requests a key frame after the client lost synchronisation."""


Request = Hello | Forest | WindChange | Ping | Pause | Resync | Pull | Release | Gust


_OF_HANDS: Mapping[int, Callable[[Header], Pull | Release | Gust]] = {
    WIRE_PULL: decode_pull,
    WIRE_RELEASE: decode_release,
    WIRE_GUST: decode_gust,
}


def encode_request(request: Request) -> bytes:
    """Encode a client message."""
    match request:
        case Hello():
            return encode_message(WIRE_HELLO, {"client": request.client})
        case WindChange():
            return encode_message(WIRE_WIND, {"wind": dict(request.wind)})
        case Ping():
            return encode_message(WIRE_PING, {"t": request.t})
        case Pause():
            return encode_message(WIRE_PAUSE, {"paused": request.paused})
        case Resync():
            return encode_message(WIRE_RESYNC, {})
        case Pull():
            return encode_pull(request)
        case Release():
            return encode_release(request)
        case Gust():
            return encode_gust(request)
        case Forest():
            return encode_forest(request)


def decode_request(data: bytes) -> Request:
    """Decode a client message. WireError."""
    kind, header, payload = decode_message(data)
    if kind == WIRE_FOREST:
        return decode_forest(header, payload)
    if payload:
        raise WireError("only a FOREST message has a payload")
    if kind == WIRE_HELLO:
        check_fields(header, "client")
        return Hello(text(header, "client")[:200])
    if kind == WIRE_WIND:
        check_fields(header, "wind")
        return WindChange(text_map(header["wind"], "wind"))
    if kind == WIRE_PING:
        check_fields(header, "t")
        return Ping(number(header, "t"))
    if kind == WIRE_PAUSE:
        check_fields(header, "paused")
        return Pause(boolean(header, "paused"))
    if kind == WIRE_RESYNC:
        check_fields(header)
        return Resync()
    if kind in _OF_HANDS:
        return _OF_HANDS[kind](header)
    raise WireError(f"kind {kind} is not a message that clients send", "unknown-kind")


# ---- server to client ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Welcome:
    """Reply to Hello: server name, wire version and frames per second."""

    server: str
    version: int
    tick_hz: float


@dataclass(frozen=True)
class TableChunk:
    """A chunk of a table file, starting at byte `offset` of `total`."""

    table: str
    offset: int
    total: int
    data: bytes


@dataclass(frozen=True)
class Failure:
    """The reason why the server is about to close the connection."""

    code: str
    title: str
    hint: str


@dataclass(frozen=True)
class Pong:
    """Reply to Ping with the server's clock, to which `made_s` of frames and clocks refers."""

    t: float
    server_s: float


@dataclass(frozen=True)
class WindState:
    """The forest's wind state (spec/formats/wind.md), sent after a change and on joining."""

    state: Mapping[str, Any]


@dataclass(frozen=True)
class Clock:
    """The forest's time at `made_s` of the server's clock, and whether it is paused."""

    time_s: float
    made_s: float
    paused: bool


@dataclass(frozen=True)
class Presence:
    """Number of clients of a shared forest, sent to all of them when it changes."""

    clients: int


Reply = Welcome | TableChunk | Frame | Failure | Pong | WindState | Clock | Shared | Presence | Pulls


def encode_reply(reply: Reply) -> bytes:
    """Encode a server message."""
    match reply:
        case Welcome():
            header = {"server": reply.server, "version": reply.version, "tick_hz": reply.tick_hz}
            return encode_message(WIRE_WELCOME, header)
        case TableChunk():
            header = {"table": reply.table, "offset": reply.offset, "total": reply.total}
            return encode_message(WIRE_TABLE, header, reply.data)
        case Failure():
            return encode_message(WIRE_ERROR, {"code": reply.code, "title": reply.title, "hint": reply.hint})
        case Pong():
            return encode_message(WIRE_PONG, {"t": reply.t, "server_s": reply.server_s})
        case WindState():
            return encode_message(WIRE_WIND_STATE, {"state": dict(reply.state)})
        case Clock():
            header = {"time_s": reply.time_s, "made_s": reply.made_s, "paused": reply.paused}
            return encode_message(WIRE_CLOCK, header)
        case Presence():
            return encode_message(WIRE_PRESENCE, {"clients": reply.clients})
        case Shared():
            return encode_shared(reply)
        case Pulls():
            return encode_pulls(reply)
        case Frame():
            return encode_frame(reply)


def decode_reply(data: bytes) -> Reply:
    """Decode a server message. WireError."""
    kind, header, payload = decode_message(data)
    if kind == WIRE_FRAME:
        return decode_frame(header, payload)
    if kind == WIRE_SHARED:
        return decode_shared(header, payload)
    if kind == WIRE_TABLE:
        check_fields(header, "table", "offset", "total")
        return _chunk(header, payload)
    if payload:
        raise WireError("only FRAME, TABLE and SHARED messages have a payload")
    return _decode_short(kind, header)


def _decode_short(kind: int, header: Header) -> Reply:
    if kind == WIRE_WELCOME:
        check_fields(header, "server", "version", "tick_hz")
        return Welcome(text(header, "server"), whole_number(header, "version"), number(header, "tick_hz"))
    if kind == WIRE_ERROR:
        check_fields(header, "code", "title", "hint")
        return Failure(text(header, "code"), text(header, "title"), text(header, "hint"))
    if kind == WIRE_PONG:
        check_fields(header, "t", "server_s")
        return Pong(number(header, "t"), number(header, "server_s"))
    if kind == WIRE_WIND_STATE:
        check_fields(header, "state")
        return WindState(text_map(header["state"], "state"))
    if kind == WIRE_CLOCK:
        check_fields(header, "time_s", "made_s", "paused")
        return Clock(number(header, "time_s"), number(header, "made_s"), boolean(header, "paused"))
    if kind == WIRE_PRESENCE:
        check_fields(header, "clients")
        return Presence(whole_number(header, "clients"))
    if kind == WIRE_PULLS:
        return decode_pulls(header)
    raise WireError(f"kind {kind} is not a message that servers send", "unknown-kind")


def _chunk(header: Header, payload: bytes) -> TableChunk:
    chunk = TableChunk(
        text(header, "table"), whole_number(header, "offset"), whole_number(header, "total"), payload
    )
    if chunk.offset + len(payload) > chunk.total:
        raise WireError("a chunk reaches past the end of its table")
    return chunk
