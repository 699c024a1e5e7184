"""Frame history, client buffers and forests without a server."""

from __future__ import annotations

import asyncio
import gc
import weakref
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from galewood.motion.wind.evaluation import Wind, steady
from galewood.player.paper_search import PaperForest, lookup_arrays
from galewood.table.format import decode
from galewood_server.settings import Settings
from galewood_server.storage.stores import Stores
from galewood_server.storage.table_cache import TableCache
from galewood_server.stream import wire
from galewood_server.stream.client_buffer import ClientBuffer
from galewood_server.stream.forest import ForestClock, ForestStepper, stream_quantum
from galewood_server.stream.forests import Forests
from galewood_server.stream.frames import KEPT_TICKS, FrameHistory
from galewood_server.stream.latest_values import LatestValues
from galewood_server.stream.session_error import SessionError
from hypothesis import given, seed, settings
from hypothesis import strategies as st

from tests.golden import GOLDEN_FOLDER

POLE = (GOLDEN_FOLDER / "pole.safetensors").read_bytes()
Poses = npt.NDArray[np.int32]


def message_of(frame: bytes) -> bytes:
    """The payload of an unmasked WebSocket frame."""
    assert frame[0] == 0x82 and frame[1] < 128
    return frame[{126: 4, 127: 10}.get(frame[1], 2) :]


class Reader:
    """A client that accumulates frames and checks their base ticks."""

    def __init__(self) -> None:
        self.tick: int | None = None
        self.poses: list[Poses] = []
        self.keys = 0

    def take(self, frame: bytes) -> None:
        reply = wire.decode_reply(message_of(frame))
        assert isinstance(reply, wire.Frame)
        rows = [group.values for group in reply.groups]
        if reply.base is None:
            self.poses, self.keys = rows, self.keys + 1
        else:
            assert reply.base == self.tick
            self.poses = [a + b for a, b in zip(self.poses, rows, strict=True)]
        self.tick = reply.tick


@seed(11)
@given(st.lists(st.tuples(st.integers(1, 3), st.booleans(), st.booleans()), min_size=1, max_size=40))
@settings(max_examples=60, deadline=None)
def test_a_client_that_misses_frames_ends_in_the_same_state(steps: list[tuple[int, bool, bool]]) -> None:
    rng = np.random.default_rng(len(steps))
    history = FrameHistory([(3, 4, 1), (2, 2, 9)])
    truth = [np.zeros((3, 4), np.int32), np.zeros((2, 2), np.int32)]
    brisk, slow = Reader(), Reader()
    tick = 0
    for ahead, jump, read in steps:
        tick += ahead
        for rows in truth:
            rows += rng.integers(-200, 200, rows.shape, dtype=np.int32) * (400 if jump else 1)

        def write(out: Sequence[Poses]) -> None:
            for here, rows in zip(out, truth, strict=True):
                here[:] = rows

        history.add(tick, tick / 30, tick / 30, write)
        for reader in (brisk, slow) if read else (brisk,):
            frame = history.since(reader.tick)
            assert frame is not None
            reader.take(frame)
            assert reader.tick == tick and history.since(tick) is None
            for mine, rows in zip(reader.poses, truth, strict=True):
                np.testing.assert_array_equal(mine, rows)


def test_frames_are_encoded_once_and_late_clients_get_a_key_frame() -> None:
    history = FrameHistory([(1, 1, 1)])
    for tick in range(2 * KEPT_TICKS):
        history.add(tick, 0.0, 0.0, lambda out, tick=tick: out[0].fill(tick))
    newest = 2 * KEPT_TICKS - 1
    assert history.since(newest - 1) is history.since(newest - 1)
    for behind in range(1, 2 * KEPT_TICKS):
        frame = history.since(newest - behind)
        assert frame is not None
        reply = wire.decode_reply(message_of(frame))
        assert isinstance(reply, wire.Frame)
        assert reply.base == (newest - behind if behind < KEPT_TICKS else None)


