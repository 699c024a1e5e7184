"""Evaluations over REST: queue, follow, cancel, download and delete."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from galewood_server.access.keys import new_key
from galewood_server.cli.client import Client, ServiceError

from tests.server.api.test_rest_api import assert_problem
from tests.server.jobs.test_jobs import gone
from tests.server.support.fake_job import STEPS, hold_records
from tests.server.support.server_process import (
    FAKE_JOB,
    FAKE_SERVER,
    NO_CLUSTER,
    Server,
    command_line,
    wait_until,
)

KEY, KEY_HASH = new_key()
MINE = {"Authorization": f"Bearer {KEY}"}


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("evaluations") / "data"
    data_dir.mkdir()
    environment = {
        "GALEWOOD_JOB_MODULE": FAKE_JOB, "FAKE_STEP_S": "0.05", "GALEWOOD_API_KEYS": KEY_HASH,
        "GALEWOOD_REPLACED_FILES_S": "0", "GALEWOOD_GARBAGE_COLLECTION_S": "0.2", **NO_CLUSTER,
    }  # fmt: skip
    server = Server(data_dir, FAKE_SERVER, environment).start()
    yield server
    server.stop()


@pytest.fixture
def api(server: Server) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=server.url, timeout=60, headers=MINE) as client:
        yield client


@pytest.fixture(scope="module")
def tree(server: Server) -> dict[str, Any]:
    with httpx.Client(base_url=server.url, timeout=60, headers=MINE) as client:
        return computed(client, "study.obj")


def computed(api: httpx.Client, name: str) -> dict[str, Any]:
    """A tree with table, model and records.

    It is ready before its records are there, with which an evaluation covers one more method. So the same
    request is another evaluation then.
    """
    tree = api.post("/api/trees?build=true", files={"file": (name, name.encode())}).json()
    assert ended(api, f"/api/jobs/{tree['job_id']}")["state"] == "done"
    found: dict[str, Any] = api.get(f"/api/trees/{tree['id']}").json()
    return found


def evaluate(api: httpx.Client, tree: dict[str, Any], **asked: Any) -> httpx.Response:
    return api.post(f"/api/trees/{tree['id']}/evaluations", json=asked)


def ended(api: httpx.Client, url: str) -> dict[str, Any]:
    found: dict[str, Any] = wait_until(
        lambda: (now := api.get(url).json())["state"] not in ("queued", "running") and now
    )
    return found


def test_an_identical_evaluation_runs_once(api: httpx.Client, tree: dict[str, Any]) -> None:
    first = evaluate(api, tree, sway=0.1, frames=120)
    assert first.status_code == 202 and first.json()["report"] is None
    url = first.headers["location"]
    assert_problem(api.get(f"{url}/report"), 404, "no-report")
    again = evaluate(api, tree, sway=0.1, frames=120)
    assert (again.status_code, again.json()["id"]) == (200, first.json()["id"])
    other = evaluate(api, tree, sway=0.2, frames=120)
    assert other.status_code == 202
    found = ended(api, url)
    assert found["state"] == "done" and found["settings"]["seed"] == 20_001
    assert found["settings"]["table_sha256"] == tree["table_sha256"]
    assert api.get(found["report"]).json() == {"kind": "evaluation", "job": found["id"]}
    picture = api.get(found["plot"])
    assert picture.content.startswith(b"\x89PNG") and picture.headers["content-type"] == "image/png"
    held = {"If-None-Match": picture.headers["etag"]}
    assert api.get(found["plot"], headers=held).status_code == 304
    listed = api.get(f"/api/trees/{tree['id']}/evaluations").json()
    assert [one["id"] for one in listed["evaluations"]][:2] == [other.json()["id"], found["id"]]
    assert listed["total"] == len(listed["evaluations"])


def test_the_records_of_a_tree_make_another_evaluation(server: Server, api: httpx.Client) -> None:
    held = hold_records(server.data_dir, "study-records.obj")
    tree = api.post("/api/trees?build=true", files={"file": ("study-records.obj", b"study-records")}).json()
    wait_until(lambda: api.get(f"/api/trees/{tree['id']}").json()["state"] == "ready", 240)
    before = evaluate(api, tree, frames=120)
    assert before.json()["settings"]["records_sha256"] is None
    assert evaluate(api, tree, frames=120).json()["id"] == before.json()["id"]
    held.unlink()
    assert ended(api, f"/api/jobs/{tree['job_id']}")["state"] == "done"
    after = evaluate(api, tree, frames=120)
    assert after.status_code == 202 and after.json()["settings"]["records_sha256"]
    for answer in (before, after):
        api.post(f"{answer.headers['location']}/cancel")


def test_invalid_evaluations_are_problems(api: httpx.Client, tree: dict[str, Any]) -> None:
    for asked in ({"sway": 0.1, "speed_m_s": 8}, {"sway": 3}, {"speed_m_s": 0}, {"frames": 10}, {"wind": 1}):
        assert_problem(evaluate(api, tree, **asked), 422, "invalid-request")
    assert_problem(evaluate(api, {"id": "none"}), 404, "no-such-tree")
    bare = api.post("/api/trees", files={"file": ("bare.obj", b"bare")}).json()
    assert_problem(evaluate(api, bare), 409, "not-computed")
    assert_problem(api.get("/api/evaluations/none"), 404, "no-such-evaluation")
    build = f"/api/evaluations/{tree['job_id']}"
    assert_problem(api.get(build), 404, "no-such-evaluation")  # a build is not an evaluation
    stranger = httpx.post(f"{api.base_url}/api/trees/{tree['id']}/evaluations", json={})
    assert_problem(stranger, 401, "key-needed")


def test_a_cancelled_evaluation_stops_and_leaves_no_files(
    server: Server, api: httpx.Client, tree: dict[str, Any]
) -> None:
    url = evaluate(api, tree, speed_m_s=7.5).headers["location"]
    wait_until(lambda: api.get(url).json()["fraction"] > 0)
    folder = server.data_dir / "cache" / "analyses" / url.rsplit("/", 1)[-1]
    running = [one for one in server.family() if folder.name in command_line(one)]
    assert running and folder.exists()
    api.post(f"{url}/cancel")
    assert ended(api, url)["state"] == "cancelled"
    wait_until(lambda: gone(running) and not folder.exists())
    assert evaluate(api, tree, speed_m_s=7.5).status_code == 202  # a new request starts a new job


def test_evaluation_files_are_removed_with_the_tree(server: Server, api: httpx.Client) -> None:
    tree = computed(api, "study-gone.obj")
    found = ended(api, evaluate(api, tree, seed=7).headers["location"])
    assert len(files_of(server, found["id"])) == 2
    api.delete(f"/api/trees/{tree['id']}")
    wait_until(lambda: not files_of(server, found["id"]))
    assert_problem(api.get(f"/api/evaluations/{found['id']}"), 404, "no-such-evaluation")


def files_of(server: Server, evaluation_id: str) -> list[Path]:
    """Stored files that contain the id of an evaluation."""
    kinds = [path for kind in ("results", "pictures") for path in (server.data_dir / kind).rglob("??/*")]
    return [path for path in kinds if evaluation_id.encode() in content(path)]


def content(path: Path) -> bytes:
    """The content of a file; empty if it was removed meanwhile."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return b""


