"""Protocol errors: any bytes from a client lead to a documented close code and do not affect the server."""

from __future__ import annotations

import contextlib
import itertools
import os
import socket
import struct
from collections.abc import Iterator
from typing import Any

import pytest
from galewood_server.stream import wire
from galewood_server.stream.wire.envelope import encode_message
from hypothesis import given, seed, settings
from hypothesis import strategies as st

from tests.server.stream.test_forest_stream import POLE, SHA256, Client, forest, sockets
from tests.server.support.server_process import FAKE_SERVER, Server, wait_until

LONGEST_BYTES = 50_000
HELLO = wire.encode_request(wire.Hello("raw"))
CLOSED = {1002, 1003, 1007, 1008, 1009}
quick = settings(max_examples=25, deadline=None)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("basics") / "data"
    table = data_dir / "tables" / SHA256[:2] / SHA256
    table.parent.mkdir(parents=True)
    table.write_bytes(POLE)
    limits = {"GALEWOOD_SOCKET_MESSAGE_BYTES": str(LONGEST_BYTES)}
    limits |= {"GALEWOOD_SOCKET_CONNECTIONS_PER_ADDRESS": "200"}
    server = Server(data_dir, FAKE_SERVER, limits).start()
    yield server
    server.stop()


def frame(opcode: int, payload: bytes, *, fin: bool = True, masked: bool = True, reserved: int = 0) -> bytes:
    """A WebSocket frame (RFC 6455, section 5.2)."""
    head = bytes([fin << 7 | reserved << 4 | opcode])
    bit = masked << 7
    if len(payload) < 126:
        head += bytes([bit | len(payload)])
    elif len(payload) < 65536:
        head += struct.pack("!BH", bit | 126, len(payload))
    else:
        head += struct.pack("!BQ", bit | 127, len(payload))
    if not masked:
        return head + payload
    key = os.urandom(4)
    return head + key + bytes(byte ^ key[k % 4] for k, byte in enumerate(payload))


