"""Inventories and anemometer records: what the service makes of a visitor's file, and of its own one."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import httpx
import pytest
from galewood.measurements import read_measurement
from galewood.measurements.inventory import read_inventory
from galewood_server.cli import commands
from galewood_server.cli.commands import app
from typer.testing import CliRunner

from tests.server.support.server_process import Server, fake_service, wait_until

CSV = "x,y,species,height,dbh\n0,0,Bergahorn,12,30\n3,4,Foo bar,9,\n5,5,oak,,\n"
LIMIT_BYTES = 1 << 20
MAST = "time (s),speed (m/s),direction\n" + "".join(f"{k},{6 + k % 3},270\n" for k in range(40))


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    # anyone may have files converted, also where nobody may write
    settings = {"GALEWOOD_LOCAL_WRITES": "false", "GALEWOOD_UPLOAD_BYTES": str(LIMIT_BYTES)}
    with (
        fake_service(tmp_path_factory.mktemp("convert"), **settings) as server,
        server.client() as client,
    ):
        yield client


def converted(api: httpx.Client, content: str | bytes, **query: float) -> httpx.Response:
    return api.post("/api/convert", content=content, params=query)


def problem(answer: httpx.Response) -> tuple[int, str, str]:
    body = answer.json()
    return answer.status_code, body["code"], body["hint"]


def test_an_inventory_becomes_its_document(api: httpx.Client) -> None:
    answer = converted(api, CSV)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/json"
    assert answer.json() == json.loads(json.dumps(read_inventory(CSV.encode()).document()))


def test_a_record_becomes_a_wind_document_with_a_report(api: httpx.Client) -> None:
    for query in ({}, {"start_s": 10.0}):
        expected = read_measurement(MAST.encode(), **query).document()
        assert converted(api, MAST, **query).json() == json.loads(json.dumps(expected))


def test_errors_name_the_line(api: httpx.Client) -> None:
    assert problem(converted(api, MAST.replace("\n3", "\n3,fast"))) == (
        422, "bad-measurement", "Line 5, column 'speed (m/s)': 'fast' is not a number.",
    )  # fmt: skip
    assert problem(converted(api, "x,y,height\n0,,3\n")) == (
        422, "bad-inventory", "No row describes a tree (line 2: no coordinates).",
    )  # fmt: skip
    assert problem(converted(api, '{"features": ')) == (
        422, "bad-inventory", "The file is not valid JSON.",
    )  # fmt: skip


@pytest.mark.parametrize("content", [b"", b"a,b\n1,2\n", b"\x00\xff" * 500, b'"' + b"a" * 50_000])
def test_other_files_are_of_an_unknown_kind(api: httpx.Client, content: bytes) -> None:
    assert problem(converted(api, content))[:2] == (415, "unknown-content")


def test_a_file_that_is_too_large_is_refused(api: httpx.Client) -> None:
    assert problem(converted(api, b"x" * (LIMIT_BYTES + 1))) == (413, "file-too-large", "Split the file.")


def test_a_start_beyond_the_record_is_refused(api: httpx.Client) -> None:
    assert converted(api, MAST, start_s=100.0).json()["code"] == "bad-measurement"
    assert converted(api, MAST, start_s=-1.0).json()["code"] == "invalid-request"


def test_the_inventory_of_the_service_is_converted_again_when_it_changes(
    start_server: Callable[..., Server], tmp_path: Path
) -> None:
    path = tmp_path / "Bäume.csv"
    path.write_text(CSV, encoding="utf-8")
    server = start_server(GALEWOOD_INVENTORY=str(path))
    with server.client() as api:
        for text in (CSV, "", CSV.replace("12,30", "15,30")):
            if text:  # otherwise asked again
                path.write_text(text, encoding="utf-8")
            answer = api.get("/api/inventory")
            assert answer.status_code == 200, answer.text
            assert answer.headers["content-disposition"].startswith("inline")
            assert answer.json() == json.loads(json.dumps(read_inventory(path).document()))
        assert len(list((server.data_dir / "cache" / "inventories").iterdir())) == 2
        path.write_text("x,y\n", encoding="utf-8")
        assert problem(api.get("/api/inventory"))[:2] == (415, "unknown-content")
        path.unlink()
        status, code, hint = problem(api.get("/api/inventory"))
        assert (status, code) == (404, "no-inventory") and "galewood forest" in hint


def test_one_address_has_two_places(api: httpx.Client) -> None:
    head = "POST /api/convert HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n"
    with ExitStack() as senders:

        def refused_beside_another_sender() -> bool:
            address = (api.base_url.host, api.base_url.port or 0)
            sender = senders.enter_context(socket.create_connection(address))
            sender.sendall(head.encode())  # and nothing of the body
            return converted(api, CSV).status_code == 503

        wait_until(refused_beside_another_sender)
        assert problem(converted(api, CSV))[:2] == (503, "busy")
    wait_until(lambda: converted(api, CSV).status_code == 200)


def test_the_command_reports_and_serves_the_stand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "stand.csv"
    path.write_text(CSV)
    served: list[tuple[object, ...]] = []
    monkeypatch.setattr(commands, "serve", lambda *given: served.append(given))
    monkeypatch.setenv("GALEWOOD_INVENTORY", "")
    result = CliRunner().invoke(app, ["forest", str(path), "--port", "8123"])
    assert result.exit_code == 0, result.output
    assert served == [(None, 8123, None)]
    assert os.environ["GALEWOOD_INVENTORY"] == str(path.resolve())
    assert "Trees: 2 of 3 rows" in result.stdout and "Foo bar" in result.stdout
    assert "http://127.0.0.1:8123/?inventory=api/inventory" in result.stdout


def test_the_command_refuses_other_files(tmp_path: Path) -> None:
    path = tmp_path / "wind.csv"
    path.write_text(MAST)
    result = CliRunner().invoke(app, ["forest", str(path)])
    assert result.exit_code == 1
    assert "could not be read: no column names were found" in " ".join(result.stderr.split())
