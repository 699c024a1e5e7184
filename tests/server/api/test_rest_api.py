"""The REST API of a real server process."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.server.support.server_process import Server, fake_service, wait_until


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    folder = tmp_path_factory.mktemp("rest")
    with fake_service(folder, GALEWOOD_UPLOAD_BYTES="100000", GALEWOOD_JOB_ATTEMPTS="2") as server:
        yield server


@pytest.fixture
def api(server: Server) -> Iterator[httpx.Client]:
    with server.client() as client:
        yield client


def upload(
    api: httpx.Client, data: bytes = b"a tree", filename: str = "tree.obj", **fields: str
) -> httpx.Response:
    return api.post("/api/trees", files={"file": (filename, data)}, data=fields)


def assert_problem(answer: httpx.Response, status: int, code: str) -> dict[str, Any]:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert problem["code"] == code and problem["status"] == status
    assert problem["title"] and "hint" in problem
    assert problem.get("detail", "more") not in ("", problem["title"], problem["hint"])
    assert "Traceback" not in answer.text and "/work" not in answer.text
    return problem


def test_health_has_the_version(api: httpx.Client) -> None:
    health = api.get("/healthz").json()
    assert health["status"] == "ok" and health["version"]


def test_an_upload_is_listed_and_its_mesh_is_served(api: httpx.Client) -> None:
    answer = upload(api, b"an oak", species="maple", height_m="7.5", name="My tree")
    assert answer.status_code == 201
    tree = answer.json()
    assert (tree["name"], tree["species"], tree["height_m"]) == ("My tree", "maple", 7.5)
    assert (tree["state"], tree["builtin"], tree["job_id"]) == ("uploaded", False, None)
    assert api.get(f"/api/trees/{tree['id']}").json() == tree
    assert summary_of(tree) in api.get("/api/trees").json()["trees"]
    mesh = api.get(f"/api/meshes/{tree['mesh_sha256']}")
    assert hashlib.sha256(mesh.content).hexdigest() == tree["mesh_sha256"]


def summary_of(tree: dict[str, Any]) -> dict[str, Any]:
    """A tree as in lists and events."""
    return {name: value for name, value in tree.items() if name != "report"}


def test_a_computed_table_is_immutable(api: httpx.Client) -> None:
    tree = upload(api, b"a tree to build").json()
    answer = api.post("/api/jobs", json={"tree_id": tree["id"]})
    assert answer.status_code == 202
    job = answer.json()
    assert job["tree_id"] == tree["id"] and job["state"] == "queued"
    seen = list(progress(api, job["id"]))
    table = [one["fraction"] for one in seen if one["stage"] not in ("records", "done")]
    assert table == sorted(table)
    assert seen[-1]["state"] == "done" and seen[-1]["fraction"] == 1
    assert any(one["seconds_left"] for one in seen)
    ready = api.get(f"/api/trees/{tree['id']}").json()
    assert ready["state"] == "ready" and ready["job_id"] == job["id"]
    assert_immutable(api, f"/api/tables/{ready['table_sha256']}", b"table of a tree to build")
    assert_immutable(api, f"/api/records/{ready['records_sha256']}", b"records of a tree to build")
    listed = next(one for one in api.get("/api/tables").json()["tables"] if one["tree_id"] == tree["id"])
    assert listed["records_sha256"] == ready["records_sha256"]


def progress(api: httpx.Client, job_id: str) -> Iterator[dict[str, Any]]:
    """The events of a job; ends when the server ends the stream."""
    with api.stream("GET", f"/api/jobs/{job_id}/events") as stream:
        name = ""
        for line in stream.iter_lines():
            name = line.removeprefix("event: ") if line.startswith("event: ") else name
            if line.startswith("data: "):
                assert name == "progress"
                yield json.loads(line.removeprefix("data: "))


def assert_immutable(api: httpx.Client, path: str, content: bytes) -> None:
    whole = api.get(path)
    assert whole.content == content and "immutable" in whole.headers["cache-control"]
    part = api.get(path, headers={"Range": "bytes=2-5"})
    assert part.status_code == 206 and part.content == content[2:6]
    again = api.get(path, headers={"If-None-Match": whole.headers["etag"]})
    assert again.status_code == 304 and not again.content


def test_every_change_is_an_event(api: httpx.Client) -> None:
    with api.stream("GET", "/api/events") as stream:
        events = (json.loads(line[6:]) for line in stream.iter_lines() if line.startswith("data: "))
        with httpx.Client(base_url=api.base_url) as other:
            tree = upload(other, b"told").json()
            first = next(event for event in events if event["tree"]["id"] == tree["id"])
            assert first == {"tree": summary_of(tree), "job": None, "deleted": False}
            other.post("/api/jobs", json={"tree_id": tree["id"]})
            last = next(event for event in events if event["job"] and event["job"]["state"] == "done")
            assert last["tree"]["id"] == tree["id"] and last["tree"]["state"] == "ready"
            other.delete(f"/api/trees/{tree['id']}")
            assert next(event for event in events if event["deleted"])["tree"]["id"] == tree["id"]


def test_concurrent_builds_of_one_tree_are_rejected(api: httpx.Client) -> None:
    tree = upload(api, b"twice", "twice.obj").json()
    job = api.post("/api/jobs", json={"tree_id": tree["id"]}).json()
    assert_problem(api.post("/api/jobs", json={"tree_id": tree["id"]}), 409, "already-building")
    assert_problem(api.delete(f"/api/trees/{tree['id']}"), 409, "still-building")
    api.post(f"/api/jobs/{job['id']}/cancel")
    wait_until(lambda: api.get(f"/api/jobs/{job['id']}").json()["state"] == "cancelled")
    assert api.get(f"/api/trees/{tree['id']}").json()["state"] == "uploaded"


def test_a_failed_build_can_be_retried(api: httpx.Client) -> None:
    tree = upload(api, b"bad", "fail.obj").json()
    for _ in range(2):
        job = api.post("/api/jobs", json={"tree_id": tree["id"]}).json()
        last = list(progress(api, job["id"]))[-1]
        assert last["state"] == "failed" and "ValueError" in last["error"]
    assert api.get(f"/api/trees/{tree['id']}").json()["state"] == "failed"


def test_a_build_that_always_crashes_fails_eventually(api: httpx.Client) -> None:
    tree = upload(api, b"worse", "crash.obj").json()
    job = api.post("/api/jobs", json={"tree_id": tree["id"]}).json()
    last = list(progress(api, job["id"]))[-1]
    assert last["state"] == "failed" and "ended with exit code" in last["error"]


def test_delete_removes_unshared_files(api: httpx.Client, server: Server) -> None:
    first, second = (upload(api, b"shared", species=name).json() for name in ("maple", "poplar"))
    mesh = f"/api/meshes/{first['mesh_sha256']}"
    assert api.delete(f"/api/trees/{first['id']}").status_code == 204
    assert api.get(mesh).status_code == 200
    assert api.delete(f"/api/trees/{second['id']}").status_code == 204
    assert_problem(api.get(mesh), 404, "no-such-mesh")
    assert_problem(api.get(f"/api/trees/{first['id']}"), 404, "no-such-tree")


def test_invalid_requests_are_problems(api: httpx.Client) -> None:
    assert_problem(upload(api, b""), 400, "empty-file")
    assert_problem(upload(api, b"x" * 100_001), 413, "upload-too-large")
    assert_problem(upload(api, b"x" * 3_000_000), 413, "upload-too-large")
    assert_problem(upload(api, colour="red"), 422, "unknown-field")
    assert_problem(upload(api, species="baobab"), 422, "invalid-field")
    assert_problem(upload(api, height_m="nan"), 422, "invalid-field")
    assert_problem(upload(api, up_axis="w"), 422, "invalid-field")
    assert_problem(api.post("/api/trees", json={}), 415, "not-a-form")
    assert_problem(api.post("/api/trees", data={"name": "x"}, files={"mesh": b"x"}), 400, "no-file")
    form = {"content-type": "multipart/form-data; boundary=x"}
    assert_problem(api.post("/api/trees", content=b"--y\r\nrubbish", headers=form), 400, "broken-form")
    no_boundary = {"content-type": "multipart/form-data"}
    assert_problem(api.post("/api/trees", content=b"", headers=no_boundary), 400, "broken-form")
    assert_problem(api.put("/api/trees"), 405, "method-not-allowed")
    assert_problem(api.get("/api/nothing"), 404, "not-found")
    assert_problem(api.get(f"/api/tables/{'0' * 64}"), 404, "no-such-table")
    assert_problem(api.get(f"/api/records/{'0' * 64}"), 404, "no-such-records")
    assert_problem(api.get("/api/tables/..%2f..%2fgalewood.sqlite"), 404, "not-found")
    assert_problem(api.get("/api/jobs/none/events"), 404, "no-such-job")
    assert upload(api, b"the next upload works").status_code == 201


def test_an_upload_without_content_length_is_limited(api: httpx.Client) -> None:
    def body() -> Iterator[bytes]:
        yield b'--x\r\ncontent-disposition: form-data; name="file"; filename="a.obj"\r\n\r\n'
        for _ in range(40):
            yield bytes(50_000)

    headers = {"content-type": "multipart/form-data; boundary=x"}
    assert_problem(api.post("/api/trees", content=body(), headers=headers), 413, "upload-too-large")


@pytest.mark.parametrize(
    "settings",
    [{"height_m": -1}, {"target_tets": 10**9}, {"colour": 1}, {"species": "baobab"}, {"height_m": "x"}],
)
def test_invalid_build_settings_are_rejected(api: httpx.Client, settings: dict[str, Any]) -> None:
    tree = upload(api, b"settings").json()
    answer = api.post("/api/jobs", json={"tree_id": tree["id"], "settings": settings})
    problem = assert_problem(answer, 422, "invalid-request")
    assert next(iter(settings)) in problem["detail"]


def test_file_names_never_become_paths(api: httpx.Client, server: Server) -> None:
    tree = upload(api, b"named", "../../etc/pass\x00wd.obj").json()
    assert "/" not in tree["name"] and not list(server.data_dir.parent.glob("**/*pass*"))


def test_the_page(start_server: Callable[..., Server], tmp_path: Path) -> None:
    server = start_server(GALEWOOD_PAGE_DIR=str(tmp_path / "page"))
    with server.client() as api:
        missing = api.get("/")
        assert missing.status_code == 503 and "make build" in missing.text
        (tmp_path / "page" / "assets").mkdir(parents=True)
        (tmp_path / "page" / "index.html").write_text("<h1>here</h1>")
        (tmp_path / "page" / "assets" / "a-1.js").write_text("1")
        assert api.get("/").text == "<h1>here</h1>"
        assert "immutable" in api.get("/assets/a-1.js").headers["cache-control"]
