"""Shared forests of a real server: one wind, one clock, one simulation."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from galewood.constants import TICK_HZ
from galewood.motion.wind.evaluation import Wind, parse_wind_or_state
from galewood.motion.wind.transition import at
from galewood_server.stream import wire

from tests.server.stream.test_forest_stream import POLE, SHA256, Client, forest, local_stepper
from tests.server.support.server_process import FAKE_SERVER, Server


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("shared") / "data"
    table = data_dir / "tables" / SHA256[:2] / SHA256
    table.parent.mkdir(parents=True)
    table.write_bytes(POLE)
    server = Server(data_dir, FAKE_SERVER, {"GALEWOOD_SHARED_FOREST_IDLE_S": "1"}).start()
    yield server
    server.stop()


def joining(share: str, **changes: Any) -> wire.Forest:
    """A request with only the id of a shared forest."""
    none: dict[str, Any] = {"groups": (), "trees": np.zeros((0, 4), np.float32)}
    return forest(share=share, **{**none, **changes})


def frames_until(client: Client, holds: Callable[[wire.Frame], Any], most: int = 300) -> list[Any]:
    """(tick, poses) up to the first frame that fulfils a condition."""
    seen: list[Any] = []
    for (frame, poses), _ in zip(client.frames(), range(most), strict=False):
        seen.append((frame, poses))
        if holds(frame):
            return seen
    raise AssertionError("did not happen")


def test_a_late_client_joins_the_same_forest_by_id(server: Server) -> None:
    founding = forest(share="late", about={"forestSeed": 7, "wood": "größer"})
    with Client(server) as first, Client(server) as second:
        first.send(founding)
        frames_until(first, lambda frame: frame.tick >= 20)
        second.send(joining("late", wind=Wind(mean_speed_m_s=0.0).document(), time_s=999.0))
        mine = frames_until(second, lambda frame: frame.tick >= 60)
        assert mine[0][0].key and mine[0][0].tick >= 20
        theirs = {frame.tick: poses for frame, poses in frames_until(first, lambda f: f.tick >= 60)}
        both = [(poses, theirs[frame.tick]) for frame, poses in mine if frame.tick in theirs]
        assert len(both) > 10
        for ours, others in both:
            np.testing.assert_array_equal(np.vstack(ours), np.vstack(others))
        assert any(rows.any() for rows in both[-1][0])
        shared = second.shared
        assert shared and shared.groups == founding.groups and shared.about == founding.about
        np.testing.assert_array_equal(shared.trees, founding.trees)


def test_a_wind_change_applies_to_all_clients(server: Server) -> None:
    request = forest(share="wind")
    new = Wind(12.0, 300.0, 0.8, model="perlin", length_scale_m=15.0)
    with Client(server) as first, Client(server) as second, Client(server) as table:
        first.send(request)
        frames_until(first, lambda frame: frame.tick >= 5)
        second.send(joining("wind"))
        table.send(joining("wind", mode="table"))
        frames_until(second, lambda frame: frame.tick >= 10)
        second.send(wire.WindChange(new.document()))
        seen = frames_until(first, lambda frame: first.state is not None and first.state.wind == new)
        frames_until(second, lambda frame: second.state is not None and second.state.wind == new)
        assert first.state == second.state
        while True:
            told = table.receive()
            if isinstance(told, wire.WindState) and parse_wind_or_state(told.state).wind == new:
                assert parse_wind_or_state(told.state) == first.state
                break
        seen += frames_until(first, lambda frame: frame.tick >= seen[-1][0].tick + 30)
        stepper = local_stepper(request)
        state = first.state
        assert state is not None
        for frame, poses in seen:
            while stepper.time_s < frame.time_s - 1e-9:
                if abs(stepper.time_s + 1 / TICK_HZ - state.since_s) < 1e-6:
                    assert at(stepper.clock.change_wind(new), 7.0).travel == pytest.approx(
                        at(state, 7.0).travel
                    )
                stepper.step()
            np.testing.assert_allclose(np.vstack(stepper.poses()), np.vstack(poses), atol=1)


def test_a_pause_applies_to_all_clients(server: Server) -> None:
    with Client(server) as first, Client(server) as second:
        first.send(forest(share="pause"))
        frames_until(first, lambda frame: frame.tick >= 5)
        second.send(joining("pause"))
        frames_until(second, lambda frame: frame.key)
        second.send(wire.Pause(True))
        while not (isinstance(told := first.receive(), wire.Clock) and told.paused):
            pass
        second.send(wire.Ping(1.0))
        while not isinstance(second.receive(), wire.Pong):
            pass
        time.sleep(0.5)
        first.send(wire.Pause(False))
        while not (isinstance(told := second.receive(), wire.Clock) and not told.paused):
            assert not isinstance(told, wire.Frame) or told.time_s <= 5.0 + 60 / TICK_HZ
        stopped_s = told.time_s
        frame = next(reply for reply in iter(second.receive, None) if isinstance(reply, wire.Frame))
        assert frame.time_s == pytest.approx(stopped_s, abs=2 / TICK_HZ)


def test_replaced_trees_reach_all_clients(server: Server) -> None:
    with Client(server) as first, Client(server) as second:
        first.send(forest(share="replant"))
        frames_until(first, lambda frame: frame.tick >= 5)
        second.send(forest(count=9, share="replant"))
        (before, _), *_ = frames_until(second, lambda frame: True)
        assert [len(rows.values) for rows in before.groups] == [10, 20]
        second.send(forest(count=9, share="replant", replant=True, about={"trees": 9}))
        for client in (first, second):
            (frame, _) = frames_until(client, lambda frame: len(frame.groups[0].values) == 3)[-1]
            assert frame.key and frame.tick > before.tick - 2
            assert client.shared and client.shared.about == {"trees": 9}


def test_table_mode_receives_wind_and_clock(server: Server) -> None:
    with Client(server) as streaming, Client(server) as table:
        streaming.send(forest(share="clock"))
        frames_until(streaming, lambda frame: frame.tick >= 30)
        table.send(joining("clock", mode="table"))
        told = [table.receive() for _ in range(4)]
        assert [type(reply) for reply in told if not isinstance(reply, wire.Presence)][:3] == [
            wire.Shared,
            wire.WindState,
            wire.Clock,
        ]
        while not isinstance(clock := table.receive(), wire.Clock):
            pass
        (frame, _), *_ = frames_until(streaming, lambda frame: frame.made_s >= clock.made_s)
        elapsed_s = frame.made_s - clock.made_s
        assert frame.time_s - clock.time_s == pytest.approx(elapsed_s, abs=0.5)


def test_a_streaming_client_can_join_a_table_client(server: Server) -> None:
    with Client(server) as table, Client(server) as streaming:
        founding = forest("table", share="bare", trees=forest().trees, have={SHA256: len(POLE)})
        table.send(founding)
        assert isinstance(table.receive(), wire.Shared)
        streaming.send(joining("bare"))
        (frame, _), *_ = frames_until(streaming, lambda frame: True)
        assert [len(rows.values) for rows in frame.groups] == [10, 20]
        np.testing.assert_array_equal(streaming.shared.trees, founding.trees)  # type: ignore[union-attr]


def test_an_empty_shared_forest_is_kept_for_a_while(server: Server) -> None:
    with Client(server) as client:
        client.send(forest(share="waits"))
        left = frames_until(client, lambda frame: frame.tick >= 10)[-1][0].tick
    with Client(server) as client:
        client.send(joining("waits"))
        (frame, _), *_ = frames_until(client, lambda frame: True)
        assert frame.key and frame.tick >= left
    time.sleep(2.5)
    with Client(server) as client:
        client.send(forest(count=6, share="waits"))
        (frame, _), *_ = frames_until(client, lambda frame: True)
        assert frame.tick == 0 and len(frame.groups[0].values) == 2


def test_resync_sends_a_key_frame(server: Server) -> None:
    with Client(server) as client:
        client.send(forest())
        frames_until(client, lambda frame: frame.tick >= 5)
        client.send(wire.Resync())
        frame = frames_until(client, lambda frame: frame.key)[-1][0]
        assert frame.tick > 5


def test_private_forests_are_independent(server: Server) -> None:
    with Client(server) as first, Client(server) as second:
        for client in (first, second):
            client.send(forest())
        second.send(wire.WindChange(Wind(mean_speed_m_s=20.0).document()))
        frames_until(second, lambda frame: second.state is not None)
        frames_until(first, lambda frame: frame.tick >= 20)
        assert first.state is None and first.shared is None


@pytest.mark.parametrize("begin", [1, 200_000, len(POLE) - 1, len(POLE)])
def test_a_table_transfer_is_resumed(server: Server, begin: int) -> None:
    with Client(server) as client:
        client.send(forest("table", have={SHA256: begin}))
        data = bytearray(POLE[:begin])
        while True:
            chunk = client.receive()
            assert isinstance(chunk, wire.TableChunk)
            assert (chunk.offset, chunk.total) == (len(data), len(POLE))
            data += chunk.data
            if len(data) == chunk.total:
                break
        assert hashlib.sha256(data).hexdigest() == SHA256


def test_an_offset_beyond_the_table_is_rejected(server: Server) -> None:
    with Client(server) as client:
        client.send(forest("table", have={SHA256: len(POLE) + 1}))
        failure, close, _ = client.session_error()
        assert (failure.code, close) == ("no-such-offset", 1008)


def told_of(client: Client, clients: int) -> None:
    """Receive messages until one says that the forest has this many clients."""
    for _ in range(600):
        if client.receive() == wire.Presence(clients):
            return
    raise AssertionError(f"was not told of {clients} clients")


def test_all_clients_are_told_how_many_they_are(server: Server) -> None:
    with Client(server) as first:
        first.send(forest(share="present"))
        told_of(first, 1)
        with Client(server) as second:
            second.send(joining("present", mode="table"))
            told_of(second, 2)
            told_of(first, 2)
            second.send(joining("present"))  # another request of the same client
            told_of(second, 2)
        told_of(first, 1)