class Raw:
    """A raw socket after the WebSocket upgrade, to send invalid data."""

    def __init__(self, server: Server) -> None:
        self.link = socket.create_connection(("127.0.0.1", server.port), timeout=20)
        host = f"127.0.0.1:{server.port}"
        self.link.sendall(
            f"GET /ws/forest HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Key: Z2FsZXdvb2QtYmVuY2gtMQ==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        self.stream = self.link.makefile("rb")
        assert b" 101 " in self.stream.readline()
        while self.stream.readline().strip():
            pass

    def send(self, data: bytes) -> None:
        with contextlib.suppress(OSError):  # the server may close earlier
            self.link.sendall(data)

    def receive(self) -> tuple[int, bytes]:
        """Opcode and payload of the next frame; (8, b"") at the end of the stream."""
        try:
            head = self.stream.read(2)
            if len(head) < 2:
                return 8, b""
            length = head[1]
            if length > 125:
                length = int.from_bytes(self.stream.read(2 if length == 126 else 8))
            return head[0] & 15, self.stream.read(length)
        except OSError:
            return 8, b""

    def close_code(self) -> int | None:
        """The server's close code; None without a closing handshake."""
        while True:
            opcode, payload = self.receive()
            if opcode == 8:
                return int.from_bytes(payload[:2]) if payload else None

    def __enter__(self) -> Raw:
        return self

    def __exit__(self, *_: object) -> None:
        self.stream.close()
        self.link.close()


@pytest.fixture(scope="module", autouse=True)
def lives_on(server: Server) -> Iterator[None]:
    """After all tests, check for open sockets and errors, and that streaming still works."""
    yield
    wait_until(lambda: sockets(server) == 0)
    with Client(server) as client:
        client.send(forest())
        assert [frame.tick for (frame, _), _ in zip(client.frames(), range(3), strict=False)]
    assert "Traceback" not in server.log()


@seed(21)
@given(st.lists(st.integers(1, len(HELLO) - 1), max_size=6, unique=True), st.booleans())
@quick
def test_fragmented_messages_are_reassembled(server: Server, cuts: list[int], pinged: bool) -> None:
    edges = [0, *sorted(cuts), len(HELLO)]
    pieces = [HELLO[a:b] for a, b in itertools.pairwise(edges)]
    with Raw(server) as raw:
        for k, piece in enumerate(pieces):
            raw.send(frame(0 if k else 2, piece, fin=k == len(pieces) - 1))
            if pinged and k < len(pieces) - 1:
                raw.send(frame(9, b"between"))
                assert raw.receive() == (10, b"between")
        opcode, payload = raw.receive()
        assert opcode == 2 and isinstance(wire.decode_reply(payload), wire.Welcome)


@seed(22)
@given(st.integers(1, 200_000), st.booleans(), st.integers(1, 5))
@quick
def test_an_oversized_message_is_closed_with_1009(
    server: Server, excess: int, welcome: bool, pieces: int
) -> None:
    data = bytes(LONGEST_BYTES + excess)
    step = -(-len(data) // pieces)
    with Raw(server) as raw:
        if welcome:
            raw.send(frame(2, HELLO))
        for at in range(0, len(data), step):
            raw.send(frame(0 if at else 2, data[at : at + step], fin=at + step >= len(data)))
        assert raw.close_code() == 1009


def test_an_oversized_declared_length_is_rejected_at_once(server: Server) -> None:
    for length in (LONGEST_BYTES + 1, 2**40, 2**63 - 1):
        with Raw(server) as raw:
            raw.send(b"\x82\xff" + length.to_bytes(8) + bytes(4))
            assert raw.close_code() == 1009


@seed(23)
@given(st.binary(min_size=1, max_size=80), st.booleans())
@quick
def test_text_is_closed_with_1003_and_invalid_utf8_with_1007(
    server: Server, data: bytes, welcome: bool
) -> None:
    try:
        data.decode()
        expected = {1003}
    except UnicodeDecodeError:
        expected = {1007}
    with Raw(server) as raw:
        if welcome:
            raw.send(frame(2, HELLO))
        raw.send(frame(1, data))
        assert raw.close_code() in expected


@seed(24)
@given(
    st.sampled_from([3, 4, 5, 6, 7, 11, 12, 13, 14, 15]) | st.none(),
    st.integers(0, 7),
    st.booleans(),
    st.binary(max_size=60),
)
@quick
def test_invalid_frames_are_closed_with_1002(
    server: Server, opcode: int | None, reserved: int, masked: bool, payload: bytes
) -> None:
    if opcode is None and not reserved and masked:
        opcode = 0  # a continuation without a first fragment
    with Raw(server) as raw:
        raw.send(frame(2 if opcode is None else opcode, payload, masked=masked, reserved=reserved))
        assert raw.close_code() == 1002


def test_a_query_that_the_socket_does_not_know_is_an_error(server: Server) -> None:
    client = Client(server, hello=False, query="?shares=meadow")
    answer = client.receive()
    assert isinstance(answer, wire.Failure) and answer.code == "unknown-parameter"
    assert "Did you mean 'share'?" in answer.hint


@seed(25)
@given(st.integers(0, 400), st.booleans())
@quick
def test_truncated_connections_leave_no_state(server: Server, length: int, rough: bool) -> None:
    said = frame(2, HELLO) + frame(2, wire.encode_request(forest(count=12, share="torn")))
    with Raw(server) as raw:
        raw.send(said[: min(length, len(said))])
        if rough:  # RST instead of FIN
            raw.link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))


values = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)
names = st.sampled_from(
    ["client", "mode", "groups", "options", "wind", "time_s", "t", "paused", "share", "replant"]
)


@seed(26)
@given(st.integers(0, 80), st.dictionaries(names, values, max_size=6), st.binary(max_size=64), st.booleans())
@settings(max_examples=80, deadline=None)
def test_random_messages_are_answered_or_rejected(
    server: Server, kind: int, header: dict[str, Any], payload: bytes, welcome: bool
) -> None:
    with Raw(server) as raw:
        if welcome:
            raw.send(frame(2, HELLO))
        raw.send(frame(2, encode_message(kind, header, payload)))
        raw.send(frame(2, b"the end"))  # not a message: closes the socket at the latest here
        assert raw.close_code() in CLOSED


@seed(27)
@given(st.binary(max_size=200))
@settings(max_examples=60, deadline=None)
def test_random_bytes_end_in_a_close(server: Server, data: bytes) -> None:
    with Raw(server) as raw:
        raw.send(frame(2, HELLO))
        raw.send(data)
        raw.link.shutdown(socket.SHUT_WR)
        assert raw.close_code() in {*CLOSED, None, 1000, 1005, 1011} or data[:1] == b"\x88"
