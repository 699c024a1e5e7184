"""Invalid winds are rejected by REST and WebSocket with the path and the allowed values."""

from __future__ import annotations

import json
from typing import Any

import httpx
import numpy as np
import pytest
from galewood.constants import MOST_RECORDING_SAMPLES
from galewood.motion.wind.evaluation import PRESETS, Wind, parse_state
from galewood.motion.wind.recording import quantised
from galewood_server.stream import wire
from websockets.sync.client import connect

from tests.golden import GOLDEN_FOLDER
from tests.server.support.server_process import Server

NO_TREES = np.zeros((0, 4), np.float32)
CASES: list[dict[str, Any]] = json.loads((GOLDEN_FOLDER / "wind_models.json").read_text())["refused"]


def test_valid_winds_are_returned_in_their_shortest_form(server: Server) -> None:
    for wind in (Wind(), *PRESETS.values()):
        answer = httpx.post(f"{server.url}/api/winds/validate", json=wind.document())
        assert (answer.status_code, answer.json()) == (200, {"wind": wind.document()})


def longest_recording() -> Wind:
    """A recorded wind of the largest size."""
    values = np.random.default_rng(3).normal(size=(MOST_RECORDING_SAMPLES, 2))
    return Wind(model="recorded", recording=quantised(values, 0.1))


def test_the_longest_recording_is_accepted_and_sent_to_all_clients(server: Server) -> None:
    wind = longest_recording()
    answer = httpx.post(f"{server.url}/api/winds/validate", json=wind.document())
    assert (answer.status_code, answer.json()) == (200, {"wind": wind.document()})
    with connect(server.socket_url, max_size=None) as socket:
        socket.send(wire.encode_request(wire.Hello("test")))
        socket.recv(timeout=10)
        plan = wire.Forest("table", (), Wind().document(), 0.0, None, NO_TREES, share="recorded")
        socket.send(wire.encode_request(plan))
        socket.send(wire.encode_request(wire.WindChange(wind.document())))
        for _ in range(100):
            data = socket.recv(timeout=10)
            assert isinstance(data, bytes)
            reply = wire.decode_reply(data)
            if isinstance(reply, wire.WindState) and reply.state["wind"]["model"] == "recorded":
                break
        else:
            raise AssertionError("no WIND_STATE with the recording")
    assert parse_state(reply.state).wind == wind


def test_invalid_winds_are_problems_with_path_and_range(server: Server) -> None:
    for case in CASES:
        answer = httpx.post(f"{server.url}/api/winds/validate", content=json.dumps(case["document"]))
        problem = answer.json()
        assert answer.status_code == 422
        assert answer.headers["content-type"] == "application/problem+json"
        assert problem["code"] == "bad-wind"
        assert problem["hint"] == f"{case['path']}: {case['expected']}."
        assert problem.get("detail", "") != problem["hint"].removesuffix(".")


@pytest.mark.parametrize(
    "body", [b"", b"{", b"[" * 60_000, b'{"version": NaN}', b'{"version":1,"model":"cosine","seed":1e999}']
)
def test_malformed_bodies_are_rejected(server: Server, body: bytes) -> None:
    answer = httpx.post(f"{server.url}/api/winds/validate", content=body)
    assert (answer.status_code, answer.json()["code"]) == (422, "bad-wind")


def test_oversized_bodies_are_rejected(server: Server) -> None:
    answer = httpx.post(f"{server.url}/api/winds/validate", content=b" " * 100_000)
    assert (answer.status_code, answer.json()["code"]) == (413, "wind-too-large")


@pytest.mark.parametrize(
    "case", [c for c in CASES if isinstance(c["document"], dict)], ids=lambda c: c["path"]
)
def test_the_socket_rejects_winds_with_the_same_message(server: Server, case: dict[str, Any]) -> None:
    with connect(server.socket_url, max_size=None) as socket:
        socket.send(wire.encode_request(wire.Hello("test")))
        socket.recv(timeout=10)
        socket.send(wire.encode_request(wire.Forest("table", (), Wind().document(), 0.0, None, NO_TREES)))
        socket.send(wire.encode_request(wire.WindChange(case["document"])))
        data = socket.recv(timeout=10)
    assert isinstance(data, bytes)
    reply = wire.decode_reply(data)
    assert isinstance(reply, wire.Failure)
    assert reply.code == "bad-wind"
    assert reply.title.startswith(f"{case['path']}: {case['expected']}")