class FakeSink:
    """A socket whose peer reads on demand."""

    def __init__(self) -> None:
        self.unsent_bytes = 0
        self.pushed: list[bytes] = []
        self.aborted = False

    def push(self, frame: bytes) -> None:
        self.pushed.append(frame)
        self.unsent_bytes += len(frame)

    def abort(self) -> None:
        self.aborted = True


def test_only_the_newest_frame_is_sent_after_a_delay() -> None:
    sink, latest, history = FakeSink(), LatestValues(), FrameHistory([(1, 1, 1)])
    client_buffer = ClientBuffer(sink, streams=True, stall_s=10.0)
    for tick in range(6):
        history.add(tick, 0.0, 0.0, lambda out, tick=tick: out[0].fill(tick))
        latest.post(wire.Clock(tick, 0.0, False))
        latest.post(wire.Clock(tick, 0.5, True))
        client_buffer.deliver(latest, history, tick / 30)
        assert len(sink.pushed) == 2
    sink.unsent_bytes = 0
    client_buffer.deliver(latest, history, 0.3)
    assert len(sink.pushed) == 4
    assert wire.decode_reply(message_of(sink.pushed[2])) == wire.Clock(5, 0.5, True)
    reader = Reader()
    reader.take(sink.pushed[1])
    reader.take(sink.pushed[3])
    assert (reader.tick, reader.keys, reader.poses[0][0, 0]) == (5, 1, 5)


def test_a_stalled_client_is_disconnected_but_not_a_slow_one() -> None:
    history = FrameHistory([(1, 1, 1)])
    history.add(0, 0.0, 0.0, lambda out: out[0].fill(0))
    stalled, slow = FakeSink(), FakeSink()
    boxes = [ClientBuffer(sink, streams=True, stall_s=2.0) for sink in (stalled, slow)]
    for tick in range(150):
        for box in boxes:
            box.deliver(LatestValues(), history, tick / 30)
        if tick % 30 == 29:
            slow.unsent_bytes -= 1
    assert stalled.aborted and not slow.aborted


def test_quantisation_error_is_bounded() -> None:
    table = decode(POLE)
    quantum = stream_quantum(table)
    rng = np.random.default_rng(4)
    unit = quantum * table.mode_scale.astype(np.float64)
    q = rng.uniform(-40, 40, (400, len(unit))) * unit
    off = np.rint(q / unit) * unit - q
    moved_m = np.linalg.norm(np.einsum("nik,tk->tni", table.node_basis, off), axis=2)
    assert quantum > 1 and moved_m.max() < 0.5e-3
    assert np.sqrt((moved_m**2).mean(axis=0)).max() < 0.25e-3


def test_forests_of_a_table_share_its_arrays() -> None:
    table = decode(POLE)
    one, other = PaperForest(table, 3), PaperForest(table, 4)
    shared = lookup_arrays(table)
    for forest in (one, other):
        assert forest._lookup is shared
    before = shared.poses.copy()
    for _ in range(5):
        one.advance(1 / 30, np.full(3, 4.0), np.zeros(3))
    np.testing.assert_array_equal(shared.poses, before)
    watch = weakref.ref(shared.poses)
    del one, other, forest, shared, table
    gc.collect()
    assert watch() is None


def plan(count: int, share: str | None = None, **changes: object) -> wire.Forest:
    rows = np.zeros((count, 4), np.float32)
    rows[:, 0], rows[:, 3] = np.arange(count), 1.0
    groups = (wire.Group(FileStoreWith.sha256, count),)
    fields = {"mode": "stream", "groups": groups, "wind": Wind().document(), "time_s": 0.0}
    return wire.Forest(**{**fields, "pose_easing": None, "trees": rows, "share": share, **changes})  # type: ignore[arg-type]


class FileStoreWith:
    sha256 = ""


async def until(holds: Callable[[], bool]) -> None:
    async with asyncio.timeout(60):
        while not holds():
            await asyncio.sleep(0.02)


