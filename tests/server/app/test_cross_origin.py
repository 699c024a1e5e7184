"""Pages of other origins: reads, frames and sockets where the operator allows them, and nothing elsewhere.
HTTP semantics that such clients rely on: HEAD, Allow, Location, ranges, compressed JSON.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator

import httpx
import pytest
import websockets
from galewood_server.settings import Settings

from tests.server.support.server_process import Server, fake_service

FRIEND, STRANGER = "https://garden.example", "https://elsewhere.example"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    origins = json.dumps([FRIEND])
    with fake_service(tmp_path_factory.mktemp("origins"), GALEWOOD_ALLOWED_ORIGINS=origins) as server:
        yield server


@pytest.fixture
def api(server: Server) -> Iterator[httpx.Client]:
    with server.client() as client:
        yield client


@pytest.fixture(scope="module")
def tree(server: Server) -> dict[str, str]:
    with server.client() as api:
        return api.post("/api/trees", files={"file": ("oak.obj", b"an oak")}).json()


@pytest.mark.parametrize("path", ["/api/trees", "/api/meshes/{mesh}", "/openapi.json", "/api/none"])
def test_an_allowed_origin_reads_and_a_stranger_does_not(
    api: httpx.Client, tree: dict[str, str], path: str
) -> None:
    path = path.format(mesh=tree["mesh_sha256"])
    friendly = api.get(path, headers={"Origin": FRIEND})
    assert friendly.headers["access-control-allow-origin"] == FRIEND
    exposed = friendly.headers["access-control-expose-headers"].lower()
    assert {"etag", "location", "content-range"} <= set(exposed.replace(" ", "").split(","))
    for given in ({"Origin": STRANGER}, {}):
        answer = api.get(path, headers=given)
        assert "access-control-allow-origin" not in answer.headers
        assert "origin" in answer.headers["vary"].lower()


def test_preflight_of_a_write_with_a_key(api: httpx.Client) -> None:
    asked = {
        "Access-Control-Request-Method": "POST",
        "Access-Control-Request-Headers": "authorization, content-type",
    }
    answer = api.options("/api/jobs", headers={"Origin": FRIEND, **asked})
    assert answer.status_code == 200
    assert "POST" in answer.headers["access-control-allow-methods"]
    assert "authorization" in answer.headers["access-control-allow-headers"].lower()
    assert api.options("/api/jobs", headers={"Origin": STRANGER, **asked}).status_code == 400


def test_only_allowed_origins_may_show_the_page_in_a_frame(api: httpx.Client) -> None:
    policy = api.get("/").headers["content-security-policy"]
    assert f"frame-ancestors 'self' {FRIEND}" in policy


@pytest.mark.parametrize(("origin", "opens"), [(FRIEND, True), (STRANGER, False)])
def test_the_socket_opens_for_allowed_origins(server: Server, origin: str, opens: bool) -> None:
    async def connect() -> bool:
        address = server.url.replace("http", "ws") + "/ws/forest"
        try:
            async with websockets.connect(address, origin=websockets.Origin(origin)):
                return True
        except websockets.InvalidStatus:
            return False

    assert asyncio.run(connect()) is opens


def test_origins_are_checked_at_start() -> None:
    with pytest.raises(ValueError, match="expected origins"):
        Settings(allowed_origins=["garden.example; script-src *"])


def test_head_works_wherever_get_does(api: httpx.Client, tree: dict[str, str]) -> None:
    names = {"tree_id": tree["id"], "sha256": tree["mesh_sha256"]}
    paths = api.get("/openapi.json").json()["paths"]
    checked = 0
    for path, operations in paths.items():
        if "get" not in operations:
            continue
        filled = path.format_map({**dict.fromkeys(_names(path), "none"), **names})
        head = api.head(filled)
        assert head.status_code != 405, path
        assert head.content == b"", path
        if "events" not in path:
            got = api.get(filled)
            assert head.status_code == got.status_code, path
            assert head.headers["content-type"] == got.headers["content-type"], path
        checked += 1
    assert checked > 15


def _names(path: str) -> list[str]:
    return [part.partition("}")[0] for part in path.split("{")[1:]]


def test_head_of_an_event_stream_ends(api: httpx.Client) -> None:
    answer = api.head("/api/events")
    assert answer.headers["content-type"].startswith("text/event-stream")


@pytest.mark.parametrize(
    ("path", "methods"),
    [
        ("/api/trees/none", {"GET", "HEAD", "PATCH", "DELETE"}),
        ("/api/jobs", {"GET", "HEAD", "POST"}),
        ("/index.html", {"GET", "HEAD"}),
    ],
)
def test_allow_lists_all_methods_of_a_path(api: httpx.Client, path: str, methods: set[str]) -> None:
    answer = api.put(path)
    assert answer.status_code == 405
    assert set(answer.headers["allow"].split(", ")) == methods


def test_new_things_say_where_they_are(api: httpx.Client) -> None:
    created = api.post("/api/trees", files={"file": ("elm.obj", b"an elm")})
    assert created.status_code == 201
    assert created.headers["location"] == f"/api/trees/{created.json()['id']}"
    started = api.post("/api/jobs", json={"tree_id": created.json()["id"]})
    assert started.status_code == 202
    assert api.get(started.headers["location"]).json()["id"] == started.json()["id"]


def test_ranges(api: httpx.Client, tree: dict[str, str]) -> None:
    path = f"/api/meshes/{tree['mesh_sha256']}"
    whole = api.get(path).content
    assert api.get(path, headers={"Range": "bytes=1-2"}).content == whole[1:3]
    unknown = api.get(path, headers={"Range": "items=0-5"})
    assert (unknown.status_code, unknown.content) == (200, whole)
    for given, status in (
        ("bytes=5-2", 400),
        ("bytes=", 400),
        (f"bytes={len(whole)}-", 416),
        ("bytes=-0", 416),
    ):
        answer = api.get(path, headers={"Range": given})
        assert answer.status_code == status, given
        assert answer.headers["content-type"] == "application/problem+json"
    assert answer.headers["content-range"] == f"bytes */{len(whole)}"


def test_json_is_compressed_and_its_copy_is_revalidated(api: httpx.Client) -> None:
    path = "/openapi.json"
    plain = api.get(path, headers={"Accept-Encoding": "identity"})
    packed = api.get(path, headers={"Accept-Encoding": "gzip"})
    assert "content-encoding" not in plain.headers
    assert packed.headers["content-encoding"] == "gzip"
    assert packed.json() == plain.json()
    trees = api.get("/api/trees", headers={"Accept-Encoding": "gzip"})
    assert trees.headers["etag"].startswith("W/")
    again = api.get("/api/trees", headers={"Accept-Encoding": "gzip", "If-None-Match": trees.headers["etag"]})
    assert again.status_code == 304
