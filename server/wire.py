"""THE wire format of /ws/forest, version 1: specified in docs/formats/wire.md, twin of web/src/wire.ts.

Requests go from client to server, replies back; envelope.py says what they have in common. `encode_*` stands
beside `decode_*`; what decodes has been checked, so that nobody downstream checks again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from server.envelope import (
    Header,
    WireError,
    decode_message,
    encode_message,
    entries,
    number,
    only,
    text,
    text_map,
    whole,
)

HELLO, FOREST, WIND, PING = 1, 2, 3, 4
WELCOME, TABLE, FRAME, ERROR, PONG, WIND_STATE = 65, 66, 67, 68, 69, 70

TICK_HZ = 30
"""Frames a second of a stream, and ticks of a forest's clock."""

Poses = npt.NDArray[np.int32]


# ---- client to server ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Hello:
    """First message of a client: a name for itself."""

    client: str


@dataclass(frozen=True)
class Group:
    """`count` trees that share one table (SHA-256 in hex)."""

    table: str
    count: int


Method = Literal["tangent", "paper"]


@dataclass(frozen=True)
class Forest:
    """What the client wants: tables to look up itself, or a stream of poses of these trees."""

    mode: Literal["stream", "table"]
    groups: tuple[Group, ...]
    wind: Mapping[str, Any]
    time_s: float
    pose_easing: float | None
    trees: npt.NDArray[np.float32]  # (Σ count, 4): x m, z m, yaw rad, scale; (0, 4) in mode "table"
    method: Method = "tangent"


@dataclass(frozen=True)
class WindChange:
    """A new wind document (docs/formats/wind.md)."""

    wind: Mapping[str, Any]


@dataclass(frozen=True)
class Ping:
    """Asks for a Pong with the same number."""

    t: float


Request = Hello | Forest | WindChange | Ping


def encode_request(request: Request) -> bytes:
    """The bytes of a client's message."""
    match request:
        case Hello():
            return encode_message(HELLO, {"client": request.client})
        case WindChange():
            return encode_message(WIND, {"wind": dict(request.wind)})
        case Ping():
            return encode_message(PING, {"t": request.t})
        case Forest():
            return encode_forest(request)


def decode_request(data: bytes) -> Request:
    """The message of a client. WireError."""
    kind, header, payload = decode_message(data)
    if kind == FOREST:
        return decode_forest(header, payload)
    if payload:
        raise WireError("only a FOREST message has a payload")
    if kind == HELLO:
        only(header, "client")
        return Hello(text(header, "client")[:200])
    if kind == WIND:
        only(header, "wind")
        return WindChange(text_map(header["wind"], "wind"))
    if kind == PING:
        only(header, "t")
        return Ping(number(header, "t"))
    raise WireError(f"kind {kind} is not a message that clients send", "unknown-kind")


def encode_forest(forest: Forest) -> bytes:
    """FOREST: groups in the header, a row of four float32 a tree in the payload."""
    header = {
        "mode": forest.mode,
        "groups": [{"table": group.table, "count": group.count} for group in forest.groups],
        "options": _options(forest),
        "wind": dict(forest.wind),
        "time_s": forest.time_s,
    }
    return encode_message(FOREST, header, np.ascontiguousarray(forest.trees, "<f4").tobytes())


def decode_forest(header: Header, payload: bytes) -> Forest:
    """The twin of encode_forest. WireError."""
    only(header, "mode", "groups", "options", "wind", "time_s")
    mode = text(header, "mode")
    if mode not in ("stream", "table"):
        raise WireError("mode must be 'stream' or 'table'")
    options = text_map(header["options"], "options")
    only(options, *options.keys() & {"pose_easing", "method"})
    method = text(options, "method") if "method" in options else "tangent"
    if method not in ("tangent", "paper"):
        raise WireError("method must be 'tangent' or 'paper'")
    groups = tuple(_group(entry) for entry in entries(header, "groups"))
    return Forest(
        mode=mode,
        groups=groups,
        wind=text_map(header["wind"], "wind"),
        time_s=number(header, "time_s", -1e9, 1e9),
        pose_easing=number(options, "pose_easing", 0.0, 1.0) if "pose_easing" in options else None,
        trees=_trees(payload, sum(group.count for group in groups) if mode == "stream" else 0),
        method=method,
    )


def _options(forest: Forest) -> dict[str, Any]:
    """What differs from the defaults."""
    easing = {} if forest.pose_easing is None else {"pose_easing": forest.pose_easing}
    return easing if forest.method == "tangent" else {**easing, "method": forest.method}


def _group(entry: Any) -> Group:
    group = text_map(entry, "a group")
    only(group, "table", "count")
    table = text(group, "table")
    if len(table) != 64 or set(table) - set("0123456789abcdef"):
        raise WireError("table must be a SHA-256 in hex")
    return Group(table, whole(group, "count"))


def _trees(payload: bytes, count: int) -> npt.NDArray[np.float32]:
    if len(payload) != count * 16:
        raise WireError(f"the payload has {len(payload)} bytes; {count} trees need {count * 16}")
    trees = np.frombuffer(payload, "<f4").reshape(count, 4)
    if not np.isfinite(trees).all() or (np.abs(trees) > 1e6).any():
        raise WireError("a tree's place, yaw or scale is not a sensible number")
    if count and not ((trees[:, 3] >= 0.01) & (trees[:, 3] <= 100)).all():
        raise WireError("a tree's scale must lie in 0.01..100")
    return trees


