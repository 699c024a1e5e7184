"""Builds on an external Dask cluster whose workers share neither disk nor database with the server.

Only under `make test-distributed`, which starts PostgreSQL, an S3-compatible server, a scheduler and workers.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import httpx
import obstore
import psutil
import pytest
from galewood.table import format as table_format
from galewood_server.storage.object_store import open_bucket

from tests.server.jobs.test_build_end_to_end import LONG_S, assert_compares, begin, follow, sampling
from tests.server.jobs.test_jobs import gone, state
from tests.server.support.server_process import Server, shared_services, wait_until

SCHEDULER = os.environ.get("GALEWOOD_TEST_SCHEDULER", "")
pytestmark = [
    pytest.mark.skipif(not SCHEDULER, reason="run by make test-distributed"),
    pytest.mark.timeout(1800),
]


def runs(environment: dict[str, str]) -> dict[str, Any]:
    """Finished runs in the bucket with their modification times."""
    bucket = open_bucket(environment["GALEWOOD_STORE_URL"])
    items = [item for page in obstore.list(bucket, prefix="transfer/trajectories") for item in page]
    return {item["path"]: item["last_modified"] for item in items}


def worker() -> psutil.Process:
    """A simulating worker process."""
    nannies = [psutil.Process(int(pid)) for pid in os.environ["GALEWOOD_TEST_WORKERS"].split(",")]
    return next(
        one for nanny in nannies for one in nanny.children(recursive=True) if "spawn" in str(one.cmdline())
    )


def start(folder: Path, environment: dict[str, str]) -> Server:
    folder.mkdir(parents=True)
    return Server(folder, "galewood_server.cli.main", environment).start("serve")


def test_a_build_survives_worker_and_server_loss_without_a_shared_disk(tmp_path: Path) -> None:
    environment = {**shared_services(tmp_path), "GALEWOOD_SCHEDULER_URL": SCHEDULER, "GALEWOOD_LEASE_S": "3"}
    first = start(tmp_path / "first" / "data", environment)
    with first.client() as api:
        tree, job = begin(api, 4.0)
        sampling(api, job)
    worker().kill()
    finished = wait_until(lambda: len(runs(environment)) > 4 and runs(environment), LONG_S)
    family = first.family()
    first.kill()
    wait_until(lambda: gone(family), LONG_S)
    second = start(tmp_path / "second" / "data", environment)
    try:
        with second.client() as api:
            finish(api, tree, job, environment, finished)
    finally:
        second.stop()


def finish(
    api: httpx.Client,
    tree: dict[str, Any],
    job: dict[str, Any],
    environment: dict[str, str],
    finished: dict[str, Any],
) -> None:
    """A server with an empty disk finishes the job from the bucket without repeating runs."""
    wait_until(lambda: len(runs(environment)) > len(finished), LONG_S)
    later = runs(environment)
    assert {path: later.get(path) for path in finished} == finished
    follow(api, tree["id"], job["id"])
    assert state(api, job) == "done"
    wait_until(lambda: not runs(environment), LONG_S)  # deleted after the build
    tree = api.get(f"/api/trees/{tree['id']}").json()
    table = table_format.decode(api.get(f"/api/tables/{tree['table_sha256']}").content)
    assert_compares(api, tree, table)


def test_cancel_stops_workers_without_a_shared_disk(tmp_path: Path) -> None:
    environment = {**shared_services(tmp_path), "GALEWOOD_SCHEDULER_URL": SCHEDULER}
    server = start(tmp_path / "data", environment)
    try:
        with server.client() as api:
            _, job = begin(api, 3.0)
            sampling(api, job)
            api.post(f"/api/jobs/{job['id']}/cancel")
            wait_until(lambda: state(api, job) == "cancelled", LONG_S)
            there = wait_until(lambda: settled(environment), LONG_S)
            assert len(there) < 30
    finally:
        server.stop()


def settled(environment: dict[str, str]) -> dict[str, Any]:
    """Finished runs, once their number is constant for a second."""
    before = runs(environment)
    psutil.cpu_percent(1.0)
    return before if runs(environment) == before else {}
