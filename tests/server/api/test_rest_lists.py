"""REST lists, pagination, ETags and idempotent uploads and jobs."""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest
import zstandard
from galewood.constants import TABLE_VERSION
from galewood_server.http.etags import etag_matches
from galewood_server.storage.encodings import coding_of

from tests.server.support.server_process import FAKE_JOB, FAKE_SERVER, NO_CLUSTER, Server, wait_until


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    environment = {
        "GALEWOOD_JOB_MODULE": FAKE_JOB,
        "FAKE_STEP_S": "0.01",
        **NO_CLUSTER,
    }
    data_dir = tmp_path_factory.mktemp("trees") / "data"
    data_dir.mkdir()
    server = Server(data_dir, FAKE_SERVER, environment).start()
    yield server
    server.stop()


@pytest.fixture
def api(server: Server) -> Iterator[httpx.Client]:
    with server.client() as client:
        yield client


def upload(
    api: httpx.Client, data: bytes, filename: str = "a.obj", path: str = "/api/trees", **fields: str
) -> Any:
    return api.post(path, files={"file": (filename, data)}, data=fields)


def built(api: httpx.Client, data: bytes) -> dict[str, Any]:
    tree = upload(api, data, path="/api/trees?build=true").json()
    path = f"/api/trees/{tree['id']}"
    return wait_until(lambda: (now := api.get(path).json())["state"] == "ready" and now)


def test_the_same_file_gives_the_same_tree(api: httpx.Client) -> None:
    first = upload(api, b"once", name="One")
    again = upload(api, b"once", "other.obj", name="Two")
    assert (first.status_code, again.status_code) == (201, 200)
    assert again.json() == first.json()
    other = upload(api, b"once", height_m="9")
    assert other.status_code == 201 and other.json()["id"] != first.json()["id"]


def test_concurrent_uploads_of_one_file_give_one_tree(api: httpx.Client, server: Server) -> None:
    def send(_: int) -> tuple[int, str]:
        with server.client() as client:
            answer = upload(client, b"at once")
            return answer.status_code, answer.json()["id"]

    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(send, range(8)))
    assert len({name for _, name in answers}) == 1
    assert sorted(status for status, _ in answers) == [200] * 7 + [201]


def test_import_options_can_be_changed_until_there_is_a_table(api: httpx.Client) -> None:
    tree = upload(api, b"assumed", species="maple").json()
    path = f"/api/trees/{tree['id']}"
    changed = api.patch(path, json={"species": "poplar", "height_m": 7}).json()
    assert (changed["species"], changed["height_m"], changed["id"]) == ("poplar", 7, tree["id"])
    back = api.patch(path, json={"species": None, "name": "Mine"}).json()
    assert (back["species"], back["height_m"], back["name"]) == (None, 7, "Mine")
    twin = upload(api, b"assumed", species="maple")
    assert twin.status_code == 201 and twin.json()["id"] != tree["id"]
    api.post("/api/jobs", json={"tree_id": tree["id"]})
    wait_until(lambda: api.get(path).json()["state"] == "ready")
    refused = api.patch(path, json={"height_m": 8})
    assert (refused.status_code, refused.json()["code"]) == (409, "already-built")
    assert api.patch(path, json={"name": "Still mine"}).json()["name"] == "Still mine"
    for wrong in ({"height_m": -1}, {"wood_parts": []}, {"colour": 1}, {"name": ""}):
        assert api.patch(path, json=wrong).status_code == 422


def test_pagination_is_stable_during_uploads(api: httpx.Client) -> None:
    names = {upload(api, f"page {k}".encode()).json()["id"] for k in range(7)}
    seen: list[str] = []
    page = api.get("/api/trees?limit=3").json()
    while True:
        seen += [tree["id"] for tree in page["trees"]]
        if page["next"] is None:
            break
        upload(api, f"late {len(seen)}".encode())
        page = api.get("/api/trees", params={"limit": 3, "after": page["next"]}).json()
        if len(seen) > 60:
            break
    assert len(seen) == len(set(seen)) and names <= set(seen)
    assert len(seen) == page["total"]


