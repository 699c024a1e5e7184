"""The forest WebSocket of a real server: both modes, limits and misbehaving clients."""

from __future__ import annotations

import contextlib
import hashlib
import json
import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from galewood.constants import TICK_HZ, WIRE_FOREST, WIRE_VERSION
from galewood.motion.wind.evaluation import Wind, WindState, parse_state, parse_wind_or_state
from galewood.table import format as table_format
from galewood_server.stream import wire
from galewood_server.stream.forest import ForestClock, ForestStepper
from galewood_server.stream.wire.envelope import encode_message
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from tests.golden import GOLDEN_FOLDER
from tests.golden.make_wire import WIRE_FOLDER
from tests.server.support.server_process import FAKE_SERVER, Server, wait_until

POLE = (GOLDEN_FOLDER / "pole.safetensors").read_bytes()
SHA256 = hashlib.sha256(POLE).hexdigest()
BREEZE = Wind().document()


def without_leaves() -> bytes:
    """The table of the same mesh that catches half as much wind."""
    pole = table_format.decode(POLE)
    metadata = {**pole.metadata, "foliage": "bare"}
    return table_format.encode(replace(pole, metadata=metadata, modal_load=pole.modal_load / 2))


BARE = without_leaves()
BARE_SHA256 = hashlib.sha256(BARE).hexdigest()
REFUSED = [case for case in json.loads((WIRE_FOLDER / "refused.json").read_text()) if case["at"] == "server"]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("stream") / "data"
    for sha256, content in ((SHA256, POLE), (BARE_SHA256, BARE)):
        table = data_dir / "tables" / sha256[:2] / sha256
        table.parent.mkdir(parents=True)
        table.write_bytes(content)
    limits = {"GALEWOOD_FOREST_TREES": "2000", "GALEWOOD_SOCKET_STALL_S": "6"}
    limits |= {"GALEWOOD_SOCKET_CONNECTIONS_PER_ADDRESS": "4", "GALEWOOD_SOCKET_MESSAGE_BYTES": "100000"}
    server = Server(data_dir, FAKE_SERVER, limits).start()
    yield server
    server.stop()


def trees(count: int, seed: int = 11) -> npt.NDArray[np.float32]:
    rng = np.random.default_rng(seed)
    low, high = [-100, -100, -np.pi, 0.5], [100, 100, np.pi, 2.0]
    return rng.uniform(low, high, (count, 4)).astype(np.float32)


