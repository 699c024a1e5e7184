"""Shared forests of several servers with one database: any server leads to the one that holds a forest."""

from __future__ import annotations

import signal
import socket
import threading
import time
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from galewood.motion.wind.evaluation import Wind
from galewood.motion.wind.transition import parse_state
from galewood_server.peers import forest_leases
from galewood_server.peers.forest_leases import claim_forest, release_forest, renew_forest
from galewood_server.settings import Settings
from galewood_server.storage.database import Sessions, migrate, open_database
from galewood_server.storage.models import SharedForest, utc_now
from galewood_server.stream import wire
from sqlalchemy import select, update
from websockets.exceptions import ConnectionClosed

from tests.server.stream.test_forest_stream import POLE, SHA256, Client, forest
from tests.server.stream.test_shared_forest import frames_until, joining
from tests.server.support.server_process import FAKE_SERVER, NO_CLUSTER, Server, shared_services, wait_until

A, B = "http://a:1", "http://b:1"
STALL_S = 1.5
STORM = Wind(12.0, 300.0, 0.8, model="perlin", length_scale_m=15.0)


@pytest.fixture
def sessions(tmp_path: Path) -> Sessions:
    url = shared_services(tmp_path).get("GALEWOOD_DATABASE_URL", f"sqlite:///{tmp_path / 'leases.sqlite'}")
    migrate(url)
    return open_database(url)


def test_a_forest_is_claimed_once_and_returned_or_lost(sessions: Sessions) -> None:
    with sessions() as session:
        mine = claim_forest(session, "grove", A, 60)
        assert mine.mine and mine.server_url == A
        seen = claim_forest(session, "grove", B, 60)
        assert (seen.server_url, seen.token, seen.mine) == (A, mine.token, False)
        assert renew_forest(session, "grove", mine.token, 60)
        taken = claim_forest(session, "grove", B, 60, lost=seen.token)
        assert taken.mine and taken.server_url == B
        assert not renew_forest(session, "grove", mine.token, 60)
        release_forest(session, "grove", mine.token)  # too late: it is not A's any more
        late = claim_forest(session, "grove", A, 60, lost=mine.token)
        assert not late.mine and late.token == taken.token, "only the lease that was seen may be taken"
        release_forest(session, "grove", taken.token)
        assert claim_forest(session, "grove", A, 60).mine


def test_an_expired_lease_and_that_of_a_former_process_are_taken(sessions: Sessions) -> None:
    with sessions() as session:
        claim_forest(session, "grove", A, 60)
        assert claim_forest(session, "grove", A, 60).mine, "the former process of this address is gone"
        session.execute(update(SharedForest).values(lease_until=utc_now() - timedelta(seconds=1)))
        session.commit()
        assert claim_forest(session, "grove", B, 60).mine


