"""Metering of sockets: the count of frames against brute force, and floods of frames that are no messages."""

from __future__ import annotations

import itertools

import httpx
import pytest
from galewood_server.stream.frame_meter import FrameMeter, SocketLimits
from hypothesis import given, seed, settings
from hypothesis import strategies as st

from tests.server.stream.test_forest_stream import sockets
from tests.server.stream.test_socket_protocol import HELLO, Raw, frame
from tests.server.support.server_process import Server, wait_until

FLOOD = 50_000
frames = st.builds(
    frame,
    st.sampled_from([0, 1, 2, 8, 9, 10]),
    st.sampled_from([0, 1, 125, 126, 300, 65535, 65536]).map(bytes),
    fin=st.booleans(),
    masked=st.booleans(),
)


@seed(31)
@given(st.lists(frames, min_size=1, max_size=8), st.lists(st.integers(0, 10**6), max_size=20))
@settings(max_examples=200, deadline=None)
def test_every_frame_is_counted_however_the_stream_is_cut(sent: list[bytes], cuts: list[int]) -> None:
    data = b"".join(sent)
    edges = [0, *sorted({cut % len(data) for cut in cuts} - {0}), len(data)]
    for allowed in (len(sent), len(sent) - 1):
        # the bucket holds two seconds of frames, and the clock stands still
        meter = FrameMeter(SocketLimits(frames_per_s=allowed / 2, bytes_per_s=1e9), 0.0)
        excesses = [meter.excess(data[a:b], 0.0) for a, b in itertools.pairwise(edges)]
        assert any(excesses) == (allowed < len(sent))


def test_buckets_fill_with_time() -> None:
    meter = FrameMeter(SocketLimits(frames_per_s=10, bytes_per_s=1e6), 0.0)
    assert meter.excess(frame(9, b"") * 20, 0.0) is None
    assert meter.excess(frame(9, b"") * 5, 0.5) is None
    assert meter.excess(frame(9, b""), 0.55) == "More than 10 frames per second"


def test_bytes_are_limited_and_every_read_has_a_price() -> None:
    limits = SocketLimits(frames_per_s=1e6, bytes_per_s=2048, message_bytes=4096)
    meter = FrameMeter(limits, 0.0)
    head = frame(2, bytes(10**6))[:14]
    assert meter.excess(head + bytes(2 * 2048 + 2 * 4096 - 14), 0.0) is None
    assert meter.excess(b"1", 0.0) == "More than 2 KiB per second"
    trickle = FrameMeter(limits, 0.0)
    assert [trickle.excess(b"\x82", 0.0) is None for _ in range(13)] == [True] * 12 + [False]


@pytest.mark.parametrize(
    ("flood", "before"),
    [
        (frame(9, b""), b""),
        (frame(10, b"unasked"), b""),
        (frame(0, b"", fin=False), frame(2, b"", fin=False)),
    ],
    ids=["pings", "pongs", "empty fragments"],
)
def test_a_flood_of_frames_ends_with_1008_and_a_reason(server: Server, flood: bytes, before: bytes) -> None:
    with Raw(server) as raw:
        raw.send(frame(2, HELLO))
        assert raw.receive()[0] == 2
        raw.send(before + flood * FLOOD)
        answers = list(iter(raw.receive, (8, b"")))
        pongs = sum(opcode == 10 for opcode, _ in answers[:-1] or answers)
        closing = next((payload for opcode, payload in answers if opcode == 8), b"")
        assert closing[:2] == (1008).to_bytes(2) and b"300 frames per second" in closing
        assert pongs < FLOOD / 10  # a few seconds' worth at most, not an answer for each
    wait_until(lambda: sockets(server) == 0)
    assert httpx.get(f"{server.url}/api/health").status_code == 200
    assert "Traceback" not in server.log()
