"""Shared forests that are too large for the server: their clients play them, in one wind under one clock."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.motion.wind.evaluation import Wind, steady
from galewood.motion.wind.field import WindField
from galewood.motion.wind.transition import parse_state
from galewood_server.settings import Settings
from galewood_server.storage.stores import Stores
from galewood_server.storage.table_cache import TableCache
from galewood_server.stream import wire
from galewood_server.stream.forests import Forests
from galewood_server.stream.session_error import SessionError
from websockets.exceptions import ConnectionClosed

from tests.server.stream.test_forest_stream import POLE, SHA256, Client, forest, trees
from tests.server.stream.test_frames import FakeSink, FileStoreWith, message_of, plan, until
from tests.server.stream.test_pulls import pull, told
from tests.server.stream.test_shared_forest import frames_until, joining
from tests.server.support.server_process import FAKE_SERVER, Server

LARGEST = 50
ABOUT = {"planting": "trees=100000&forest=7"}
STEADY = Wind(mean_speed_m_s=6.0, direction_deg=0.0, gustiness=0.0)
"""Without gusts, so that the one of a front is seen."""


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("played") / "data"
    table = data_dir / "tables" / SHA256[:2] / SHA256
    table.parent.mkdir(parents=True)
    table.write_bytes(POLE)
    limits = {"GALEWOOD_FOREST_TREES": str(LARGEST), "GALEWOOD_ADDRESS_TREES": str(LARGEST)}
    limits |= {"GALEWOOD_TRUSTED_PROXIES": "127.0.0.1"}
    server = Server(data_dir, FAKE_SERVER, limits).start()
    yield server
    server.stop()


def large(share: str, count: int = 100_000, **changes: Any) -> wire.Forest:
    """A forest as a page asks for it: its number of trees and their description, but not their places."""
    return forest("table", count, **{"share": share, "about": ABOUT, "have": {SHA256: len(POLE)}, **changes})


def first_of(client: Client, holds: Callable[[wire.Reply], bool], most: int = 900) -> Any:
    for _ in range(most):
        reply = client.receive()
        if holds(reply):
            return reply
    raise AssertionError("did not happen")


def told_clock(client: Client, time_s: float) -> wire.Clock:
    """The first clock from a time on."""
    return first_of(client, lambda reply: isinstance(reply, wire.Clock) and reply.time_s >= time_s)


def same_clock(first: Client, second: Client, time_s: float) -> wire.Clock:
    """A clock from a time on, as both are told it."""
    mine, theirs = told_clock(first, time_s), told_clock(second, time_s)
    while mine.time_s != theirs.time_s:
        if mine.time_s < theirs.time_s:
            mine = told_clock(first, theirs.time_s)
        else:
            theirs = told_clock(second, mine.time_s)
    assert mine == theirs
    return mine


def told_wind(client: Client, holds: Callable[[dict[str, Any]], Any]) -> dict[str, Any]:
    reply = first_of(client, lambda reply: isinstance(reply, wire.WindState) and holds(dict(reply.state)))
    return dict(reply.state)


def arrivals_s(state: dict[str, Any], clock: wire.Clock, places: np.ndarray[Any, Any]) -> list[float]:
    """When a gust front reaches each place in a steady wind, on the server's clock, as clients compute it."""
    field, x_m, z_m = WindField(parse_state(state)), places[:, 0].copy(), places[:, 1].copy()
    out_x, out_z = np.zeros(len(places)), np.zeros(len(places))
    found = np.full(len(places), np.nan)
    for time_s in np.arange(clock.time_s, clock.time_s + 60.0, 0.05):
        field.velocity(x_m, z_m, float(time_s), out_x, out_z)
        feels = (np.hypot(out_x, out_z) > 1.1 * STEADY.mean_speed_m_s) & np.isnan(found)
        found[feels] = time_s - clock.time_s + clock.made_s
    return found.tolist()