@pytest.fixture
def forests(tmp_path: Path) -> Forests:
    stores = Stores(tmp_path)
    FileStoreWith.sha256 = stores.tables.put(POLE)
    limits = Settings(server_trees=100, shared_forests=2, shared_forest_idle_s=0.05)
    return Forests(limits, TableCache(stores), lambda table_sha256: None)


def test_the_papers_method_waits_for_its_records(tmp_path: Path) -> None:
    stores, known = Stores(tmp_path), dict[str, str]()
    table = stores.tables.put((GOLDEN_FOLDER / "pole-table.safetensors").read_bytes())
    records = stores.records.put((GOLDEN_FOLDER / "pole-records.safetensors").read_bytes())
    forests = Forests(Settings(), TableCache(stores), known.get)
    groups = (wire.Group(table, 2),)

    async def play() -> None:
        await forests.join(plan(2, groups=groups), steady(Wind()), FakeSink())
        with pytest.raises(SessionError, match="still being computed") as refused:
            await forests.join(plan(2, groups=groups, method="paper"), steady(Wind()), FakeSink())
        assert refused.value.failure.code == "no-records"
        known[table] = records
        await forests.join(plan(2, groups=groups, method="paper"), steady(Wind()), FakeSink())

    asyncio.run(play())


def test_clients_of_a_shared_forest_share_one_simulation(forests: Forests) -> None:
    async def play() -> None:
        sinks = [FakeSink() for _ in range(40)]
        subscriptions = await asyncio.gather(
            *(forests.join(plan(60, "a"), steady(Wind()), one) for one in sinks)
        )
        assert len({id(subscription.forest) for subscription in subscriptions}) == 1
        assert (forests.count, forests.tree_count) == (1, 60)
        for _ in range(20):
            await asyncio.sleep(0.02)
            for sink in sinks:
                sink.unsent_bytes = 0
        frames = {id(sink.pushed[-1]) for sink in sinks}
        assert len(frames) < 4  # clients at the same tick receive the same bytes
        for subscription in subscriptions:
            forests.leave(subscription)
        await until(lambda: forests.count == 0)

    asyncio.run(play())


def test_limits_of_trees_and_shared_forests(forests: Forests) -> None:
    async def play() -> None:
        first = await forests.join(plan(60), steady(Wind()), FakeSink())
        with pytest.raises(SessionError) as session_error:
            await forests.join(plan(60), steady(Wind()), FakeSink())
        assert (session_error.value.failure.code, session_error.value.close) == ("server-full", 1013)
        forests.leave(first)
        subscriptions = [await forests.join(plan(10, name), steady(Wind()), FakeSink()) for name in "ab"]
        with pytest.raises(SessionError) as session_error:
            await forests.join(plan(10, "c"), steady(Wind()), FakeSink())
        assert (session_error.value.failure.code, session_error.value.close) == ("too-many-forests", 1013)
        forests.leave(subscriptions[0])
        await forests.join(plan(10, "c"), steady(Wind()), FakeSink())

    asyncio.run(play())


def test_a_failing_forest_does_not_affect_others(forests: Forests, monkeypatch: pytest.MonkeyPatch) -> None:
    async def play() -> None:
        sick, well = FakeSink(), FakeSink()
        ill = await forests.join(plan(10), steady(Wind()), sick)
        await forests.join(plan(20), steady(Wind()), well)
        step = ForestStepper.step

        def fail(stepper: ForestStepper, *pulls: Any) -> Any:
            if stepper.shapes[0][0] == 10:
                raise ZeroDivisionError("on purpose")
            return step(stepper, *pulls)

        monkeypatch.setattr(ForestStepper, "step", fail)
        await until(lambda: sick.aborted)
        before = len(well.pushed)
        well.unsent_bytes = 0
        await until(lambda: len(well.pushed) > before)
        assert not well.aborted
        forests.leave(ill)

    asyncio.run(play())


def test_a_stepper_without_groups_is_allowed() -> None:
    clock = ForestClock(steady(Wind()), 0.0)
    stepper = ForestStepper([], plan(0, groups=(), trees=np.zeros((0, 4), np.float32)), clock)
    clock.tick()
    stepper.step()
    assert stepper.shapes == []
