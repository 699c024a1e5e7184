"""Job leases: several servers on one database and one store."""

from __future__ import annotations

import json
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import httpx
import psutil
import pytest
from galewood_server.app import builtin_trees
from galewood_server.context import Service
from galewood_server.http import ProblemError
from galewood_server.jobs import find_job, queue
from galewood_server.jobs.leases import (
    claim,
    claimable_kinds,
    is_awaited,
    put_back,
    renew,
    requeue_running,
)
from galewood_server.settings import Settings
from galewood_server.storage import Stores
from galewood_server.storage.database import migrate, open_database
from galewood_server.storage.models import Job, JobKind, JobState, Tree
from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from tests.server.jobs.test_jobs import begin, state
from tests.server.support.fake_job import STEPS
from tests.server.support.server_process import (
    FAKE_JOB,
    FAKE_SERVER,
    NO_CLUSTER,
    Server,
    command_line,
    shared_services,
    wait_until,
)


@pytest.mark.parametrize("state", ["queued", "running", "cancelled"])
def test_a_cancel_of_a_job_whose_tree_is_deleted_meanwhile_says_that_it_is_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, state: JobState
) -> None:
    url = f"sqlite:///{tmp_path / 'jobs.sqlite'}"
    migrate(url)
    sessions = open_database(url)
    with sessions.begin() as session:
        jobs = [Job(id="job", state=state)]
        session.add(Tree(id="t", name="t", filename="t.obj", source_sha256="0" * 64, jobs=jobs))

    def find_and_delete(session: Session, job_id: str, *kinds: JobKind) -> Job:
        monkeypatch.undo()
        job = find_job(session, job_id, *kinds)
        with sessions.begin() as other:
            other.execute(delete(Tree))
        return job

    monkeypatch.setattr(queue, "find_job", find_and_delete)
    with sessions.begin() as session, pytest.raises(ProblemError) as caught:
        queue.request_cancel(session, "job")
    assert caught.value.problem.status == 404


def test_builds_with_a_table_come_after_all_others(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'jobs.sqlite'}"
    migrate(url)
    sessions = open_database(url)
    stages = {"old": "records", "bare": "bare", "new": "queued"}
    with sessions.begin() as session:
        jobs = [Job(id=name, stage=stage) for name, stage in stages.items()]
        session.add(Tree(id="t", name="t", filename="t.obj", source_sha256="0" * 64, jobs=jobs))
        session.flush()
        for age, name in enumerate(stages):
            session.get_one(Job, name).created_at += timedelta(seconds=age)
    with sessions.begin() as session:
        assert claim(session, "one", ("build",), 60, after_table=True) is None, "another tree waits"
        new = claim(session, "one", ("build",), 60)
        assert new and new[0] == "new"
        assert claim(session, "one", ("build",), 60) is None, "the others have their tables"
        old = claim(session, "one", ("build",), 60, after_table=True)
        assert old and old[0] == "old"
    with sessions.begin() as session:
        assert is_awaited(session, *old), "a tree without a table is computed on the same server"
        bare = claim(session, "two", ("build",), 60, after_table=True)
        assert bare and not is_awaited(session, *bare), "the other server is busy, this one is not"
        put_back(session, *old)
    with sessions.begin() as session:
        job = session.get_one(Job, "old")
        assert (job.state, job.stage, job.lease) == ("queued", "records", None)
        assert claim(session, "two", ("build",), 60, after_table=True) is None, "its server has its files"
        assert claim(session, "one", ("build",), 60, after_table=True)
        put_back(session, "old", str(job.lease))
        session.refresh(job)
        job.updated_at -= timedelta(seconds=90)
    with sessions.begin() as session:
        again = claim(session, "two", ("build",), 60, after_table=True)
        assert again and again[0] == "old", "its server has not taken it"
        session.add(Job(id="next", tree_id="t"))
        session.flush()
        assert is_awaited(session, *bare), "a tree waits"
        put_back(session, "bare", "the lease of another server")
        assert session.get_one(Job, "bare").state == "running"


def test_servers_that_start_together_register_each_tree_once(tmp_path: Path) -> None:
    url = shared_services(tmp_path).get("GALEWOOD_DATABASE_URL", f"sqlite:///{tmp_path / 'shared.sqlite'}")
    migrate(url)
    (tmp_path / "pole.obj").write_text("v 0 0 0")
    entry = {"id": "pole", "name": "Pole", "file": "pole.obj", "species": "maple", "height_m": 3.0}
    (tmp_path / "species.json").write_text(json.dumps([entry]))
    start = threading.Barrier(6)

    def register(number: int) -> None:
        settings, sessions = Settings(species_dir=tmp_path), open_database(url)
        stores = Stores(tmp_path / f"data-{number}", None)
        start.wait(60)
        service = SimpleNamespace(settings=settings, stores=stores, sessions=sessions)
        builtin_trees.register(cast(Service, service))

    with ThreadPoolExecutor(6) as threads:
        list(threads.map(register, range(6)))  # raises what a thread has raised
    with open_database(url)() as session:
        assert [tree.id for tree in session.scalars(select(Tree))] == ["pole"]
        assert len(session.scalars(select(Job)).all()) == 1