def forest(mode: Any = "stream", count: int = 30, **changes: Any) -> wire.Forest:
    groups = (wire.Group(SHA256, count // 3), wire.Group(SHA256, count - count // 3))
    rows = trees(count) if mode == "stream" else np.zeros((0, 4), np.float32)
    return replace(wire.Forest(mode, groups, BREEZE, 5.0, 0.02, rows), **changes)


class Client:
    """A WebSocket client of the wire protocol."""

    def __init__(self, server: Server, hello: bool = True, query: str = "", **options: Any) -> None:
        self.state: WindState | None = None
        self.clock: wire.Clock | None = None
        self.shared: wire.Shared | None = None
        self.poses: list[Any] = []
        self.tick: int | None = None
        self.socket: ClientConnection = connect(
            server.socket_url + query, max_size=None, compression=None, close_timeout=1, **options
        )
        if hello:
            self.send(wire.Hello("test"))
            welcome = self.receive()
            assert isinstance(welcome, wire.Welcome)
            assert (welcome.version, welcome.tick_hz) == (
                WIRE_VERSION,
                TICK_HZ,
            ) and "galewood" in welcome.server

    def send(self, request: wire.Request) -> None:
        self.socket.send(wire.encode_request(request))

    def receive(self) -> wire.Reply:
        data = self.socket.recv(timeout=30)
        assert isinstance(data, bytes)
        return wire.decode_reply(data)

    def frames(self) -> Iterator[tuple[wire.Frame, list[npt.NDArray[np.int32]]]]:
        """Frames with the accumulated poses, in units of quantum × modes.scale."""
        while True:
            frame = self.receive()
            if isinstance(frame, wire.WindState):
                self.state = parse_state(frame.state)
            elif isinstance(frame, wire.Clock):
                self.clock = frame
            elif isinstance(frame, wire.Shared):
                self.shared = frame
            elif isinstance(frame, wire.Frame):
                assert frame.base in (None, self.tick)
                rows = [group.values for group in frame.groups]
                before = [np.int32(0)] * len(rows) if frame.key else self.poses
                self.poses = [a + b for a, b in zip(before, rows, strict=True)]
                self.tick = frame.tick
                yield frame, self.poses
            else:
                assert isinstance(frame, wire.Pong | wire.Presence)

    def session_error(self) -> tuple[wire.Failure, int, str]:
        """The server's error message, close code and reason."""
        while True:
            reply = self.receive()
            if isinstance(reply, wire.Failure):
                break
        with pytest.raises(ConnectionClosed) as closed:
            self.socket.recv(timeout=10)
        assert closed.value.rcvd is not None
        return reply, closed.value.rcvd.code, closed.value.rcvd.reason

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()


class LocalStepper:
    """A local simulation of the same forest."""

    def __init__(self, request: wire.Forest) -> None:
        self.clock = ForestClock(parse_wind_or_state(request.wind), request.time_s)
        tables = [table_format.decode({SHA256: POLE, BARE_SHA256: BARE}[one.table]) for one in request.groups]
        self._stepper = ForestStepper(tables, request, self.clock)
        self.time_s = self.clock.time_s

    def step(self) -> None:
        self.clock.tick()
        self._stepper.step()
        self.time_s = self.clock.time_s

    def poses(self) -> list[npt.NDArray[np.int32]]:
        rows = [np.zeros((count, modes), np.int32) for count, modes, _ in self._stepper.shapes]
        self._stepper.write_poses(rows)
        return rows


local_stepper = LocalStepper


def test_streamed_poses_match_a_local_simulation(server: Server) -> None:
    request = forest()
    stepper = local_stepper(request)
    with Client(server) as client:
        client.send(request)
        moved = False
        for count, (frame, poses) in enumerate(client.frames()):
            assert frame.key == (count == 0)
            while stepper.time_s < frame.time_s - 1e-9:
                stepper.step()
            assert stepper.time_s == pytest.approx(frame.time_s, abs=1e-9)
            for mine, theirs in zip(stepper.poses(), poses, strict=True):
                np.testing.assert_array_equal(mine, theirs)
            moved = moved or any(rows.any() for rows in poses)
            if count == 60:
                break
        assert moved


def test_a_group_may_play_a_table_without_leaves(server: Server) -> None:
    """The same tree in leaf and bare, side by side, as a local simulation of both moves them."""
    place = np.array([[3.0, 4.0, 0.5, 1.0]] * 2, np.float32)
    groups = (wire.Group(SHA256, 1), wire.Group(BARE_SHA256, 1))
    request = forest(groups=groups, trees=place)
    stepper = local_stepper(request)
    with Client(server) as client:
        client.send(request)
        for count, (frame, poses) in enumerate(client.frames()):
            while stepper.time_s < frame.time_s - 1e-9:
                stepper.step()
            for mine, theirs in zip(stepper.poses(), poses, strict=True):
                np.testing.assert_array_equal(mine, theirs)
            if count == 60:
                leaf, bare = (np.abs(rows).max() for rows in poses)
                assert 0 < bare < leaf
                break


def test_a_wind_change_is_answered_with_the_applied_wind(server: Server) -> None:
    request = forest()
    stepper = local_stepper(request)
    new = Wind(12.0, 300.0, 0.8, model="perlin", length_scale_m=15.0)
    with Client(server) as client:
        client.send(request)
        for count, (frame, poses) in enumerate(client.frames()):
            if count == 20:
                client.send(wire.WindChange(new.document()))
            while stepper.time_s < frame.time_s - 1e-9:
                if client.state and abs(stepper.time_s + 1 / TICK_HZ - client.state.since_s) < 1e-6:
                    assert stepper.clock.change_wind(new).travel == pytest.approx(client.state.travel)
                stepper.step()
            np.testing.assert_allclose(np.vstack(stepper.poses()), np.vstack(poses), atol=1)
            if count > 60:
                break
        assert client.state and client.state.wind == new


def test_a_slow_client_misses_frames_but_no_changes(server: Server) -> None:
    request = forest(count=2000)
    stepper = local_stepper(request)
    narrow = socket.socket()
    narrow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    narrow.connect(("127.0.0.1", server.port))
    with Client(server, max_queue=1, sock=narrow) as client:
        client.send(request)
        for count, (frame, poses) in enumerate(client.frames()):
            if count in (10, 20):
                time.sleep(1.2)
            while stepper.time_s < frame.time_s - 1e-9:
                stepper.step()
            np.testing.assert_array_equal(np.vstack(stepper.poses()), np.vstack(poses))
            if count == 30:
                assert frame.tick > 30
                break


def test_wind_changes_and_new_forests_take_effect(server: Server) -> None:
    still = Wind(mean_speed_m_s=0.0).document()
    with Client(server) as client:
        client.send(forest(wind=still))
        stream = client.frames()
        _, poses = [next(stream) for _ in range(10)][-1]
        assert not any(rows.any() for rows in poses)
        client.send(wire.WindChange(BREEZE))
        assert any(any(rows.any() for rows in next(stream)[1]) for _ in range(90))
        client.send(forest(count=9, time_s=100.0))
        frame = next(frame for frame, _ in stream if frame.key)
        assert frame.tick == 0 and frame.time_s == 100.0
        assert [len(rows.values) for rows in frame.groups] == [3, 6]


def test_tables_are_sent_in_chunks(server: Server) -> None:
    with Client(server) as client:
        client.send(forest("table"))
        data = bytearray()
        while True:
            chunk = client.receive()
            assert isinstance(chunk, wire.TableChunk)
            assert (chunk.table, chunk.offset) == (SHA256, len(data))
            data += chunk.data
            if len(data) == chunk.total:
                break
        assert bytes(data) == POLE
        client.send(wire.Ping(4.5))
        pong = client.receive()
        assert isinstance(pong, wire.Pong) and pong.t == 4.5 and pong.server_s > 0


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case["name"])
def test_invalid_messages_are_closed_with_code_and_reason(server: Server, case: dict[str, Any]) -> None:
    with Client(server) as client:
        client.socket.send(bytes.fromhex(case["hex"]))
        failure, code, reason = client.session_error()
        assert code in (1007, 1008) and reason and failure.title.startswith(reason)


def test_another_wire_version_is_rejected_with_both_versions(server: Server) -> None:
    with Client(server, hello=False) as client:
        data = bytearray(wire.encode_request(wire.Hello("new")))
        data[2] = 9
        client.socket.send(bytes(data))
        failure, code, reason = client.session_error()
        assert (failure.code, code) == ("unknown-version", 1008)
        assert "9" in reason and str(WIRE_VERSION) in reason


@pytest.mark.parametrize(
    ("requests", "code"),
    [
        ([forest(groups=(wire.Group("0" * 64, 30),))], "no-such-table"),
        ([forest("table", groups=(wire.Group("0" * 64, 30),))], "no-such-table"),
        ([forest(count=2001)], "too-many-trees"),
        ([forest("table", groups=(wire.Group(SHA256, 1),) * 65)], "too-many-groups"),
        ([forest(wind={"version": 1})], "bad-wind"),
        ([forest(), wire.WindChange({**BREEZE, "mean_speed_m_s": 1e9})], "bad-wind"),
        ([wire.Hello("again")], "second-hello"),
        ([wire.WindChange(BREEZE)], "no-forest"),
        ([wire.Ping(0.5), wire.Resync()], "no-forest"),
        ([wire.Pause(True)], "no-forest"),
        ([wire.Gust(1.0, 2.0)], "no-forest"),
        ([wire.Release(1)], "no-forest"),
        ([wire.Ping(0.5)] * 500, "too-many-messages"),
    ],
)
def test_requests_beyond_the_limits_are_rejected(
    server: Server, requests: list[wire.Request], code: str
) -> None:
    with Client(server) as client:
        with contextlib.suppress(ConnectionClosed):  # the server may close before the last message
            for request in requests:
                client.send(request)
        failure, close, _ = client.session_error()
        assert (failure.code, close) == (code, 1008)


def test_hello_must_be_first(server: Server) -> None:
    with Client(server, hello=False) as client:
        client.send(wire.Ping(0.5))
        failure, close, _ = client.session_error()
        assert (failure.code, close) == ("no-hello", 1008)


def test_text_messages_are_rejected(server: Server) -> None:
    with Client(server) as client:
        client.socket.send("hello")
        assert client.session_error()[1] == 1003


def test_an_oversized_message_closes_the_socket(server: Server) -> None:
    with Client(server) as client:
        client.socket.send(encode_message(WIRE_FOREST, {}, bytes(200_000)))
        with pytest.raises(ConnectionClosed) as closed:
            client.receive()
        assert closed.value.rcvd is not None and closed.value.rcvd.code == 1009


def test_foreign_origins_are_rejected(server: Server) -> None:
    with pytest.raises(InvalidStatus) as refused:
        Client(server, origin="https://elsewhere.example")
    assert refused.value.response.status_code == 403
    with Client(server, origin=f"http://127.0.0.1:{server.port}"):
        pass


def sockets(server: Server) -> int:
    with server.client() as api:
        return int(api.get("/healthz").json()["sockets"])


def test_too_many_sockets_are_rejected(server: Server) -> None:
    wait_until(lambda: sockets(server) == 0)
    clients = [Client(server) for _ in range(4)]
    with pytest.raises(InvalidStatus) as refused:
        Client(server)
    assert refused.value.response.status_code == 429
    for client in clients:
        client.socket.close()
    wait_until(lambda: sockets(server) == 0)
    with Client(server):
        pass


def test_a_client_that_never_reads_is_disconnected(server: Server) -> None:
    wait_until(lambda: sockets(server) == 0)
    stalled = Client(server, max_queue=1)
    raw = stalled.socket.socket
    raw.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    stalled.send(forest(count=2000))
    with Client(server) as other:
        other.send(forest())
        stream = other.frames()
        wait_until(lambda: next(stream) and sockets(server) == 1, 30, 0)
        seen = [next(stream)[0].time_s for _ in range(20)]
        assert np.diff(seen).max() < 0.5
    stalled.socket.close()


def test_unknown_socket_paths_are_rejected(server: Server) -> None:
    with pytest.raises(InvalidStatus):
        connect(f"ws://127.0.0.1:{server.port}/ws/other")


def test_a_lost_socket_leaves_no_state(start_server: Callable[..., Server], server: Server) -> None:
    wait_until(lambda: sockets(server) == 0)
    client = Client(server)
    client.send(forest())
    next(client.frames())
    client.socket.socket.shutdown(socket.SHUT_RDWR)
    wait_until(lambda: sockets(server) == 0)
    assert "Traceback" not in server.log()