# ---- server to client ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Welcome:
    """Answer to Hello: who serves, which wire version, how many frames a second."""

    server: str
    version: int
    tick_hz: float


@dataclass(frozen=True)
class TableChunk:
    """A piece of a table file, from byte `offset` of `total`."""

    table: str
    offset: int
    total: int
    data: bytes


@dataclass(frozen=True)
class Frame:
    """Poses of every tree in units of its table's modes.scale: absolute if `key`, else to be added."""

    seq: int
    time_s: float
    key: bool
    poses: tuple[Poses, ...]  # (count, r) of each group


@dataclass(frozen=True)
class Failure:
    """Why the server is about to close the connection."""

    code: str
    title: str
    hint: str


@dataclass(frozen=True)
class Pong:
    """Answer to Ping."""

    t: float


@dataclass(frozen=True)
class WindState:
    """Answer to WindChange in a stream: the wind and its clock (docs/formats/wind.md)."""

    state: Mapping[str, Any]


Reply = Welcome | TableChunk | Frame | Failure | Pong | WindState


def encode_reply(reply: Reply) -> bytes:
    """The bytes of a server's message."""
    match reply:
        case Welcome():
            header = {"server": reply.server, "version": reply.version, "tick_hz": reply.tick_hz}
            return encode_message(WELCOME, header)
        case TableChunk():
            header = {"table": reply.table, "offset": reply.offset, "total": reply.total}
            return encode_message(TABLE, header, reply.data)
        case Failure():
            return encode_message(ERROR, {"code": reply.code, "title": reply.title, "hint": reply.hint})
        case Pong():
            return encode_message(PONG, {"t": reply.t})
        case WindState():
            return encode_message(WIND_STATE, {"state": dict(reply.state)})
        case Frame():
            return encode_frame(reply)


def decode_reply(data: bytes) -> Reply:
    """The message of a server. WireError."""
    kind, header, payload = decode_message(data)
    if kind == FRAME:
        return decode_frame(header, payload)
    if kind == TABLE:
        only(header, "table", "offset", "total")
        return _chunk(header, payload)
    if payload:
        raise WireError("only FRAME and TABLE messages have a payload")
    if kind == WELCOME:
        only(header, "server", "version", "tick_hz")
        return Welcome(text(header, "server"), whole(header, "version"), number(header, "tick_hz"))
    if kind == ERROR:
        only(header, "code", "title", "hint")
        return Failure(text(header, "code"), text(header, "title"), text(header, "hint"))
    if kind == PONG:
        only(header, "t")
        return Pong(number(header, "t"))
    if kind == WIND_STATE:
        only(header, "state")
        return WindState(text_map(header["state"], "state"))
    raise WireError(f"kind {kind} is not a message that servers send", "unknown-kind")


def _chunk(header: Header, payload: bytes) -> TableChunk:
    chunk = TableChunk(text(header, "table"), whole(header, "offset"), whole(header, "total"), payload)
    if chunk.offset + len(payload) > chunk.total:
        raise WireError("a chunk reaches past the end of its table")
    return chunk


def encode_frame(frame: Frame) -> bytes:
    """FRAME: int32 rows if key, else int16 rows, group after group. ValueError if a delta does not fit."""
    header = {
        "seq": frame.seq,
        "time_s": frame.time_s,
        "key": frame.key,
        "groups": [{"count": len(rows), "modes": rows.shape[1]} for rows in frame.poses],
    }
    if not frame.key and not deltas_fit(frame.poses):
        raise ValueError("a delta does not fit 16 bits: send a key frame")
    kind = "<i4" if frame.key else "<i2"
    return encode_message(FRAME, header, b"".join(rows.astype(kind).tobytes() for rows in frame.poses))


def decode_frame(header: Header, payload: bytes) -> Frame:
    """The twin of encode_frame. WireError."""
    only(header, "seq", "time_s", "key", "groups")
    key = header["key"]
    if not isinstance(key, bool):
        raise WireError("key must be true or false")
    shapes = [_shape(entry) for entry in entries(header, "groups")]
    width = 4 if key else 2
    if len(payload) != sum(count * modes for count, modes in shapes) * width:
        raise WireError("the payload does not have the length that the groups say")
    poses: list[Poses] = []
    offset = 0
    for count, modes in shapes:
        rows = np.frombuffer(payload, f"<i{width}", count * modes, offset).astype(np.int32)
        poses.append(rows.reshape(count, modes))
        offset += rows.size * width
    return Frame(whole(header, "seq"), number(header, "time_s"), key, tuple(poses))


def _shape(entry: Any) -> tuple[int, int]:
    group = text_map(entry, "a group")
    only(group, "count", "modes")
    return whole(group, "count"), whole(group, "modes")


def deltas_fit(poses: Sequence[Poses]) -> bool:
    """Whether every number fits 16 bits."""
    return all(not rows.size or (rows.min() >= -32768 and rows.max() <= 32767) for rows in poses)