def test_a_gust_reaches_the_same_tree_at_the_same_time_for_everyone(server: Server) -> None:
    places = trees(80, seed=3).astype(np.float64)
    with Client(server) as first, Client(server) as late:
        request = large("meadow", wind=STEADY.document(), time_s=7.0)
        assert len(wire.encode_request(request)) < 1000
        first.send(request)
        told_clock(first, 9.0)
        late.send(joining("meadow", mode="table", time_s=500.0))  # other trees, other wind and another time
        shared = first_of(late, lambda reply: isinstance(reply, wire.Shared))
        assert (shared.groups, shared.about, len(shared.trees)) == (request.groups, ABOUT, 0)
        told_clock(late, 9.0)
        late.send(wire.Gust(-90.0, 10.0))
        states = [told_wind(one, lambda state: state.get("fronts")) for one in (first, late)]
        clock = same_clock(first, late, states[0]["fronts"][0]["since_s"])
        mine, theirs = (arrivals_s(state, clock, places) for state in states)
        np.testing.assert_array_equal(mine, theirs)
        assert np.isfinite(mine).sum() > 10 and np.nanmax(mine) - np.nanmin(mine) > 1.0
        late.send(wire.WindChange(Wind(9.0, 40.0, 0.5).document()))
        changed = [told_wind(one, lambda s: s["wind"]["mean_speed_m_s"] == 9.0) for one in (first, late)]
        assert changed[0] == changed[1]


def test_whoever_asks_for_a_stream_is_told_who_plays_the_forest(server: Server) -> None:
    with Client(server) as first:
        first.send(large("moor"))
        told_clock(first, 0.0)
        own, none = forest(count=30, share="moor"), joining("moor")
        for request in (own, none, forest(count=LARGEST + 1), forest(count=LARGEST + 1, share="new")):
            with Client(server) as other:
                other.send(request)
                failure, close, reason = other.session_error()
                assert (failure.code, close) == ("too-many-trees", 1008)
                assert "played by the browsers" in reason and 'mode "table"' in failure.hint
                count = "100,000" if request.share == "moor" else f"{LARGEST + 1}"
                assert f"{count} trees" in reason and f"up to {LARGEST}" in reason
        told_clock(first, 1.0)


def test_a_streamed_forest_becomes_one_that_its_clients_play_and_back(server: Server) -> None:

    def visitor() -> Client:
        return Client(server, additional_headers={"X-Forwarded-For": "192.0.2.7"})

    with visitor() as table, visitor() as stream:
        stream.send(forest(count=LARGEST, share="grows"))
        frames_until(stream, lambda frame: frame.tick >= 5)
        table.send(large("grows", replant=True))
        with pytest.raises(ConnectionClosed):
            while True:
                stream.receive()
        with visitor() as back, visitor() as private:
            private.send(forest(count=LARGEST))  # this address has no other trees on the server now
            frames_until(private, lambda frame: frame.tick >= 2)
            back.send(forest(count=LARGEST, share="grows"))
            assert back.session_error()[0].code == "too-many-trees"
        told_clock(table, 6.0)
        with Client(server) as other:
            other.send(forest(count=9, share="grows", replant=True))
            frames_until(other, lambda frame: frame.tick >= 5)
            shared = first_of(table, lambda reply: isinstance(reply, wire.Shared) and len(reply.trees) > 0)
            assert len(shared.trees) == 9


def test_a_client_goes_on_by_itself_over_the_same_socket(server: Server) -> None:
    """It streams, and asks for more trees than can be streamed: that ends its stream, not its connection."""
    with Client(server) as client:
        client.send(forest(count=9, share="alone"))
        frames_until(client, lambda frame: frame.tick >= 2)
        client.send(large("alone", replant=True))
        first_of(client, lambda reply: isinstance(reply, wire.Shared) and reply.about == ABOUT)
        told_clock(client, 6.0)
        client.send(wire.Ping(3.0))
        first_of(client, lambda reply: isinstance(reply, wire.Pong))


def test_hands_and_pauses_are_passed_on(server: Server) -> None:
    with Client(server) as first, Client(server) as second:
        for client in (first, second):
            client.send(large("hands"))
        first.send(pull(7, (0.1, 0.0, 0.05), x=740.5, z=-310.25))
        for client in (first, second):
            seen = told(client, lambda reply: len(reply.pulls) == 1).pulls[0]
            assert seen == wire.Pulling(pull(7, (0.1, 0.0, 0.05), x=740.5, z=-310.25), (0.0, 0.0, 0.0))
        first.send(wire.Release(7))
        told(second, lambda reply: not reply.pulls)
        second.send(wire.Pause(True))
        first_of(first, lambda reply: isinstance(reply, wire.Clock) and reply.paused)


