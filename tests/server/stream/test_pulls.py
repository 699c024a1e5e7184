"""Pulls and gust fronts on the forest socket of a real server."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from galewood.constants import MOST_PULLS_OF_FOREST
from galewood.motion.wind.evaluation import Wind
from galewood.player import point_response
from galewood.table import decode
from galewood_server.stream import wire
from galewood_server.stream.forest_hands import ForestHands
from galewood_server.stream.pulls import GroupPulls

from tests.server.stream.test_forest_stream import POLE, SHA256, Client, forest, trees
from tests.server.support.server_process import FAKE_SERVER, Server

TABLE = decode(POLE)
VERTEX = int(np.argmax(TABLE.node_rest_m[TABLE.vertex_node, 1]))
STILL = Wind(mean_speed_m_s=0.0).document()
X, Z = (float(value) for value in trees(30)[4, :2])


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("pulls") / "data"
    table = data_dir / "tables" / SHA256[:2] / SHA256
    table.parent.mkdir(parents=True)
    table.write_bytes(POLE)
    server = Server(data_dir, FAKE_SERVER).start()
    yield server
    server.stop()


def pull(hand: int, target: tuple[float, float, float], x: float = X, z: float = Z) -> wire.Pull:
    return wire.Pull(hand, x, z, VERTEX, target)


def told(client: Client, holds: Callable[[wire.Pulls], bool], most: int = 900) -> wire.Pulls:
    """The first PULLS that fulfils a condition."""
    for _ in range(most):
        reply = client.receive()
        if isinstance(reply, wire.Pulls) and holds(reply):
            return reply
    raise AssertionError("did not happen")


def size(pulls: wire.Pulls) -> float:
    return float(np.linalg.norm(pulls.pulls[0].force)) if pulls.pulls else 0.0


def test_everyone_in_a_forest_is_told_of_a_pull_and_its_end(server: Server) -> None:
    with Client(server) as first, Client(server) as second, Client(server) as table:
        first.send(forest(share="pulled", wind=STILL))
        second.send(forest(share="pulled"))
        table.send(forest("table", share="pulled"))
        first.send(pull(7, (0.1, 0.0, 0.05)))
        seen = [told(one, lambda reply: size(reply) > 0) for one in (first, second, table)]
        for reply in seen:
            assert [one.pull for one in reply.pulls] == [pull(7, (0.1, 0.0, 0.05))]
        first.send(wire.Release(7))
        for one in (first, second, table):
            told(one, lambda reply: not reply.pulls)


def test_a_client_that_disconnects_lets_go(server: Server) -> None:
    with Client(server) as second:
        with Client(server) as first:
            first.send(forest(share="gone", wind=STILL))
            second.send(forest(share="gone"))
            first.send(pull(8, (0.0, 0.0, 0.1)))
            told(second, lambda reply: size(reply) > 0)
        told(second, lambda reply: not reply.pulls)


def test_the_force_is_limited_and_unknown_trees_stay(server: Server) -> None:
    """A target out of reach, a place without a tree, and a vertex that does not exist."""
    response = point_response(TABLE, VERTEX)
    with Client(server) as client:
        client.send(forest(wind=STILL))
        client.send(pull(1, (900.0, 0.0, 900.0)))
        told(client, lambda reply: size(reply) > 0)
        forces = [np.array(told(client, lambda reply: True).pulls[0].force) for _ in range(10)]
        for force in forces:
            assert np.linalg.norm(response.compliance @ force) <= 1.0001 * response.reach_m
        client.send(pull(1, (0.1, 0.0, 0.0), X + 0.5))
        told(client, lambda reply: len(reply.pulls) == 1 and size(reply) == 0)
        client.send(wire.Pull(1, X, Z, 10**6, (0.1, 0.0, 0.0)))
        told(client, lambda reply: reply.pulls[0].pull.vertex == 10**6 and size(reply) == 0)
        client.send(pull(1, (0.1, 0.0, 0.0)))
        told(client, lambda reply: size(reply) > 0)


def test_gust_fronts_reach_everyone_and_are_limited(server: Server) -> None:
    with Client(server) as first, Client(server) as second:
        first.send(forest(share="gust", wind=STILL))
        second.send(forest("table", share="gust"))
        for k in range(10):
            first.send(wire.Gust(float(k), -4.5))
        while True:
            reply = second.receive()
            if isinstance(reply, wire.WindState) and reply.state.get("fronts"):
                break
        assert len(reply.state["fronts"]) <= 3
        assert reply.state["fronts"][0]["x_m"] == 0.0


def test_a_forest_has_room_for_a_limited_number_of_hands() -> None:
    hands = ForestHands()
    clients = [object() for _ in range(MOST_PULLS_OF_FOREST + 1)]
    taken = [hands.pull(client, pull(k, (0.1, 0.0, 0.0))) for k, client in enumerate(clients)]
    assert taken == [True] * MOST_PULLS_OF_FOREST + [False]
    hands.release(clients[0])
    assert hands.pull(clients[-1], pull(99, (0.1, 0.0, 0.0)))
    assert len(hands.pulls) == MOST_PULLS_OF_FOREST


@pytest.mark.parametrize("method", ["modal", "paper"])
def test_a_released_tree_returns_without_a_jump(method: str) -> None:
    """Held, the point is where the hand is; released, it starts there, and comes to rest."""
    from galewood.motion.wind import WindField
    from galewood.player import WindDrivenTrees

    place = np.array([[0.0, 0.0, 0.4, 1.0], [9.0, 0.0, 0.0, 1.0]], np.float32)
    trees_of = WindDrivenTrees(TABLE, place, method)  # pyright: ignore[reportArgumentType]
    group, field = GroupPulls(TABLE, place, None), WindField(Wind(mean_speed_m_s=0.0))
    response = point_response(TABLE, VERTEX)
    target = (0.04 * float(TABLE.metadata["height_m"]), 0.0, 0.0)

    def at(step: int, held: bool) -> float:
        trees_of.step(field, step / 30, 1 / 30)
        group.step(trees_of, [pull(1, target, 0.0, 0.0)] if held else [], 1 / 30)
        assert not trees_of.q[1].any()
        return float(np.linalg.norm(response.point @ trees_of.q[0]))

    held_m = [at(k, True) for k in range(1, 31)][-1]
    assert held_m == pytest.approx(target[0], rel=0.1)
    assert at(31, False) == pytest.approx(held_m, rel=0.25)
    rest_m = [at(k, False) for k in range(32, 1800)][-60:]
    assert max(rest_m) < 0.1 * held_m
