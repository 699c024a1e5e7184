"""The wind risk of a visitor's inventory: what the service answers, and what it refuses."""

from __future__ import annotations

import csv
import json
import re
import socket
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import httpx
import pytest
from galewood.check.stand import StandOptions, StandReport, shipped_forms, stand_report
from galewood.check.stand.limited import MOST_STEMS
from galewood.check.stand.report import StemRisk
from galewood.measurements import read_inventory
from galewood.solid.strain import CAUTION_TEXT
from galewood_server.api.stand_risks import StemRiskOut

from tests.server.support.server_process import Server, command_line, fake_service, wait_until

PATH = "/api/stand-risk"
ROWS = [
    "lon;lat;Baumart;Höhe (m);BHD (cm)",
    "8.40000;49.00000;Rotbuche;21,5;24",
    "8.40006;49.00000;Fagus sylvatica;21,5;24",
    "8.40003;49.00005;Zitterpappel;;19",
    "8.40009;49.00005;Unbekannt;12;",
]
STAND = "\n".join(ROWS)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    # anyone may ask, also where nobody may write
    with fake_service(tmp_path_factory.mktemp("risk"), GALEWOOD_LOCAL_WRITES="false") as server:
        yield server


@pytest.fixture(scope="module")
def api(server: Server) -> Iterator[httpx.Client]:
    with server.client() as client:
        yield client


def asked(api: httpx.Client, content: str | bytes, **query: str | float) -> httpx.Response:
    return api.post(PATH, content=content, params=query, timeout=120)


def expected(content: bytes, foliage: str = "leaf", wind_m_s: float = 20.0) -> StandReport:
    forms = shipped_forms("bare" if foliage == "bare" else "leaf")
    return stand_report(read_inventory(content), forms, StandOptions(wind_m_s=wind_m_s))


def rows_of(count: int) -> str:
    return "x,y,height,dbh\n" + "".join(f"{4 * (k % 70)},{4 * (k // 70)},20,25\n" for k in range(count))


def test_the_answer_is_the_report_in_the_order_of_the_inventory(api: httpx.Client) -> None:
    answer = asked(api, STAND, foliage="bare", speed_m_s=25)
    assert answer.status_code == 200, answer.text
    found, report = answer.json(), expected(STAND.encode(), "bare", 25.0).document()
    report["stems"].sort(key=lambda stem: stem["index"])
    assert found == json.loads(json.dumps(report))
    assert found["caution"] == CAUTION_TEXT
    stems: list[dict[str, Any]] = found["stems"]
    assert [stem["index"] for stem in stems] == [0, 1, 2, 3]
    assert sorted(stem["rank"] for stem in stems) == [1, 2, 3, 4]
    assert [stem["height_estimated"] for stem in stems] == [False, False, True, False]
    assert [stem["dbh_assumed"] for stem in stems] == [False, False, False, True]
    assert stems[0]["strain"] == pytest.approx(stems[1]["strain"], rel=0.05)  # German and Latin: one species
    assert set(StemRiskOut.model_fields) == set(stems[0]) == {field.name for field in fields(StemRisk)}


def test_a_document_gives_the_same_as_the_file_it_was_made_from(api: httpx.Client) -> None:
    document = api.post("/api/convert", content=STAND).content
    of_file, of_document = asked(api, STAND).json(), asked(api, document).json()
    for one in of_file["stems"]:
        one["lon_deg"] = one["lat_deg"] = None  # a document has metres
    assert of_document == of_file


def test_a_table_is_sent_as_csv(api: httpx.Client) -> None:
    answer = asked(api, STAND, format="csv")
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    lines = answer.text.splitlines()
    assert lines[0] == f"# {CAUTION_TEXT}"
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert [row["rank"] for row in rows] == ["1", "2", "3", "4"]
    assert {row["lon_deg"] for row in rows} == {"8.4", "8.40006", "8.40003", "8.40009"}


@pytest.mark.parametrize(
    ("content", "query", "status", "code", "hint"),
    [
        ("x,y,height\n0,,3\n", {}, 422, "bad-inventory", "No row describes a tree (line 2: no coordinates)."),
        ("a,b\n1,2\n", {}, 422, "bad-inventory", ""),
        ("", {}, 422, "bad-inventory", ""),
        (b"\x00\xff" * 500, {}, 422, "bad-inventory", ""),
        ('{"version": 1, "stems": [{}]}', {}, 422, "bad-inventory", "galewood convert"),
        (rows_of(MOST_STEMS + 1), {}, 413, "too-many-stems", "galewood stand"),
        (STAND, {"speed_m_s": 0}, 422, "invalid-request", ""),
        (STAND, {"foliage": "autumn"}, 422, "invalid-request", ""),
    ],
)
def test_what_is_wrong_is_said(
    api: httpx.Client, content: str | bytes, query: dict[str, str], status: int, code: str, hint: str
) -> None:
    answer = asked(api, content, **query)
    body = answer.json()
    assert (answer.status_code, body["code"]) == (status, code), answer.text
    assert hint in body["hint"]
    if code == "too-many-stems":
        assert f"{MOST_STEMS + 1} stems" in body["title"] and f"at most {MOST_STEMS}" in body["title"]


def calculations(server: Server) -> int:
    """How many reports are being computed."""
    return sum("stand_in_child" in " ".join(command_line(one)) for one in server.family())


def test_a_client_that_leaves_ends_its_calculation(server: Server, api: httpx.Client) -> None:
    body = rows_of(MOST_STEMS).encode()
    head = f"POST {PATH} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {len(body)}\r\n\r\n".encode()
    with socket.create_connection(("127.0.0.1", server.port)) as client:
        client.sendall(head + body)
        wait_until(lambda: calculations(server) > 0)
    wait_until(lambda: calculations(server) == 0)
    label = f'galewood_http_requests_total{{method="POST",route="{re.escape(PATH)}",status="499"}}'
    wait_until(lambda: re.search(label, api.get("/metrics").text))
    assert asked(api, STAND).status_code == 200  # its turn is free again
    assert "Traceback" not in server.log()
