"""Sessions of random messages, valid, extreme and broken ones: the server answers or says why it closes.

`GALEWOOD_FUZZ_SESSIONS` and `GALEWOOD_FUZZ_SEED` make other and longer ones, as `make test-distributed` does.
"""

from __future__ import annotations

import contextlib
import os
import random
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import httpx
import numpy as np
import pytest
from galewood_server.storage import Stores
from galewood_server.stream import wire
from websockets.exceptions import ConnectionClosed

from tests.server.stream.test_forest_stream import BREEZE, POLE, Client, forest
from tests.server.support.server_process import FAKE_SERVER, NO_CLUSTER, Server, shared_services

SESSIONS = int(os.environ.get("GALEWOOD_FUZZ_SESSIONS", "25"))
SEED = int(os.environ.get("GALEWOOD_FUZZ_SEED", "28"))
MESSAGES = 25
REASONED = {1002, 1003, 1007, 1008, 1009, 1013}
TRAVELLING = {**BREEZE, "model": "navier-stokes", "length_scale_m": 20}
EXTREMES = (0, -0.0, 1e-300, 1e9, -1e9, 1e308, float("nan"), float("inf"), 2**53, -1, 0.5, True, None, "1")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("fuzz") / "data"
    data_dir.mkdir()
    Stores(data_dir, shared_services(data_dir).get("GALEWOOD_STORE_URL")).tables.put(POLE)
    limits = {"GALEWOOD_READS_PER_MINUTE": "0", "GALEWOOD_ADDRESS_TREES_PER_S": "1e6", **NO_CLUSTER}
    server = Server(data_dir, FAKE_SERVER, limits).start()
    yield server
    server.stop()


class Dice:
    """Random requests from a seed."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def number(self) -> Any:
        if self.random.random() < 0.02:
            return self.random.choice(EXTREMES)
        return self.random.uniform(-1, 1) * 10 ** self.random.uniform(-3, 3)

    def wind(self) -> dict[str, Any]:
        document = dict(self.random.choice((BREEZE, TRAVELLING, {**TRAVELLING, "model": "perlin"})))
        if self.random.random() < 0.03:
            document[self.random.choice(list(document))] = self.number()
        return document

    def state(self) -> dict[str, Any]:
        """What a request for a forest may hold: a wind, or one that is changing."""
        document = self.wind()
        if self.random.random() < 0.5:
            travel = self.random.choice((0, 310.0, 1e9, -1e9))
            return {"before": BREEZE, "wind": document, "since_s": 0, "travel": travel, "next": TRAVELLING}
        return document

    def forest(self) -> wire.Forest:
        count, share = self.random.randint(2, 40), self.random.choice((None, None, "a", "b"))
        asked = forest(self.random.choice(("stream", "stream", "table")), count, share=share)
        rows = asked.trees.copy()
        if len(rows) and self.random.random() < 0.05:
            value = self.random.choice((0, 1e6, -1e6, 1e-3, 101, float("nan"), float("inf")))
            rows[self.random.randrange(len(rows)), self.random.randrange(4)] = np.float32(value)
        return replace(
            asked,
            trees=rows,
            wind=self.state(),
            time_s=self.random.choice((0.0, 5.0, 1e9, -1e9)),
            method="paper" if self.random.random() < 0.03 else "modal",
            replant=self.random.random() < 0.3,
        )

    def request(self) -> wire.Request:
        x, z, hand = self.number(), self.number(), self.random.randint(0, 3)
        made: list[Callable[[], wire.Request]] = [
            self.forest,
            lambda: wire.WindChange(self.wind()),
            lambda: wire.Pause(self.random.random() < 0.5),
            lambda: wire.Pull(hand, x, z, self.random.randint(0, 10**6), (x, z, self.number())),
            lambda: wire.Release(hand),
            lambda: wire.Gust(x, z),
            wire.Resync,
            lambda: wire.Ping(self.number()),
        ]
        return self.random.choice(made)()

    def message(self) -> bytes:
        """An encoded request, which is damaged now and then."""
        try:
            data = bytearray(wire.encode_request(self.request()))
        except (TypeError, ValueError, OverflowError):  # a number that cannot even be encoded
            data = bytearray(self.random.randbytes(20))
        for _ in range(self.random.choice((0,) * 60 + (1, 3))):
            data[self.random.randrange(len(data))] ^= 1 << self.random.randrange(8)
        return bytes(data[: self.random.randrange(len(data))] if self.random.random() < 0.005 else data)


def play(server: Server, seed: int) -> int | None:
    """One session; its close code, or None if the server answered to the end."""
    dice, client = Dice(seed), Client(server)
    with client, contextlib.suppress(ConnectionClosed):
        client.send(forest(share=dice.random.choice((None, "a", "b"))))
        for _ in range(MESSAGES):
            client.socket.send(dice.message())
        client.send(wire.Ping(4711.0))
        while True:
            reply = client.receive()
            if isinstance(reply, wire.Pong) and reply.t == 4711.0:
                return None
    closed = client.socket.protocol.close_rcvd
    assert closed is not None, "the connection ended without a close frame"
    return int(closed.code)


def test_random_sessions_end_with_an_answer_or_a_reason(server: Server) -> None:
    print(f"seed {SEED}, {SESSIONS} sessions")
    codes = [play(server, 1000 * SEED + k) for k in range(SESSIONS)]
    print({code: codes.count(code) for code in set(codes)})
    assert set(codes) <= {None, *REASONED}
    assert len(set(codes)) > 1  # some end early, some are answered
    assert "Traceback" not in server.log() and "a forest failed" not in server.log()
    with Client(server) as client:  # and others do not notice
        client.send(forest())
        frames = client.frames()
        assert [next(frames)[0].key for _ in range(3)] == [True, False, False]
    assert httpx.get(f"{server.url}/api/health").status_code == 200