@pytest.mark.parametrize("path", ["/api/trees", "/api/jobs", "/api/tables"])
def test_invalid_pages_are_problems(api: httpx.Client, path: str) -> None:
    for query in ("after=x", "after=WyJhIl0", "after=%00", "limit=0", "limit=9999", "after=" + "a" * 500):
        answer = api.get(f"{path}?{query}")
        assert answer.status_code == 422 and answer.json()["code"] in ("bad-cursor", "invalid-request"), query


def cursor(*parts: str) -> str:
    return base64.urlsafe_b64encode(json.dumps(parts).encode()).decode().rstrip("=")


JSON = {"Content-Type": "application/json"}
NOW = "2026-01-01T00:00:00+00:00"
TIMES = ("0001-01-01T00:00:00+14:00", "9999-12-31T23:59:59-14:00", "0001-01-01", "soon", "2026-01-01\0")


@pytest.mark.parametrize("path", ["/api/trees", "/api/jobs", "/api/tables"])
def test_cursors_out_of_range_are_problems(api: httpx.Client, path: str) -> None:
    first = ["0"] if path == "/api/trees" else []
    wrong = [cursor(*first, time, "id") for time in TIMES]
    wrong += [cursor(*first, NOW, text) for text in ("a\0b", "\ud800", "\udfff")]
    if first:
        wrong += [cursor(number, NOW, "id") for number in ("9" * 30, "-1", "2", "\u0661")]
    for one in wrong:
        answer = api.get(path, params={"after": one})
        assert answer.status_code == 422 and answer.json()["code"] == "bad-cursor", (path, one)
    for time in ("0001-01-02T00:00:00+00:00", "9999-12-30T00:00:00+00:00"):
        assert api.get(path, params={"after": cursor(*first, time, "id")}).status_code == 200


def test_nul_in_addresses_and_names_is_a_problem(api: httpx.Client) -> None:
    tree = upload(api, b"a tree with a name").json()
    answers = [
        api.get(path)
        for path in (
            "/api/trees/a%00b",
            "/api/jobs/%00",
            "/api/jobs/%00/events",
            "/api/jobs?tree_id=a%00",
            "/%00",
        )
    ]
    answers += [
        api.delete("/api/trees/%00"),
        api.patch("/api/trees/%00", json={"name": "x"}),
        api.patch(f"/api/trees/{tree['id']}", json={"name": "a\0b"}),
        api.patch(f"/api/trees/{tree['id']}", content=b'{"name": "\\ud800"}', headers=JSON),
        api.post("/api/jobs", json={"tree_id": "a\0"}),
        upload(api, b"another", name="a\0b"),
    ]
    for answer in answers:
        assert answer.status_code == 422, (answer.request.url, answer.text)
        assert answer.headers["content-type"] == "application/problem+json"
    assert api.get(f"/api/trees/{tree['id']}").json()["name"] == tree["name"]


@pytest.mark.parametrize("origin", ["http://[", "http://[::1", "//[", "null", "http://]"])
def test_malformed_origins_are_foreign(api: httpx.Client, origin: str) -> None:
    answer = api.delete("/api/trees/none", headers={"Origin": origin})
    assert answer.status_code == 403 and answer.json()["code"] == "foreign-origin"
    upgrade = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    upgrade |= {"Sec-WebSocket-Key": "Z2FsZXdvb2QtYmVuY2gtMQ=="}
    assert api.get("/ws/forest", headers={"Origin": origin, **upgrade}).status_code == 403