def test_trees_without_places_are_streamed_once_a_client_brings_those_that_are_described(
    server: Server,
) -> None:
    with Client(server) as table, Client(server) as other, Client(server) as same:
        table.send(large("places", count=30))
        told_clock(table, 0.0)
        other.send(forest(count=30, share="places", about={"planting": "trees=30&forest=8"}))
        first_of(other, lambda reply: isinstance(reply, wire.Shared) and reply.about == ABOUT)
        placed = trees(30, seed=5)
        same.send(forest(count=30, share="places", about=ABOUT, trees=placed))
        frames_until(same, lambda frame: frame.tick >= 2)
        for client in (table, other):
            shared = first_of(client, lambda reply: isinstance(reply, wire.Shared) and len(reply.trees) > 0)
            np.testing.assert_array_equal(shared.trees, placed)


@pytest.fixture
def forests(tmp_path: Path) -> Forests:
    stores = Stores(tmp_path)
    FileStoreWith.sha256 = stores.tables.put(POLE)
    limits = Settings(forest_trees=LARGEST, server_trees=LARGEST, address_trees=LARGEST)
    return Forests(limits, TableCache(stores), lambda table_sha256: None)


def test_they_cost_the_server_no_trees(forests: Forests, monkeypatch: pytest.MonkeyPatch) -> None:
    """Many of them beside a streamed one that uses the whole budget; nothing is stepped, no gust made."""

    def stepped(*_: Any) -> None:
        raise AssertionError("was stepped")

    async def play() -> None:
        wind, sinks = steady(Wind(model="navier-stokes", seed=5)), [FakeSink() for _ in range(20)]
        with monkeypatch.context() as patch:
            patch.setattr("galewood_server.stream.forest.ForestStepper.__init__", stepped)
            patch.setattr("galewood.motion.wind.field.gusts_of", stepped)
            # of a client that sends the places nevertheless, the server keeps none
            request = plan(10_000, mode="table")
            joined = [
                await forests.join(replace(request, share=f"f{k}"), wind, sink, "192.0.2.1")
                for k, sink in enumerate(sinks)
            ]
            assert [len(one.forest.plan.trees) for one in joined] == [0] * len(sinks)
            await forests.change_wind(joined[0].forest, Wind(model="spectral", seed=9), "192.0.2.1")
            await until(lambda: joined[0].forest._clock.ticks > 30)
        assert (forests.count, forests.tree_count, forests._budget.count) == (20, 0, 0)
        await forests.join(plan(LARGEST), steady(Wind()), FakeSink(), "192.0.2.1")
        assert sum(map(len, sinks[1].pushed)) < 3000
        told = [wire.decode_reply(message_of(frame)) for frame in sinks[1].pushed]
        assert {type(reply) for reply in told} <= {wire.Shared, wire.WindState, wire.Clock, wire.Presence}

    asyncio.run(play())


def test_new_trees_are_known_by_their_description_if_not_by_their_places(forests: Forests) -> None:
    async def play() -> None:
        request = plan(1000, "a", mode="table", trees=np.zeros((0, 4), np.float32), about=ABOUT)
        joined = await forests.join(request, steady(Wind()), FakeSink())
        for about, replanted in ((ABOUT, False), ({"planting": "trees=1000&forest=8"}, True)):
            before = joined.forest.plan
            changes: dict[str, Any] = {"about": about, "replant": True, "time_s": 9.0}
            await forests.join(replace(request, **changes), steady(Wind()), FakeSink())
            assert (joined.forest.plan is not before) == replanted
        with pytest.raises(SessionError, match="played by the browsers"):
            await forests.admit(plan(LARGEST + 1), "192.0.2.1")
        await forests.admit(plan(LARGEST + 1, mode="table"), "192.0.2.1")

    asyncio.run(play())
