"""The page's files are sent compressed where the build has made copies and the client accepts them."""

from __future__ import annotations

import gzip
from pathlib import Path
from urllib.parse import unquote

import anyio
import httpx
import pytest
from fastapi import FastAPI
from galewood_server.app.headers import policy_of
from galewood_server.app.main import create_app
from galewood_server.app.page import Page
from galewood_server.settings import Settings
from pydantic import ValidationError
from starlette.datastructures import Headers
from starlette.types import Message, Scope

from tests.server.access.test_access_control import ask

SCRIPT = b"export const answer = 42;\n" * 200


@pytest.fixture
def app(tmp_path: Path) -> FastAPI:
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("<!doctype html><title>Galewood</title>")
    script = tmp_path / "assets" / "index-abc.js"
    script.write_bytes(SCRIPT)
    Path(f"{script}.gz").write_bytes(gzip.compress(SCRIPT))
    Path(f"{script}.br").write_bytes(b"stands for the Brotli copy")
    (tmp_path / "assets" / "plain-abc.js").write_bytes(b"1;")
    app = FastAPI()
    app.mount("/", Page(tmp_path))
    return app


def get(app: FastAPI, accepted: str, path: str = "/assets/index-abc.js", **headers: str) -> httpx.Response:
    return ask(app, "GET", path, headers={"accept-encoding": accepted, **headers})


@pytest.mark.parametrize(
    ("accepted", "coding"),
    [
        ("gzip, deflate, br", "br"),
        ("gzip", "gzip"),
        ("br;q=0.2, gzip", "gzip"),
        ("", None),
        ("gzip;q=0", None),
    ],
)
def test_the_copy_follows_accept_encoding(app: FastAPI, accepted: str, coding: str | None) -> None:
    if coding == "br":  # the client here cannot decode it
        answer = ask(app, "HEAD", "/assets/index-abc.js", headers={"accept-encoding": accepted})
    else:
        answer = get(app, accepted)
        assert answer.content == SCRIPT
    assert answer.headers.get("content-encoding") == coding
    assert answer.headers["content-type"].startswith("text/javascript")
    assert answer.headers["vary"] == "Accept-Encoding"
    assert "immutable" in answer.headers["cache-control"]


def test_each_representation_has_its_own_etag(app: FastAPI) -> None:
    zipped, plain = get(app, "gzip"), get(app, "")
    assert zipped.headers["etag"] != plain.headers["etag"]
    current = get(app, "gzip", **{"if-none-match": zipped.headers["etag"]})
    assert current.status_code == 304 and current.headers["vary"] == "Accept-Encoding"
    assert get(app, "gzip", **{"if-none-match": plain.headers["etag"]}).status_code == 200


def test_a_file_without_copies_is_sent_as_it_is(app: FastAPI) -> None:
    answer = get(app, "gzip, br", "/assets/plain-abc.js")
    assert answer.content == b"1;"
    assert "content-encoding" not in answer.headers


def test_only_configured_sites_may_frame_the_page() -> None:
    assert "frame-ancestors 'self'" in policy_of("/").split("; ")
    blog = Settings(frame_ancestors=["https://blog.example", "http://localhost:4000"]).frame_ancestors
    assert policy_of("/", blog).endswith(
        "; frame-ancestors 'self' https://blog.example http://localhost:4000"
    )
    assert "frame-ancestors 'none'" in policy_of("/api/trees", blog)
    for wrong in ("https://a.example; script-src *", "blog.example", "'unsafe-inline'"):
        with pytest.raises(ValidationError):
            Settings(frame_ancestors=[wrong])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> FastAPI:
    """The assembled application, with a page that has folders."""
    folder = tmp_path_factory.mktemp("page")
    for part in (folder, folder / "guide"):
        part.mkdir(exist_ok=True)
        (part / "index.html").write_text("<!doctype html><title>Galewood</title>")
    return create_app(Settings(page_dir=folder, data_dir=folder / "data", api_keys=["0" * 64]))


OUTSIDE = (
    "//{}/..", "//{}/%2e%2e", "//{}/.", "///{}", "///{}/..", "////{}/%2e%2e", "/\\{}", "/\\{}/..",
    "/%5c{}/..", "/%5c%5c{}", "/.//{}", "/.//{}/..", "/./{}/..", "/%2f{}/..", "/%2f%2f{}/%2e%2e",
    "/x/..//{}/..", "//{}", "//{}/guide/..", "//{}/../guide", "//{}/", "/guide", "//guide", "/guide/..",
    "/guide/.", "/docs/files", "//{}/docs/files", "/docs/", "//docs", "/api/trees/", "//{}/api/trees/",
    "/api/trees//", "/;@{}/..", "/api/trees/%2f{}/..", "/%09/{}/..", "/http://{}/..", "http://{}/..",
    "http://{}/guide", "http://{}", "{}", "{}/..", "/..//{}", "/%2e%2e/%2e%2e//{}/..",
)  # fmt: skip


@pytest.mark.parametrize("path", OUTSIDE)
@pytest.mark.parametrize("method", ["GET", "HEAD"])
def test_no_redirect_leaves_the_server(whole: FastAPI, method: str, path: str) -> None:
    """Neither to a host in the path nor to that of the Host header, which somebody else may have chosen."""
    target = path.format("evil.example")
    scope: Scope = {
        "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": method, "scheme": "http",
        "path": unquote(target), "raw_path": target.encode(), "query_string": b"", "root_path": "",
        "headers": [(b"host", b"evil.example")], "client": ("127.0.0.1", 5), "server": ("127.0.0.1", 80),
    }  # fmt: skip
    sent: list[Message] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        sent.append(message)

    anyio.run(whole, scope, receive, send)
    assert sent[0]["status"] == 404 or not path.startswith(("//", "http"))
    assert not 300 <= sent[0]["status"] < 400
    assert "location" not in Headers(raw=sent[0]["headers"])


def test_the_page_has_one_address(app: FastAPI) -> None:
    expected = {"/": 200, "/index.html": 200, "/?trees=5": 200, "/none": 404}
    assert {path: ask(app, "GET", path).status_code for path in expected} == expected