def test_of_many_servers_that_claim_at_once_one_succeeds(sessions: Sessions) -> None:
    start, leases = threading.Barrier(8), dict[str, forest_leases.Lease]()

    def claim(url: str) -> None:
        with sessions() as session:
            start.wait()
            leases[url] = claim_forest(session, "grove", url, 60)

    for lost in (False, True):  # a free forest, then one whose server has died
        threads = [threading.Thread(target=claim, args=(f"http://server-{n}-{lost:d}:1",)) for n in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        (winner,) = [lease for lease in leases.values() if lease.mine]
        assert {lease.token for lease in leases.values()} == {winner.token} and len(leases) == 8
        with sessions() as session:
            session.execute(update(SharedForest).values(lease_until=utc_now() - timedelta(seconds=1)))
            session.commit()
        leases.clear()


@pytest.mark.parametrize("url", ["server-a:8000", "http://a/path", "ftp://a", "http://a:8000/"])
def test_the_address_of_a_peer_is_an_origin(url: str) -> None:
    with pytest.raises(ValueError, match="address of this server"):
        Settings(peer_url=url)


class Peers:
    """Two servers with separate data folders that share a database."""

    def __init__(self, folder: Path) -> None:
        services = shared_services(folder)
        database = services.get("GALEWOOD_DATABASE_URL", f"sqlite:///{folder / 'shared.sqlite'}")
        migrate(database)
        self.sessions = open_database(database)
        shared = {
            "GALEWOOD_DATABASE_URL": database,
            "GALEWOOD_LEASE_S": "2",
            "GALEWOOD_TRUSTED_PROXIES": "127.0.0.1",
            "GALEWOOD_SHARED_FOREST_IDLE_S": "1",
        }
        shared |= {"GALEWOOD_SOCKET_STALL_S": str(STALL_S), **NO_CLUSTER}
        shared |= {"GALEWOOD_STORE_URL": f"file://{folder / 'store'}"}
        table = folder / "store" / "tables" / SHA256[:2] / SHA256
        table.parent.mkdir(parents=True)
        table.write_bytes(POLE)
        self.servers: list[Server] = []
        for name in ("one", "two"):
            data_dir = folder / name / "data"
            data_dir.mkdir(parents=True)
            server = Server(data_dir, FAKE_SERVER, shared)
            server.environment = {**shared, "GALEWOOD_PEER_URL": server.url}
            self.servers.append(server.start())

    def holder(self, share: str) -> str | None:
        """URL of the server that holds a forest, by the database."""
        with self.sessions() as session:
            statement = select(SharedForest.server_url).where(SharedForest.share == share)
            return session.scalar(statement)


@pytest.fixture
def peers(tmp_path: Path) -> Iterator[Peers]:
    peers = Peers(tmp_path)
    yield peers
    for server in peers.servers:
        server.stop()
        log = server.log()
        assert "Traceback" not in log, log


def watching(server: Server, share: str, **options: Any) -> Client:
    """A client that reads all the time, also while the test waits for a server to start."""
    options.setdefault("max_queue", None)
    return Client(server, query=f"?share={share}", **options)


def test_a_forest_is_reached_through_any_server(peers: Peers) -> None:
    one, two = peers.servers
    with watching(one, "grove") as first, watching(two, "grove") as second:
        first.send(forest(share="grove"))
        frames_until(first, lambda frame: frame.tick >= 10)
        assert peers.holder("grove") == one.url
        second.send(joining("grove"))
        mine = frames_until(second, lambda frame: frame.tick >= 40)
        assert mine[0][0].key and mine[0][0].tick >= 10, "the forest that is running, not another"
        second.send(wire.WindChange(STORM.document()))
        frames_until(first, lambda frame: first.state is not None and first.state.wind == STORM)
        frames_until(second, lambda frame: second.state is not None and second.state.wind == STORM)
        assert first.state == second.state
        second.send(wire.Ping(5.0))
        while not isinstance(second.receive(), wire.Pong):
            pass
    wait_until(lambda: peers.holder("grove") is None)  # the forest has ended, and with it the lease


def test_its_clients_come_back_by_another_server_when_one_is_killed_stopped_or_frozen(peers: Peers) -> None:
    one, two = peers.servers
    with watching(one, "grove") as first:
        first.send(forest(share="grove"))
        frames_until(first, lambda frame: frame.tick >= 3)
        with watching(two, "grove") as relayed:
            relayed.send(joining("grove"))
            frames_until(relayed, lambda frame: frame.tick >= 3)
            one.kill()
            with pytest.raises(ConnectionClosed) as closed:
                while True:
                    relayed.receive()
            assert closed.value.rcvd and closed.value.rcvd.code == 1012
    with watching(two, "grove") as client:  # at once, long before the lease expires
        client.send(forest(share="grove", wind=STORM.document()))
        frames_until(client, lambda frame: frame.tick >= 3)
        assert peers.holder("grove") == two.url
        assert client.state and client.state.wind == STORM, "clients bring the wind that they have seen"
        one.start()
        with watching(one, "grove") as relayed:
            relayed.send(joining("grove"))
            frames_until(relayed, lambda frame: frame.tick >= 6)
        two.stop()  # gracefully, which gives the leases back
    assert peers.holder("grove") is None
    with watching(one, "grove") as client:
        client.send(forest(share="grove"))
        frames_until(client, lambda frame: frame.tick >= 3)
        two.start()
        assert one.process
        one.process.send_signal(signal.SIGSTOP)  # it accepts connections, but does not answer
        with watching(two, "grove") as moved:
            moved.send(forest(share="grove"))
            frames_until(moved, lambda frame: frame.tick >= 3)
            assert peers.holder("grove") == two.url
            one.process.send_signal(signal.SIGCONT)
            with pytest.raises(ConnectionClosed):  # it finds that the forest is not its own any more
                while True:
                    client.receive()
            frames_until(moved, lambda frame: frame.tick >= 90)
    assert two.log().count("does not respond") >= 1


def test_a_server_does_not_start_a_second_forest_of_the_same_name(peers: Peers) -> None:
    one, two = peers.servers
    with watching(one, "grove") as first, Client(two) as second:
        first.send(forest(share="grove"))
        frames_until(first, lambda frame: frame.tick >= 3)
        second.send(forest(share="grove"))
        failure, code, _ = second.session_error()
        assert (failure.code, code) == ("elsewhere", 1008) and "?share=" in failure.hint
        headers = {"Galewood-Relayed": "1"}  # as from a server that knows less than this one
        with pytest.raises(ConnectionClosed) as closed:
            watching(two, "grove", additional_headers=headers)
        assert closed.value.rcvd and closed.value.rcvd.code == 1012
        with Client(two, query="?share=" + "x" * 70) as odd:
            odd.send(forest())
            frames_until(odd, lambda frame: frame.tick >= 3)


def test_a_forest_that_its_clients_play_is_reached_through_any_server(peers: Peers) -> None:
    one, two = peers.servers
    request = forest("table", 100_000, share="wide", about={"planting": "trees=100000"})
    with watching(one, "wide") as first, watching(two, "wide") as relayed:
        first.send(request)
        clocks = [next(reply for reply in iter(first.receive, None) if isinstance(reply, wire.Clock))]
        relayed.send(joining("wide", mode="table"))
        shared = next(reply for reply in iter(relayed.receive, None) if isinstance(reply, wire.Shared))
        assert (shared.groups, shared.about) == (request.groups, request.about)
        relayed.send(wire.Gust(10.0, 20.0))
        for client in (first, relayed):
            told = next(
                parse_state(reply.state)
                for reply in iter(client.receive, None)
                if isinstance(reply, wire.WindState) and reply.state.get("fronts")
            )
            clocks.append(
                next(reply for reply in iter(client.receive, None) if isinstance(reply, wire.Clock))
            )
            assert (told.fronts[0].x_m, told.fronts[0].z_m) == (10.0, 20.0)
        ahead_s = [clock.time_s - clock.made_s for clock in clocks]
        assert max(ahead_s) - min(ahead_s) < 0.5
        assert peers.holder("wide") == one.url
        with watching(two, "wide") as stream:
            stream.send(joining("wide"))
            failure, code, _ = stream.session_error()
            assert (failure.code, code) == ("too-many-trees", 1008)


def test_a_relayed_client_that_never_reads_is_disconnected(peers: Peers) -> None:
    one, two = peers.servers
    with watching(one, "grove") as first:
        first.send(forest(share="grove", count=3000))
        frames_until(first, lambda frame: frame.tick >= 3)
        stalled = watching(two, "grove", max_queue=1)
        stalled.socket.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        stalled.send(joining("grove"))
        began_s = time.monotonic()
        wait_until(lambda: "does not read" in one.log() + two.log())
        assert time.monotonic() - began_s > STALL_S
        ticks = [frame.tick for frame, _ in frames_until(first, lambda frame: frame.tick >= 30)]
        assert ticks
        stalled.socket.close()