def test_jobs_are_listed_newest_first_and_can_be_retried(api: httpx.Client) -> None:
    tree = upload(api, b"fails", "fail.obj").json()
    job = api.post("/api/jobs", json={"tree_id": tree["id"], "settings": {"height_m": 6}}).json()
    wait_until(lambda: api.get(f"/api/jobs/{job['id']}").json()["state"] == "failed")
    again = api.post(f"/api/jobs/{job['id']}/retry")
    assert again.status_code == 202 and again.json()["id"] != job["id"]
    wait_until(lambda: api.get(f"/api/jobs/{again.json()['id']}").json()["state"] == "failed")
    listed = api.get("/api/jobs", params={"tree_id": tree["id"], "limit": 1}).json()
    assert listed["total"] == 2 and [one["id"] for one in listed["jobs"]] == [again.json()["id"]]
    rest = api.get("/api/jobs", params={"tree_id": tree["id"], "after": listed["next"]}).json()
    assert [one["id"] for one in rest["jobs"]] == [job["id"]] and rest["next"] is None
    assert api.get("/api/jobs?state=failed").json()["total"] >= 2
    assert api.post("/api/jobs/none/retry").json()["code"] == "no-such-job"
    assert api.post("/api/jobs", json={"tree_id": "none"}).json()["code"] == "no-such-tree"


def test_an_existing_table_is_not_computed_again(api: httpx.Client) -> None:
    tree = built(api, b"twice asked")
    again = api.post("/api/jobs", json={"tree_id": tree["id"]})
    assert (again.status_code, again.json()["id"]) == (200, tree["job_id"])
    wait_until(lambda: api.get(f"/api/jobs/{tree['job_id']}").json()["state"] == "done")
    other = api.post("/api/jobs", json={"tree_id": tree["id"], "settings": {"design_speed_m_s": 9}})
    assert other.status_code == 202 and other.json()["id"] != tree["job_id"]
    api.post(f"/api/jobs/{other.json()['id']}/cancel")


def test_lists_and_trees_have_etags(api: httpx.Client) -> None:
    tree = upload(api, b"tagged").json()
    wait_until(lambda: not _unfinished(api))  # jobs of other tests, which change the lists
    for path in ("/api/trees", f"/api/trees/{tree['id']}", "/api/jobs", "/api/tables", "/api/species"):
        whole = api.get(path)
        tag = whole.headers["etag"]
        same = api.get(path, headers={"If-None-Match": f'"x", {tag}'})
        strong = api.get(path, headers={"If-None-Match": tag.removeprefix("W/")})
        assert strong.status_code == 304
        assert same.status_code == 304 and not same.content and same.headers["etag"] == tag
    api.patch(f"/api/trees/{tree['id']}", json={"name": "Changed"})
    assert api.get("/api/trees", headers={"If-None-Match": tag}).status_code == 200


def _unfinished(api: httpx.Client) -> list[str]:
    jobs = api.get("/api/jobs?limit=500").json()["jobs"]
    return [job["id"] for job in jobs if job["state"] in ("queued", "running")]


def test_compressed_tables_have_their_own_etag(api: httpx.Client, server: Server) -> None:
    table = built(api, b"compressed")["table_sha256"]
    path = f"/api/tables/{table}"
    raw: dict[str, bytes] = {}
    tags: set[str] = set()
    for name in ("identity", "gzip", "zstd"):
        # the first request does not wait for the compression
        wait_until(lambda name=name: _coding(api, path, name) == name)
        with api.stream("GET", path, headers={"Accept-Encoding": name}) as answer:
            raw[name] = b"".join(answer.iter_raw())
            assert answer.headers.get("content-encoding", "identity") == name
            assert (
                answer.headers["vary"] == "Accept-Encoding" and "immutable" in answer.headers["cache-control"]
            )
            tags.add(answer.headers["etag"])
        assert (
            api.get(
                path, headers={"Accept-Encoding": name, "If-None-Match": answer.headers["etag"]}
            ).status_code
            == 304
        )
    assert len(tags) == 3 and hashlib.sha256(raw["identity"]).hexdigest() == table
    assert gzip.decompress(raw["gzip"]) == raw["identity"] == zstandard.decompress(raw["zstd"])
    kept = list((server.data_dir / "cache" / "encoded").rglob(table))
    assert len(kept) == 2
    part = api.get(path, headers={"Accept-Encoding": "zstd", "Range": "bytes=3-9"})
    assert (part.status_code, part.content) == (206, raw["identity"][3:10])
    changed = api.get(
        path, headers={"Range": "bytes=3-9", "If-Range": '"other"', "Accept-Encoding": "identity"}
    )
    assert (changed.status_code, changed.content) == (200, raw["identity"])
    assert api.get(path, headers={"Range": "bytes=900000-"}).status_code == 416
    assert api.get(path, headers={"Range": "bytes=2-1"}).json()["code"] == "bad-range"
    unknown = api.get(path, headers={"Range": "leaves=1-2", "Accept-Encoding": "identity"})
    assert (unknown.status_code, unknown.content) == (200, raw["identity"])
    head = api.head(path, headers={"Accept-Encoding": "identity"})
    assert head.headers["content-length"] == str(len(raw["identity"])) and not head.content


