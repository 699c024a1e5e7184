"""Forest requests are weighed in trees, and nothing slow happens in the tick that all forests share."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from galewood.motion.wind import field as wind_field
from galewood.motion.wind.evaluation import Wind, steady
from galewood.motion.wind.models.navier_stokes import Eddies
from galewood_server.settings import Settings
from galewood_server.storage.stores import Stores
from galewood_server.storage.table_cache import TableCache
from galewood_server.stream import tree_budget as budget_module
from galewood_server.stream import wire
from galewood_server.stream.forests import Forests
from galewood_server.stream.session_error import SessionError
from galewood_server.stream.tree_budget import BURST_S, LONGEST_WAIT_S, WorkRates, work_of
from websockets.exceptions import ConnectionClosed

from tests.server.stream.test_forest_stream import POLE, SHA256, Client, forest, trees
from tests.server.stream.test_frames import FakeSink, FileStoreWith, plan, until
from tests.server.support.server_process import Server

A, B = "192.0.2.1", "192.0.2.2"


def forests_with(folder: Path, **limits: Any) -> Forests:
    stores = Stores(folder)
    FileStoreWith.sha256 = stores.tables.put(POLE)
    return Forests(Settings(**limits), TableCache(stores), lambda table_sha256: None)


def codes(results: list[Any]) -> list[str]:
    return sorted(one.failure.code for one in results if isinstance(one, SessionError))


def test_forests_that_are_being_created_count(tmp_path: Path) -> None:
    forests = forests_with(tmp_path, server_trees=100)

    async def play() -> None:
        asked = (forests.join(plan(60), steady(Wind()), FakeSink(), f"192.0.2.{k}") for k in range(4))
        results = await asyncio.gather(*asked, return_exceptions=True)
        assert codes(results) == ["server-full"] * 3 and forests.tree_count == 60

    asyncio.run(play())


def test_one_address_leaves_room_for_others(tmp_path: Path) -> None:
    forests = forests_with(tmp_path, server_trees=200, address_trees=100)

    async def play() -> None:
        first = await forests.join(plan(60), steady(Wind()), FakeSink(), A)
        with pytest.raises(SessionError) as refused:
            await forests.join(plan(60), steady(Wind()), FakeSink(), A)
        assert (refused.value.failure.code, refused.value.close) == ("address-full", 1013)
        await forests.join(plan(60), steady(Wind()), FakeSink(), B)
        forests.leave(first)
        shared = await forests.join(plan(100, "s"), steady(Wind()), FakeSink(), A)
        # who joins a forest adds no trees to it
        joined = await forests.join(plan(100, "s"), steady(Wind()), FakeSink(), B)
        assert joined.forest is shared.forest

    asyncio.run(play())


def test_a_forest_that_cannot_be_created_gives_its_trees_back(tmp_path: Path) -> None:
    forests = forests_with(tmp_path, server_trees=100)
    missing = (wire.Group("0" * 64, 60),)

    async def play() -> None:
        with pytest.raises(SessionError, match="missing"):
            await forests.join(plan(60, groups=missing), steady(Wind()), FakeSink(), A)
        await forests.join(plan(60, "s"), steady(Wind()), FakeSink(), A)
        with pytest.raises(SessionError, match="missing"):
            await forests.join(plan(90, "s", replant=True, groups=(wire.Group("0" * 64, 90),)),
                               steady(Wind()), FakeSink(), A)  # fmt: skip
        with pytest.raises(SessionError, match="limit"):  # the 60 are still there
            await forests.join(plan(60), steady(Wind()), FakeSink(), B)
        await forests.join(plan(100, "s", replant=True), steady(Wind()), FakeSink(), A)
        assert forests.tree_count == 100

    asyncio.run(play())


def test_requests_cost_what_they_let_the_server_do() -> None:
    large, small = forest(count=2000), forest(count=10)
    assert work_of(large) - work_of(small) == 1990
    assert work_of(forest("table")) > work_of(small)


def test_work_beyond_the_rate_waits_or_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s, waited_s = 1000.0, list[float]()

    async def sleep(seconds: float) -> None:
        waited_s.append(seconds)

    monkeypatch.setattr(budget_module.time, "monotonic", lambda: now_s)
    monkeypatch.setattr(budget_module.asyncio, "sleep", sleep)
    rates = WorkRates(100.0)

    async def play() -> None:
        nonlocal now_s
        await rates.take(A, int(BURST_S * 100) + 200)  # one request alone is never refused
        assert not waited_s
        await rates.take(A, 200)
        assert waited_s == [2.0]
        with pytest.raises(SessionError) as refused:
            await rates.take(A, 1)
        assert (refused.value.failure.code, refused.value.close) == ("too-much-work", 1008)
        await rates.take(B, 1)
        assert waited_s == [2.0]
        now_s += 4.0 - LONGEST_WAIT_S
        await rates.take(A, 1)
        assert waited_s == [2.0, LONGEST_WAIT_S]

    asyncio.run(play())


def test_addresses_that_ask_for_nothing_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = 1000.0
    monkeypatch.setattr(budget_module.time, "monotonic", lambda: now_s)
    monkeypatch.setattr(budget_module, "MOST_ADDRESSES", 10)
    rates = WorkRates(100.0)

    async def play() -> None:
        nonlocal now_s
        for k in range(50):
            await rates.take(f"192.0.2.{k}", 100)
            now_s += 0.5
        assert len(rates._left) <= 10

    asyncio.run(play())


def test_winds_are_prepared_outside_the_tick(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither gust fields nor the eddies of a wind that has blown for long are computed by a step worker."""
    forests = forests_with(tmp_path)
    created, stepped = list[str](), list[str]()
    gusts_of, step = wind_field.gusts_of, Eddies.step

    def noted_gusts(wind: Wind) -> Any:
        created.append(threading.current_thread().name)
        return gusts_of(wind)

    def noted_step(eddies: Eddies) -> None:
        stepped.append(threading.current_thread().name)
        step(eddies)

    monkeypatch.setattr(wind_field, "gusts_of", noted_gusts)
    monkeypatch.setattr(Eddies, "step", noted_step)
    far = replace(steady(Wind(model="navier-stokes", seed=5)), travel=310.0)

    async def play() -> None:
        sink = FakeSink()
        live = (await forests.join(plan(3), far, sink, A)).forest
        for model in ("spectral", "perlin", "cosine", "navier-stokes"):
            wind = Wind(model=model, seed=7)
            assert live.lacks(wind)
            await forests.change_wind(live, wind, A)
            tick = live._clock.ticks
            await until(lambda tick=tick: live._clock.ticks > tick + 25)  # longer than a transition
            sink.unsent_bytes = 0
            assert not live.lacks(wind)

    asyncio.run(play())
    # S = 310 is step 27 of an epoch and 155 of the one before; computed for the first wind and the last one
    in_ticks = [name for name in stepped if name.startswith("stepper")]
    assert len(created) >= 5 and not [name for name in created if name.startswith("stepper")]
    assert len(stepped) > 200 and len(in_ticks) < 20


def test_a_flood_of_forests_ends_with_a_reason(start_server: Callable[..., Server], tmp_path: Path) -> None:
    table = tmp_path / "data" / "tables" / SHA256[:2] / SHA256
    table.parent.mkdir(parents=True)
    table.write_bytes(POLE)
    server = start_server(GALEWOOD_ADDRESS_TREES="1000", GALEWOOD_ADDRESS_TREES_PER_S="300")
    large = forest(count=900)
    with Client(server) as client:
        for _ in range(2):  # the new forest takes the place of the old one, and the next waits below 3 s
            client.send(forest(count=600))
            next(client.frames())
        with Client(server) as other:
            other.send(replace(large, trees=trees(900, 2)))
            failure, close, reason = other.session_error()
            assert (failure.code, close) == ("address-full", 1013) and "1000 streamed trees" in reason
        with suppress(ConnectionClosed):  # the server may end the connection before all are sent
            for _ in range(20):
                client.send(large)
        failure, close, _ = client.session_error()
        assert (failure.code, close) == ("too-much-work", 1008) and failure.hint
