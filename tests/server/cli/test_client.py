"""The Python client and the command line against a real server."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import anyio
import httpx
import numpy as np
import pytest
from galewood.table import decode
from galewood_server.access.keys import new_key
from galewood_server.cli.client import Client, ServiceError, stream
from galewood_server.cli.commands import app
from galewood_server.stream.wire import Failure, Forest, Group, Reply, Welcome
from typer.testing import CliRunner

from tests.golden import GOLDEN_FOLDER
from tests.server.support.server_process import FAKE_JOB, FAKE_SERVER, NO_CLUSTER, Server, wait_until

KEY, KEY_HASH = new_key()
run = CliRunner().invoke
STILL = {"version": 1, "model": "cosine", "mean_speed_m_s": 0, "direction_deg": 0, "gustiness": 0,
         "convection_speed_m_s": 8, "seed": 1}  # fmt: skip
FOREST = Forest("stream", (Group("0" * 64, 2),), STILL, 0.0, None, np.zeros((2, 4), np.float32))


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("client") / "data"
    data_dir.mkdir()
    environment = {
        "GALEWOOD_JOB_MODULE": FAKE_JOB, "FAKE_STEP_S": "0.01", "GALEWOOD_API_KEYS": KEY_HASH,
        "GALEWOOD_LOG_FORMAT": "json", **NO_CLUSTER,
    }  # fmt: skip
    server = Server(data_dir, FAKE_SERVER, environment).start()
    yield server
    server.stop()


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    (tmp_path / "oak.obj").write_bytes(b"an oak")
    return tmp_path / "oak.obj"


def test_upload_compute_and_download(server: Server, mesh: Path) -> None:
    with Client(server.url, KEY) as client:
        tree = client.upload(mesh, species="maple", height_m=7.5)
        assert (tree["name"], tree["species"], tree["height_m"]) == ("oak", "maple", 7.5)
        assert client.upload(mesh, species="maple", height_m=7.5)["id"] == tree["id"]
        jobs = list(client.follow(client.start(tree["id"])["id"]))
        assert jobs[-1]["state"] == "done"
        assert client.start(tree["id"])["id"] == jobs[-1]["id"]
        assert client.table(client.tree(tree["id"])["table_sha256"]) == b"table of an oak"


def test_problems_become_service_errors(server: Server, mesh: Path) -> None:
    with Client(server.url) as stranger, pytest.raises(ServiceError, match="API key") as caught:
        stranger.upload(mesh)
    assert (caught.value.status, caught.value.code) == (401, "key-needed")
    with Client(server.url, KEY) as client:
        with pytest.raises(ServiceError, match="no such job"):
            list(client.follow("none"))
        with pytest.raises(ServiceError) as unknown:
            client.upload(mesh, colour="red")
    assert unknown.value.status == 422 and unknown.value.hint


def test_a_whole_table_has_its_records() -> None:
    golden = GOLDEN_FOLDER
    files = {
        "/api/tables": (golden / "pole-table.safetensors").read_bytes(),
        "/api/records": (golden / "pole-records.safetensors").read_bytes(),
    }
    answer = httpx.MockTransport(
        lambda request: httpx.Response(200, content=files[request.url.path.rsplit("/", 1)[0]])
    )
    table, records = (hashlib.sha256(data).hexdigest() for data in files.values())
    with Client("http://server", transport=answer) as client:
        whole = client.whole_table({"table_sha256": table, "records_sha256": records})
        assert decode(whole).records.metadata == decode(*files.values()).records.metadata
        assert client.whole_table({"table_sha256": table, "records_sha256": None}) == files["/api/tables"]


def test_a_damaged_download_is_rejected() -> None:
    damaged = httpx.MockTransport(lambda _: httpx.Response(200, content=b"other bytes"))
    with Client("http://server", transport=damaged) as client, pytest.raises(ValueError, match="damaged"):
        client.table("0" * 64)


def test_a_broken_event_stream_is_resumed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("galewood_server.cli.client.time.sleep", lambda _: None)
    answers = iter(["running", None, None, "running", "done"])

    def answer(_: httpx.Request) -> httpx.Response:
        state = next(answers)
        if state is None:
            raise httpx.ConnectError("gone")
        event = f"event: progress\ndata: {json.dumps({'state': state})}\n\n"
        return httpx.Response(200, headers={"content-type": "text/event-stream"}, text=event)

    # each response ends after one event, although the job is still running
    with Client("http://server", transport=httpx.MockTransport(answer)) as client:
        assert [job["state"] for job in client.follow("x")] == ["running", "running", "done"]


def test_the_upload_command_writes_the_table(server: Server, mesh: Path, tmp_path: Path) -> None:
    table, report = tmp_path / "oak.gwt", tmp_path / "oak.json"
    mesh = mesh.with_name("bare.obj")
    mesh.write_bytes(b"another oak")
    arguments = ["upload", str(mesh), "--server", server.url, "--out", str(table), "--json", str(report)]
    refused = run(app, arguments)
    assert refused.exit_code == 1 and not table.exists()
    assert run(app, [*arguments, "--key", KEY, "--inspect"]).exit_code == 0
    assert json.loads(report.read_text())["state"] == "uploaded" and not table.exists()
    assert run(app, [*arguments, "--key", KEY]).exit_code == 0
    assert table.read_bytes() == b"table of another oak"
    assert json.loads(report.read_text())["state"] == "ready"
    away = run(app, ["upload", str(mesh), "--server", "http://127.0.0.1:9"])
    assert away.exit_code == 1


def test_the_stream_yields_messages(server: Server) -> None:
    async def told() -> list[Reply]:
        return [reply async for reply in stream(server.url, FOREST)]

    replies = anyio.run(told)
    assert isinstance(replies[0], Welcome) and replies[0].tick_hz == 30
    # the table does not exist: an error is sent before the socket is closed
    assert isinstance(replies[-1], Failure) and replies[-1].title


def logged(server: Server, request_id: str) -> list[dict[str, Any]]:
    """Log lines of a request."""
    whole = [line for line in server.log().splitlines(keepends=True) if line[0] == "{" and line[-1] == "\n"]
    return [line for line in map(json.loads, whole) if line.get("request_id") == request_id]


def test_json_logs_have_request_fields(server: Server) -> None:
    headers = {"X-Request-ID": "find-me.1"}
    httpx.get(f"{server.url}/api/trees/none", headers=headers)
    (line,) = wait_until(lambda: logged(server, "find-me.1"))  # may be written after the response
    assert (line["status"], line["method"], line["path"]) == (404, "GET", "/api/trees/none")
    assert line["timestamp"] and line["level"] == "info" and line["ms"] >= 0
    assert KEY not in server.log()


def test_the_key_command_prints_key_and_hash() -> None:
    made = run(app, ["key"]).output.split()
    assert made[0] == "key" and made[1].startswith("gw_") and len(made[3]) == 64