def test_the_python_client_runs_an_evaluation(server: Server, tree: dict[str, Any]) -> None:
    with Client(server.url, KEY) as client:
        begun = client.evaluate(tree["id"], sway=0.05, frames=60)
        states = [one["state"] for one in client.follow(begun["id"], "evaluations")]
        assert states[-1] == "done"
        assert client.evaluation_report(begun["id"])["job"] == begun["id"]
        assert client.evaluation_plot(begun["id"]).startswith(b"\x89PNG")
        assert client.evaluations(tree["id"])[0]["id"] == begun["id"]
        with pytest.raises(ServiceError, match="no plot"):
            client.evaluation_plot(client.evaluate(tree["id"], seed=9)["id"])


def test_an_evaluation_resumes_after_a_server_crash(
    server: Server, api: httpx.Client, tree: dict[str, Any]
) -> None:
    url = evaluate(api, tree, frames=90).headers["location"]
    steps = server.data_dir / "cache" / "analyses" / url.rsplit("/", 1)[-1] / "steps"
    wait_until(lambda: steps.exists() and len(steps.read_text().split()) > 2)
    family = server.family()
    server.kill()
    wait_until(lambda: gone(family))
    kept = len(steps.read_text().split())
    server.start()
    assert ended(api, url)["state"] == "done"
    assert kept < STEPS  # it was interrupted