class Pair:
    """Two servers with separate data folders, a shared database and a shared store."""

    def __init__(self, folder: Path) -> None:
        shared = {
            "GALEWOOD_DATABASE_URL": f"sqlite:///{folder / 'shared.sqlite'}",
            "GALEWOOD_STORE_URL": f"file://{folder / 'store'}",
            "GALEWOOD_JOB_MODULE": FAKE_JOB,
            "GALEWOOD_LEASE_S": "2",
            "FAKE_STEP_S": "0.15",
            **NO_CLUSTER,
            **shared_services(folder),
        }
        self.servers = [self._server(folder / name / "data", shared) for name in ("one", "two")]

    def _server(self, data_dir: Path, environment: dict[str, str]) -> Server:
        data_dir.mkdir(parents=True)
        return Server(data_dir, FAKE_SERVER, environment).start()

    def steps(self, filename: str) -> list[int]:
        """Number of build steps per server."""
        logs = [server.data_dir / "cache" / f"steps-{filename}" for server in self.servers]
        return [len(log.read_text().split()) if log.exists() else 0 for log in logs]

    def at_work(self, filename: str) -> tuple[Server, Server]:
        """The server that runs a build, and the other one."""
        steps = wait_until(lambda: sum(self.steps(filename)) and self.steps(filename))
        first, second = self.servers
        return (first, second) if steps[0] else (second, first)


@pytest.fixture
def pair(tmp_path: Path) -> Iterator[Pair]:
    pair = Pair(tmp_path)
    yield pair
    for server in pair.servers:
        assert server.process
        server.process.send_signal(signal.SIGCONT)
        server.stop()


def all_done(api: httpx.Client, jobs: list[dict[str, Any]]) -> None:
    for job in jobs:
        wait_until(lambda job=job: state(api, job) == "done")


def test_each_job_has_one_server_and_both_servers_work(pair: Pair) -> None:
    with pair.servers[0].client() as api, pair.servers[1].client() as other:
        names = [f"bare-{name}.obj" for name in "abcd"]  # their builds end with the table
        jobs = [begin(api, name) for name in names]
        all_done(other, jobs)  # visible to the other server as well
        counts = [pair.steps(name) for name in names]
        assert all(sorted(count) == [0, STEPS] for count in counts), counts
        assert {count.index(STEPS) for count in counts} == {0, 1}, counts
        for tree in other.get("/api/trees").json()["trees"]:
            assert other.get(f"/api/tables/{tree['table_sha256']}").content.startswith(b"table of")


def test_another_server_takes_over_after_a_crash(pair: Pair) -> None:
    with pair.servers[0].client() as api:
        job = begin(api)
    busy, idle = pair.at_work("tree.obj")
    busy.kill()
    with idle.client() as api:
        all_done(api, [job])
    busy.start()  # so that the fixture can stop it


def test_a_suspended_server_cannot_change_a_lost_job(pair: Pair) -> None:
    with pair.servers[0].client() as api:
        job = begin(api)
    busy, idle = pair.at_work("tree.obj")
    assert busy.process
    family = [psutil.Process(busy.process.pid), *busy.family()]
    for one in family:
        one.suspend()
    with idle.client() as api:
        wait_until(lambda: pair.steps("tree.obj")[pair.servers.index(idle)] > 2)
        for one in family:
            one.resume()
        all_done(api, [job])
    wait_until(lambda: not [one for one in busy.family() if FAKE_JOB in command_line(one)])
    assert pair.steps("tree.obj")[pair.servers.index(idle)] == STEPS
    assert pair.steps("tree.obj")[pair.servers.index(busy)] < STEPS


def test_a_job_is_claimed_once_and_a_lost_lease_writes_nothing(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'jobs.sqlite'}"
    migrate(url)
    sessions = open_database(url)
    with sessions.begin() as session:
        session.add(Tree(id="t", name="t", filename="t.obj", source_sha256="0" * 64, jobs=[Job(id="j")]))
    with sessions() as session:
        assert claimable_kinds(session) == {"build"}
    with sessions.begin() as session:
        won = claim(session, "one", ("build",), 60)
        assert won and won[0] == "j"
        assert claim(session, "two", ("build",), 60) is None
    with sessions() as session:
        assert not claimable_kinds(session)
    with sessions.begin() as session:
        assert renew(session, *won, 0)
    with sessions() as session:
        assert claimable_kinds(session) == {"build"}, "its lease has expired"
    with sessions.begin() as session:
        taken = claim(session, "two", ("build",), 60)
        assert taken and taken[0] == "j" and taken[1] != won[1]
        assert not renew(session, *won, 60)
        assert requeue_running(session, "one") == 0 and requeue_running(session, "two") == 1
        assert session.get_one(Job, "j").state == "queued"
    with sessions() as session:
        assert claim(session, "one", ("comparison",), 60) is None
