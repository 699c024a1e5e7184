"""The message FRAME, which contains poses.

Poses are integers in units of `quantum` × the table's modes.scale. Key frames are int32. Other frames contain
differences to another tick: int16 for the first `wide` modes, which move most, and int8 for the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from galewood.constants import WIRE_FRAME

from galewood_server.stream.wire.envelope import (
    Header,
    WireError,
    check_fields,
    encode_message,
    list_field,
    number,
    text_map,
    whole_number,
)

Poses = npt.NDArray[np.int32]


@dataclass(frozen=True)
class Rows:
    """Poses of one group or their differences: (count, modes) in units of `quantum` × modes.scale."""

    quantum: int
    values: Poses


@dataclass(frozen=True)
class Frame:
    """Poses of all trees at one tick: absolute if `base` is None, otherwise differences to tick `base`."""

    tick: int
    base: int | None
    time_s: float  # forest time
    made_s: float  # server clock, as in PONG
    groups: tuple[Rows, ...]

    @property
    def key(self) -> bool:
        """Whether this is a key frame."""
        return self.base is None


def wide_modes(values: Poses) -> int:
    """Number of leading modes that need int16 so that the others fit int8; −1 if int16 is too narrow."""
    if not values.size:
        return 0
    low, high = values.min(axis=0), values.max(axis=0)
    if int(low.min()) < -32768 or int(high.max()) > 32767:
        return -1
    return 1 + int(np.flatnonzero((low < -128) | (high > 127)).max(initial=-1))


def encode_frame(frame: Frame) -> bytes:
    """Encode FRAME. ValueError if a difference does not fit 16 bits."""
    wides = [rows.values.shape[1] if frame.key else wide_modes(rows.values) for rows in frame.groups]
    if min(wides, default=0) < 0:
        raise ValueError("a difference does not fit 16 bits: send a key frame")
    groups = [
        {"count": len(rows.values), "modes": rows.values.shape[1], "quantum": rows.quantum, "wide": wide}
        for rows, wide in zip(frame.groups, wides, strict=True)
    ]
    header = {
        "tick": frame.tick,
        "base": frame.base,
        "time_s": frame.time_s,
        "made_s": frame.made_s,
        "groups": groups,
    }
    return encode_message(WIRE_FRAME, header, _payload(frame, wides))


def _payload(frame: Frame, wides: Sequence[int]) -> bytes:
    values = [rows.values for rows in frame.groups]
    if frame.key:
        return b"".join(rows.astype("<i4").tobytes() for rows in values)
    parts = list(zip(values, wides, strict=True))
    return b"".join(
        [rows[:, :wide].astype("<i2").tobytes() for rows, wide in parts]
        + [rows[:, wide:].astype("i1").tobytes() for rows, wide in parts]
    )


@dataclass(frozen=True)
class _Shape:
    count: int
    modes: int
    quantum: int
    wide: int


def decode_frame(header: Header, payload: bytes) -> Frame:
    """Decode FRAME. WireError."""
    check_fields(header, "tick", "base", "time_s", "made_s", "groups")
    base = None if header["base"] is None else whole_number(header, "base")
    shapes = [_shape(entry) for entry in list_field(header, "groups")]
    if len(payload) != _length(shapes, base is None):
        raise WireError("the payload does not have the length that the groups say")
    values = _absolute(shapes, payload) if base is None else _differences(shapes, payload)
    groups = tuple(Rows(shape.quantum, rows) for shape, rows in zip(shapes, values, strict=True))
    tick, time_s, made_s = whole_number(header, "tick"), number(header, "time_s"), number(header, "made_s")
    return Frame(tick, base, time_s, made_s, groups)


def _shape(entry: Any) -> _Shape:
    group = text_map(entry, "a group")
    check_fields(group, "count", "modes", "quantum", "wide")
    shape = _Shape(
        whole_number(group, "count"),
        whole_number(group, "modes"),
        whole_number(group, "quantum"),
        whole_number(group, "wide"),
    )
    if shape.wide > shape.modes or shape.quantum < 1:
        raise WireError("quantum must be at least 1, and wide at most the number of modes")
    return shape


def _length(shapes: Sequence[_Shape], key: bool) -> int:
    if key:
        return sum(4 * shape.count * shape.modes for shape in shapes)
    return sum(shape.count * (shape.modes + shape.wide) for shape in shapes)


def _absolute(shapes: Sequence[_Shape], payload: bytes) -> list[Poses]:
    rows: list[Poses] = []
    at = 0
    for shape in shapes:
        flat = np.frombuffer(payload, "<i4", shape.count * shape.modes, at).astype(np.int32)
        rows.append(flat.reshape(shape.count, shape.modes))
        at += flat.nbytes
    return rows


def _differences(shapes: Sequence[_Shape], payload: bytes) -> list[Poses]:
    at, narrow = 0, sum(2 * shape.count * shape.wide for shape in shapes)
    rows: list[Poses] = []
    for shape in shapes:
        values = np.empty((shape.count, shape.modes), np.int32)
        near, far = shape.count * shape.wide, shape.count * (shape.modes - shape.wide)
        values[:, : shape.wide] = np.frombuffer(payload, "<i2", near, at).reshape(shape.count, shape.wide)
        values[:, shape.wide :] = np.frombuffer(payload, "i1", far, narrow).reshape(
            shape.count, shape.modes - shape.wide
        )
        at, narrow = at + 2 * near, narrow + far
        rows.append(values)
    return rows
