"""The wire protocol in Python: golden files, round trips and invalid bytes."""

from __future__ import annotations

import contextlib
import json
from typing import Any

import numpy as np
import pytest
from galewood.constants import WIRE_PING, WIRE_VERSION
from galewood_server.stream import wire
from galewood_server.stream.wire.envelope import MAGIC, WireError, decode_message, encode_message
from hypothesis import given, seed, settings
from hypothesis import strategies as st

from tests.golden.make_wire import REPLIES, REQUESTS, WIRE_FOLDER, reply_of, request_of

REFUSED = json.loads((WIRE_FOLDER / "refused.json").read_text())
SAID = json.loads((WIRE_FOLDER / "messages.json").read_text())


def same(one: Any, other: Any) -> bool:
    """Equality of messages with arrays."""
    if type(one) is not type(other):
        return False
    for name in one.__dataclass_fields__:
        mine, yours = getattr(one, name), getattr(other, name)
        if type(one) is wire.Frame and name == "groups":
            if len(mine) != len(yours) or not all(map(same, mine, yours)):
                return False
        elif not np.array_equal(mine, yours):
            return False
    return True


def test_golden_files_are_current() -> None:
    assert SAID == {"requests": REQUESTS, "replies": REPLIES}


@pytest.mark.parametrize("name", REQUESTS)
def test_golden_request(name: str) -> None:
    data, message = (WIRE_FOLDER / f"{name}.bin").read_bytes(), request_of(REQUESTS[name])
    assert wire.encode_request(message) == data
    assert same(wire.decode_request(data), message)


@pytest.mark.parametrize("name", REPLIES)
def test_golden_reply(name: str) -> None:
    data, message = (WIRE_FOLDER / f"{name}.bin").read_bytes(), reply_of(REPLIES[name])
    assert wire.encode_reply(message) == data
    assert same(wire.decode_reply(data), message)


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case["name"])
def test_invalid_messages_are_rejected(case: dict[str, Any]) -> None:
    decode = wire.decode_request if case["at"] == "server" else wire.decode_reply
    with pytest.raises(WireError) as session_error:
        decode(bytes.fromhex(case["hex"]))
    assert 5 < len(str(session_error.value)) < 200


def test_another_version_is_rejected() -> None:
    data = bytearray(encode_message(WIRE_PING, {"t": 0.5}))
    data[2] = 7
    with pytest.raises(WireError, match=f"7; this reader knows version {WIRE_VERSION}") as session_error:
        wire.decode_request(bytes(data))
    assert session_error.value.code == "unknown-version"


@pytest.mark.parametrize("name", [*REQUESTS, *REPLIES])
def test_every_truncation_is_rejected(name: str) -> None:
    data = (WIRE_FOLDER / f"{name}.bin").read_bytes()
    decode = wire.decode_request if name in REQUESTS else wire.decode_reply
    shortened = 0
    for length in range(len(data)):
        try:
            message = decode(data[:length])
        except WireError:
            shortened += 1
        else:  # a table's chunk may have any length up to the end, and where trees may be left out, none
            if not isinstance(message, wire.TableChunk):
                assert isinstance(message, wire.Forest | wire.Shared) and not len(message.trees)
    assert shortened


@seed(1)
@given(st.binary(max_size=400))
@settings(max_examples=400, deadline=None)
def test_random_bytes_are_decoded_or_rejected(data: bytes) -> None:
    for decode in (wire.decode_request, wire.decode_reply, decode_message):
        for message in (data, MAGIC + bytes([WIRE_VERSION]) + data):
            with contextlib.suppress(WireError):
                decode(message)


header_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats()
    | st.text(max_size=8)
    | st.binary(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)
known_names = [
    "mode",
    "groups",
    "options",
    "wind",
    "time_s",
    "client",
    "t",
    "tick",
    "base",
    "made_s",
    "server_s",
    "paused",
    "share",
    "about",
    "have",
    "table",
    "offset",
    "total",
]


@seed(2)
@given(
    st.sampled_from([1, 2, 3, 4, 5, 6, 65, 66, 67, 68, 69, 70, 71, 72]),
    st.dictionaries(st.sampled_from(known_names), header_values, max_size=6),
    st.binary(max_size=64),
)
@settings(max_examples=400, deadline=None)
def test_random_headers_are_decoded_or_rejected(kind: int, header: dict[str, Any], payload: bytes) -> None:
    data = encode_message(kind, header, payload)
    assert decode_message(data)[0] == kind
    for decode in (wire.decode_request, wire.decode_reply):
        with contextlib.suppress(WireError):
            decode(data)


@seed(3)
@given(
    st.lists(st.tuples(st.integers(0, 5), st.integers(0, 9), st.integers(0, 15)), max_size=4),
    st.none() | st.integers(0, 2**32),
    st.integers(0, 2**32),
)
@settings(max_examples=200, deadline=None)
def test_frames_round_trip(shapes: list[tuple[int, int, int]], base: int | None, number: int) -> None:
    rng = np.random.default_rng(number)
    groups: list[wire.Rows] = []
    for count, modes, bits in shapes:
        bound = 2**31 - 1 if base is None else 2**bits
        values = rng.integers(-bound, bound, (count, modes), dtype=np.int32)
        groups.append(wire.Rows(1 + number % 50, values // (1 + np.arange(modes, dtype=np.int32) ** 3)))
    frame = wire.Frame(number, base, number / 7, number / 3, tuple(groups))
    assert same(wire.decode_reply(wire.encode_reply(frame)), frame)


def test_only_large_modes_are_wide() -> None:
    values = np.array([[-129, 0, 127], [3, 128, -128], [0, 0, 0]], np.int32)
    data = wire.encode_reply(wire.Frame(5, 4, 0.5, 0.5, (wire.Rows(1, values),)))
    _, header, payload = decode_message(data)
    assert header["groups"][0]["wide"] == 2 and len(payload) == 3 * 2 * 2 + 3


def test_an_overflowing_difference_is_an_error() -> None:
    rows = (wire.Rows(1, np.array([[40000]], np.int32)),)
    with pytest.raises(ValueError, match="16 bits"):
        wire.encode_reply(wire.Frame(1, 0, 0.5, 0.5, rows))