def test_the_etag_of_the_plain_bytes_matches_after_compression(api: httpx.Client) -> None:
    path = f"/api/tables/{built(api, b'held plain')['table_sha256']}"
    plain = api.get(path, headers={"Accept-Encoding": "identity"}).headers["etag"]
    wait_until(lambda: _coding(api, path, "gzip") == "gzip")
    assert api.get(path, headers={"Accept-Encoding": "gzip", "If-None-Match": plain}).status_code == 304


def _coding(api: httpx.Client, path: str, accepted: str) -> str:
    answer = api.get(path, headers={"Accept-Encoding": accepted})
    assert answer.content and answer.status_code == 200
    return answer.headers.get("content-encoding", "identity")


@pytest.mark.parametrize(
    ("header", "coding"),
    [("", None), ("gzip", "gzip"), ("gzip, zstd", "zstd"), ("br", None), ("*", "zstd"),
     ("zstd;q=0, gzip", "gzip"),
     ("gzip;q=0.5, zstd;q=0.1", "gzip"), ("identity, gzip;q=0.5", None), ("gzip;q=x", None), ("*;q=0", None)],
)  # fmt: skip
def test_content_coding_negotiation(header: str, coding: str | None) -> None:
    assert coding_of(header) == coding


def test_etags_are_compared_exactly() -> None:
    assert etag_matches('"a"', '"a"') and etag_matches('W/"a", "b"', '"a"') and etag_matches("*", '"a"')
    assert not etag_matches('"ab"', '"a"') and not etag_matches("", '"a"') and not etag_matches("a", '"a"')


def test_tables_are_listed_and_unreadable_ones_are_problems(api: httpx.Client) -> None:
    tree = built(api, b"listed")
    listed = api.get("/api/tables?limit=500").json()["tables"]
    one = next(table for table in listed if table["tree_id"] == tree["id"])
    assert one["sha256"] == tree["table_sha256"] and one["size_bytes"] == len(b"table of listed")
    said = api.get(f"/api/tables/{one['sha256']}/metadata")
    assert (said.status_code, said.json()["code"]) == (409, "unreadable-table")


def test_wood_species_have_sources(api: httpx.Client) -> None:
    species = api.get("/api/species").json()["species"]
    assert {"maple", "poplar", "apricot"} <= {one["id"] for one in species}
    assert all(one["source"] and one["young_longitudinal_pa"] > 1e9 for one in species)


def test_health_and_metrics(api: httpx.Client) -> None:
    live, ready = api.get("/api/health"), api.get("/api/health/ready")
    assert live.json()["status"] == "ok" and live.json()["table_version"] == TABLE_VERSION
    assert ready.status_code == 200 and ready.json()["checks"]["database"] is True
    text = api.get("/metrics").text
    for name in (
        "galewood_jobs{",
        "galewood_trees{",
        "galewood_stored_bytes",
        "process_resident_memory_bytes",
    ):
        assert name in text
