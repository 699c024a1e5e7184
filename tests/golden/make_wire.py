"""Write the golden wire messages for the Python and TypeScript tests: ``python -m tests.golden.make_wire``.

One .bin file per message, messages.json with their content, refused.json with invalid bytes.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import msgpack
import numpy as np
from galewood.constants import (
    WIRE_CLOCK,
    WIRE_FOREST,
    WIRE_FRAME,
    WIRE_PAUSE,
    WIRE_PING,
    WIRE_PONG,
    WIRE_RESYNC,
    WIRE_TABLE,
    WIRE_VERSION,
)
from galewood_server.stream import wire
from galewood_server.stream.wire.envelope import MAGIC, encode_message

from tests.golden import GOLDEN_FOLDER

WIRE_FOLDER = GOLDEN_FOLDER / "wire"
TABLE = "0123456789abcdef" * 4
OTHER = "f" * 64
BREEZE = {
    "version": 1,
    "model": "cosine",
    "mean_speed_m_s": 8.5,
    "direction_deg": 30.25,
    "gustiness": 0.5,
    "convection_speed_m_s": 7.5,
    "seed": 4294967295,
}
# All msgpack libraries encode non-integers as float64, so that the bytes can be compared.
TREES = [1.5, -2.25, 0.5, 1.25, -1000.5, 0.125, 3.140625, 0.75, 0.0, 0.0, -6.25, 100.0]

PULL = {"hand": 281474976710655, "x": 1.5, "z": -2.25, "vertex": 4711, "target": [0.25, -0.5, 0.125]}

REQUESTS: dict[str, dict[str, Any]] = {
    "hello": {"type": "hello", "client": "größer 🌳"},
    "forest_stream": {
        "type": "forest",
        "mode": "stream",
        "groups": [{"table": TABLE, "count": 2}, {"table": OTHER, "count": 1}],
        "wind": BREEZE,
        "time_s": 12.5,
        "pose_easing": 0.0625,
        "trees": TREES,
    },
    "forest_table": {
        "type": "forest",
        "mode": "table",
        "groups": [{"table": TABLE, "count": 5000}],
        "wind": BREEZE,
        "time_s": 0.5,
        "pose_easing": None,
        "trees": [],
    },
    "wind": {"type": "wind", "wind": BREEZE},
    "forest_shared": {
        "type": "forest",
        "mode": "table",
        "groups": [{"table": TABLE, "count": 3}, {"table": OTHER, "count": 0}],
        "wind": BREEZE,
        "time_s": -0.5,
        "pose_easing": None,
        "trees": TREES,
        "method": "paper",
        "share": "Heath_7-b",
        "replant": True,
        "about": {"trees": 3, "wood": "größer", "dense": True, "density": 0.25},
        "have": {TABLE: 65536},
    },
    "ping": {"type": "ping", "t": 1234.5},
    "pause": {"type": "pause", "paused": True},
    "resync": {"type": "resync"},
    "pull": {"type": "pull", **PULL},
    "release": {"type": "release", "hand": 281474976710655},
    "gust": {"type": "gust", "x": -12.5, "z": 40.25},
}
REPLIES: dict[str, dict[str, Any]] = {
    "welcome": {"type": "welcome", "server": "galewood 0.1.0", "version": WIRE_VERSION, "tick_hz": 29.5},
    "table": {"type": "table", "table": TABLE, "offset": 65536, "total": 65543, "data": list(range(7))},
    "frame_key": {
        "type": "frame",
        "tick": 0,
        "base": None,
        "time_s": 0.5,
        "made_s": 1000.5,
        "groups": [
            {"count": 2, "modes": 3, "quantum": 1, "values": [0, -1, 70000, -2147483648, 2147483647, 5]},
            {"count": 1, "modes": 2, "quantum": 28, "values": [9, -9]},
        ],
    },
    "frame_delta": {
        "type": "frame",
        "tick": 4294967296,
        "base": 4294967295,
        "time_s": 0.53125,
        "made_s": 1000.53125,
        "groups": [
            {"count": 1, "modes": 3, "quantum": 1, "values": [-32768, 32767, 0]},
            {"count": 0, "modes": 4, "quantum": 7, "values": []},
            {"count": 2, "modes": 1, "quantum": 28, "values": [-128, 127]},
            {"count": 2, "modes": 3, "quantum": 3, "values": [128, -1, 2, -3, 4, -5]},
        ],
    },
    "error": {"type": "error", "code": "no-such-table", "title": "Unknown table", "hint": "List the trees."},
    "pong": {"type": "pong", "t": -0.5, "server_s": 1000.25},
    "presence": {"type": "presence", "clients": 12},
    "clock": {"type": "clock", "time_s": 60.5, "made_s": 1000.75, "paused": True},
    "shared": {
        "type": "shared",
        "share": "Heath_7-b",
        "groups": [{"table": TABLE, "count": 3}],
        "pose_easing": 0.0625,
        "method": "modal",
        "about": {"forestSeed": 7},
        "trees": TREES,
    },
    "shared_bare": {
        "type": "shared",
        "share": "x",
        "groups": [],
        "pose_easing": None,
        "method": "paper",
        "about": {},
        "trees": [],
    },
    "wind_state": {
        "type": "windState",
        "state": {"before": BREEZE, "wind": {**BREEZE, "gustiness": 0.75}, "since_s": 12.5, "travel": 3.25},
    },
    "pulls": {"type": "pulls", "time_s": 12.5, "pulls": [{**PULL, "force": [80.5, -0.25, 3.5]}]},
    "pulls_none": {"type": "pulls", "time_s": 13.5, "pulls": []},
}


REQUEST_KINDS: dict[str, Any] = {
    "hello": wire.Hello,
    "forest": wire.Forest,
    "wind": wire.WindChange,
    "ping": wire.Ping,
    "pause": wire.Pause,
    "resync": wire.Resync,
    "pull": wire.Pull,
    "release": wire.Release,
    "gust": wire.Gust,
}
REPLY_KINDS: dict[str, Any] = {
    "welcome": wire.Welcome,
    "table": wire.TableChunk,
    "error": wire.Failure,
    "pong": wire.Pong,
    "windState": wire.WindState,
    "clock": wire.Clock,
    "presence": wire.Presence,
    "shared": wire.Shared,
}


def with_trees(fields: dict[str, Any]) -> dict[str, Any]:
    """Convert groups and trees from JSON to their Python types."""
    if "trees" not in fields:
        return fields
    groups = tuple(wire.Group(**group) for group in fields["groups"])
    return {**fields, "groups": groups, "trees": np.array(fields["trees"], np.float32).reshape(-1, 4)}


def with_target(fields: dict[str, Any]) -> dict[str, Any]:
    """Convert the target of a pull from JSON to its Python type."""
    return {**fields, "target": tuple(fields["target"])} if "target" in fields else fields


def pulls_of(fields: dict[str, Any]) -> wire.Pulls:
    """Pulls from their JSON form."""
    pulls = [
        wire.Pulling(
            wire.Pull(**with_target({name: value for name, value in one.items() if name != "force"})),
            tuple(one["force"]),
        )
        for one in fields["pulls"]
    ]
    return wire.Pulls(fields["time_s"], tuple(pulls))


def request_of(message: dict[str, Any]) -> wire.Request:
    """A request from its JSON form (web/player/src/core/wire)."""
    fields = {name: value for name, value in message.items() if name != "type"}
    return REQUEST_KINDS[message["type"]](**with_target(with_trees(fields)))


def reply_of(message: dict[str, Any]) -> wire.Reply:
    """A reply from its JSON form."""
    fields = {name: value for name, value in message.items() if name != "type"}
    if message["type"] == "frame":
        return frame_of(fields)
    if message["type"] == "pulls":
        return pulls_of(fields)
    if message["type"] == "table":
        fields["data"] = bytes(fields["data"])
    return REPLY_KINDS[message["type"]](**with_trees(fields))


def frame_of(fields: dict[str, Any]) -> wire.Frame:
    """A frame from its JSON form."""
    rows = tuple(
        wire.Rows(
            group["quantum"], np.array(group["values"], np.int32).reshape(group["count"], group["modes"])
        )
        for group in fields["groups"]
    )
    values: dict[str, Any] = {**fields, "groups": rows}
    return wire.Frame(**values)


def refused() -> dict[str, tuple[str, bytes]]:
    """Invalid messages by name: the receiving side, and the bytes."""
    ping = encode_message(WIRE_PING, {"t": 0.5})
    row = {"count": 1, "modes": 1, "quantum": 1, "wide": 1}
    frame = {"tick": 0, "base": None, "time_s": 0.5, "made_s": 0.5, "groups": [row]}
    forest = {"mode": "stream", "groups": [], "options": {}, "wind": {}, "time_s": 0.5}
    group = [{"table": TABLE, "count": 1}]
    tree = struct.pack("<4f", 0, 0, 0, 1)
    odd = encode_message(WIRE_PING, {"t": 0.5})

    def forest_with(payload: bytes = b"", **changes: Any) -> bytes:
        return encode_message(WIRE_FOREST, {**forest, **changes}, payload)

    def raw(packed: bytes | None, kind: int = WIRE_PING) -> bytes:
        assert packed is not None
        prefix = MAGIC + bytes([WIRE_VERSION, kind]) + struct.pack("<I", len(packed))
        return prefix + packed + bytes(-len(packed) % 8)

    return {
        "empty": ("server", b""),
        "text": ("server", b"GET / HTTP/1.1\r\n"),
        "half a prefix": ("server", ping[:6]),
        "another version": ("server", ping[:2] + bytes([WIRE_VERSION + 1]) + ping[3:]),
        "header longer than message": ("server", ping[:4] + b"\xff\xff\xff\xff" + ping[8:]),
        "header cut off": ("server", ping[:-8]),
        "padding not zero": ("server", odd[:-1] + b"\x01"),
        "unknown kind": ("server", encode_message(99, {})),
        "reply sent to server": ("server", encode_message(WIRE_PONG, {"t": 0.5})),
        "header not msgpack": ("server", raw(b"\xc1" * 8)),
        "header not a map": ("server", raw(msgpack.packb([1, 2, 3]))),
        "keys not text": ("server", raw(msgpack.packb({1: 2}))),
        "text not UTF-8": ("server", raw(b"\x81\xa1t\xa2\xff\xfe")),
        "bytes after the map": ("server", raw((msgpack.packb({"t": 0.5}) or b"") + b"\x01")),
        "deep nesting": ("server", raw(b"\x91" * 3000)),
        "missing field": ("server", encode_message(WIRE_PING, {})),
        "unknown field": ("server", encode_message(WIRE_PING, {"t": 0.5, "u": 1})),
        "number is text": ("server", encode_message(WIRE_PING, {"t": "1"})),
        "number not finite": ("server", encode_message(WIRE_PING, {"t": float("nan")})),
        "number is a truth value": ("server", encode_message(WIRE_PING, {"t": True})),
        "pull of two numbers": ("server", encode_message(7, {**PULL, "target": [0.5, 0.5]})),
        "pull too far": ("server", encode_message(7, {**PULL, "target": [0.5, 0.5, 1000.5]})),
        "pull without a tree": ("server", encode_message(7, {**PULL, "x": float("nan")})),
        "pulls without force": ("client", encode_message(73, {"time_s": 0.5, "pulls": [PULL]})),
        "too many pulls": (
            "client",
            encode_message(73, {"time_s": 0.5, "pulls": [{**PULL, "force": [0.5, 0.5, 0.5]}] * 33}),
        ),
        "ping with payload": ("server", ping + bytes(8)),
        "unknown mode": ("server", forest_with(mode="both")),
        "table not a hash": ("server", forest_with(tree, groups=[{"table": "../etc", "count": 1}])),
        "count negative": ("server", forest_with(groups=[{"table": TABLE, "count": -1}])),
        "count not whole": ("server", forest_with(groups=[{"table": TABLE, "count": 0.5}])),
        "group not a map": ("server", forest_with(groups=[[TABLE, 1]])),
        "too few trees": ("server", forest_with(groups=group)),
        "too many trees": ("server", forest_with(tree + tree, groups=group)),
        "too few trees in table mode": (
            "server",
            forest_with(tree, mode="table", groups=[{"table": TABLE, "count": 2}]),
        ),
        "paused is a number": ("server", encode_message(WIRE_PAUSE, {"paused": 1})),
        "resync with a field": ("server", encode_message(WIRE_RESYNC, {"tick": 1})),
        "name of a shared forest": ("server", forest_with(options={"share": "../etc"})),
        "no name of a shared forest": ("server", forest_with(options={"share": ""})),
        "long name of a shared forest": ("server", forest_with(options={"share": "a" * 65})),
        "line end in a name": ("server", forest_with(options={"share": "a\n"})),
        "replant is text": ("server", forest_with(options={"replant": "yes"})),
        "about nested": ("server", forest_with(options={"about": {"a": {}}})),
        "about not finite": ("server", forest_with(options={"about": {"a": float("inf")}})),
        "about too long": ("server", forest_with(options={"about": {str(k): k for k in range(33)}})),
        "have not a hash": ("server", forest_with(options={"have": {"a": 1}})),
        "have negative": ("server", forest_with(options={"have": {TABLE: -1}})),
        "tree without a place": ("server", forest_with(struct.pack("<4f", np.nan, 0, 0, 1), groups=group)),
        "tree without a size": ("server", forest_with(bytes(16), groups=group)),
        "unknown option": ("server", forest_with(options={"colour": 1})),
        "unknown method": ("server", forest_with(options={"method": "drift"})),
        "easing out of range": ("server", forest_with(options={"pose_easing": 1.5})),
        "wind not a map": ("server", forest_with(wind=[])),
        "request sent to client": ("client", ping),
        "frame too short": ("client", encode_message(WIRE_FRAME, frame, b"\0\0")),
        "base not a number": ("client", encode_message(WIRE_FRAME, {**frame, "base": True}, bytes(4))),
        "more wide modes than modes": (
            "client",
            encode_message(WIRE_FRAME, {**frame, "base": 0, "groups": [{**row, "wide": 2}]}, bytes(3)),
        ),
        "no quantum": (
            "client",
            encode_message(WIRE_FRAME, {**frame, "groups": [{**row, "quantum": 0}]}, bytes(4)),
        ),
        "huge frame": (
            "client",
            encode_message(WIRE_FRAME, {**frame, "groups": [{**row, "count": 2**40, "modes": 2**12}]}),
        ),
        "clock without a pause": ("client", encode_message(WIRE_CLOCK, {"time_s": 0.5, "made_s": 0.5})),
        "chunk past the end": (
            "client",
            encode_message(WIRE_TABLE, {"table": TABLE, "offset": 0, "total": 1}, b"ab"),
        ),
    }


def main() -> None:
    WIRE_FOLDER.mkdir(exist_ok=True)
    for name, message in REQUESTS.items():
        (WIRE_FOLDER / f"{name}.bin").write_bytes(wire.encode_request(request_of(message)))
    for name, message in REPLIES.items():
        (WIRE_FOLDER / f"{name}.bin").write_bytes(wire.encode_reply(reply_of(message)))
    said = {"requests": REQUESTS, "replies": REPLIES}
    (WIRE_FOLDER / "messages.json").write_text(json.dumps(said, ensure_ascii=False, indent=1) + "\n")
    bad = [{"name": name, "at": at, "hex": data.hex()} for name, (at, data) in refused().items()]
    (WIRE_FOLDER / "refused.json").write_text(json.dumps(bad, indent=1) + "\n")


if __name__ == "__main__":
    main()
