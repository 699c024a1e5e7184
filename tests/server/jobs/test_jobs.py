"""Jobs: cancellation, crashes and restarts, with real processes and a fake build."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import httpx
import psutil
import pytest

from tests.server.api.test_rest_api import upload
from tests.server.support.fake_job import STEPS, hold_records
from tests.server.support.server_process import FAKE_JOB, NO_CLUSTER, Server, command_line, wait_until

StartServer = Callable[..., Server]


def begin(api: httpx.Client, filename: str = "tree.obj") -> dict[str, Any]:
    tree = upload(api, filename.encode(), filename).json()
    job: dict[str, Any] = api.post("/api/jobs", json={"tree_id": tree["id"]}).json()
    return job


def running(api: httpx.Client, job: dict[str, Any]) -> None:
    wait_until(lambda: api.get(f"/api/jobs/{job['id']}").json()["fraction"] > 0)


def state(api: httpx.Client, job: dict[str, Any]) -> str:
    return str(api.get(f"/api/jobs/{job['id']}").json()["state"])


def gone(processes: list[psutil.Process]) -> bool:
    return not any(one.is_running() and one.status() != psutil.STATUS_ZOMBIE for one in processes)


def test_cancel_stops_a_job_and_the_queue_continues(start_server: StartServer) -> None:
    server = start_server(FAKE_STEP_S="1.5", **NO_CLUSTER)
    with server.client() as api:
        first, second, third = begin(api, "a.obj"), begin(api, "b.obj"), begin(api, "c.obj")
        running(api, first)
        assert state(api, second) == "queued"
        assert api.post(f"/api/jobs/{third['id']}/cancel").json()["state"] == "cancelled"
        worker = [one for one in server.family() if FAKE_JOB in " ".join(command_line(one))]
        assert len(worker) == 1
        api.post(f"/api/jobs/{first['id']}/cancel")
        wait_until(lambda: state(api, first) == "cancelled" and gone(worker))
        running(api, second)
        assert state(api, third) == "cancelled"


def test_jobs_resume_after_a_restart(start_server: StartServer) -> None:
    server = start_server(FAKE_STEP_S="0.2", **NO_CLUSTER)
    with server.client() as api:
        first, second = begin(api, "a.obj"), begin(api, "b.obj")
        steps = server.data_dir / "cache" / "steps-a.obj"
        wait_until(lambda: steps.exists() and len(steps.read_text().split()) >= 3)
        before = api.get("/api/trees").json()["trees"]
        family = server.family()
        assert family
        server.kill()
    wait_until(lambda: gone(family))
    again = start_server(FAKE_STEP_S="0.02", **NO_CLUSTER)
    with again.client() as api:
        after = api.get("/api/trees").json()["trees"]
        assert [tree["id"] for tree in after] == [tree["id"] for tree in before]
        for job in (first, second):
            wait_until(lambda job=job: state(api, job) == "done")
    assert [int(line) for line in steps.read_text().split()] == list(range(STEPS))


def test_a_killed_job_process_is_restarted(start_server: StartServer) -> None:
    server = start_server(FAKE_STEP_S="0.2", **NO_CLUSTER)
    with server.client() as api:
        job = begin(api)
        running(api, job)
        (worker,) = [one for one in server.family() if FAKE_JOB in command_line(one)]
        worker.kill()
        wait_until(lambda: state(api, job) == "done")


@pytest.mark.long
def test_a_graceful_stop_leaves_no_process(start_server: StartServer) -> None:
    server = start_server(FAKE_STEP_S="1")
    with server.client() as api:
        running(api, begin(api))
        # job, cluster, their guards, a worker
        family = wait_until(lambda: len(found := server.family()) >= 5 and found)
    server.stop()
    assert gone(family)
    assert "Traceback" not in server.log()


@pytest.mark.long
def test_a_stop_while_the_cluster_starts_leaves_no_process(start_server: StartServer) -> None:
    server = start_server(FAKE_STEP_S="1")
    with server.client() as api:
        begin(api)
        # job, cluster, their guards
        family = wait_until(lambda: len(found := server.family()) >= 4 and found)
    server.stop()
    assert gone(family)
    assert "Traceback" not in server.log()


def in_records(api: httpx.Client, job: dict[str, Any]) -> bool:
    now = api.get(f"/api/jobs/{job['id']}").json()
    return bool(
        now["stage"] == "records" and api.get(f"/api/trees/{job['tree_id']}").json()["state"] == "ready"
    )


@pytest.mark.long
def test_records_make_way_for_the_table_of_another_tree(start_server: StartServer) -> None:
    server = start_server(FAKE_STEP_S="0.01", **NO_CLUSTER)
    held, also = (hold_records(server.data_dir, name) for name in ("a.obj", "b.obj"))
    with server.client() as api:
        first = begin(api, "a.obj")
        wait_until(lambda: in_records(api, first))
        second = begin(api, "b.obj")
        wait_until(lambda: in_records(api, second))
        assert (state(api, first), state(api, second)) == ("queued", "running")
        also.unlink()
        wait_until(lambda: state(api, second) == "done")
        wait_until(lambda: state(api, first) == "running")
        assert in_records(api, first)
        table = api.get(f"/api/trees/{first['tree_id']}").json()
        assert table["table_sha256"] and table["records_sha256"] is None
        held.unlink()
        wait_until(lambda: state(api, first) == "done")
        done = api.get(f"/api/trees/{first['tree_id']}").json()
        assert done["table_sha256"] == table["table_sha256"] and done["records_sha256"]


@pytest.mark.long
def test_cancelling_in_stage_records_keeps_the_table(start_server: StartServer) -> None:
    server = start_server(FAKE_STEP_S="0.01", **NO_CLUSTER)
    held = hold_records(server.data_dir, "a.obj")
    with server.client() as api:
        job = begin(api, "a.obj")
        wait_until(lambda: in_records(api, job))
        api.post(f"/api/jobs/{job['id']}/cancel")
        wait_until(lambda: state(api, job) == "cancelled")
        tree = api.get(f"/api/trees/{job['tree_id']}").json()
        assert (tree["state"], tree["records_sha256"]) == ("ready", None)
        held.unlink()
        again = api.post("/api/jobs", json={"tree_id": tree["id"]})
        assert again.status_code == 202
        wait_until(lambda: state(api, again.json()) == "done")
        done = api.get(f"/api/trees/{tree['id']}").json()
        assert done["table_sha256"] == tree["table_sha256"] and done["records_sha256"]


@pytest.mark.long
def test_a_job_resumes_in_stage_records_after_a_crash(start_server: StartServer) -> None:
    server = start_server(FAKE_STEP_S="0.01", **NO_CLUSTER)
    held = hold_records(server.data_dir, "a.obj")
    with server.client() as api:
        job = begin(api, "a.obj")
        wait_until(lambda: in_records(api, job))
        tree = api.get(f"/api/trees/{job['tree_id']}").json()
        family = server.family()
        server.kill()
    wait_until(lambda: gone(family))
    held.unlink()
    again = start_server(FAKE_STEP_S="0.01", **NO_CLUSTER)
    with again.client() as api:
        wait_until(lambda: state(api, job) == "done")
        done = api.get(f"/api/trees/{tree['id']}").json()
        assert done["table_sha256"] == tree["table_sha256"] and done["records_sha256"]


@pytest.mark.long
def test_a_second_server_on_the_same_folder_does_not_start(start_server: StartServer) -> None:
    server = start_server(**NO_CLUSTER)
    other = Server(server.data_dir, server.module, server.environment)
    try:
        other.start()
    except AssertionError as error:
        assert "Another server is using" in str(error)
    else:
        other.stop()
        raise AssertionError("the second server started")
