"""The API documentation page is served locally and complies with its security policy."""

from __future__ import annotations

import re
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI
from galewood_server.app.main import create_app
from galewood_server.settings import Settings

from tests.server.access.test_access_control import ask


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> FastAPI:
    return create_app(Settings(data_dir=tmp_path_factory.mktemp("data")))


def get(app: FastAPI, path: str) -> httpx.Response:
    return ask(app, "GET", path)


def test_the_page_loads_only_local_files(app: FastAPI) -> None:
    html = get(app, "/docs")
    assert html.headers["content-type"].startswith("text/html")
    named = re.findall(r'(?:src|href)="([^"]+)"', html.text)
    kinds = {".js": "javascript", ".css": "css", ".png": "image/png", ".json": "json"}
    assert {Path(name).suffix for name in named} == set(kinds)
    for name in named:
        answer = get(app, f"/{name}")
        assert answer.status_code == 200 and kinds[Path(name).suffix] in answer.headers["content-type"], name
        assert answer.headers["x-content-type-options"] == "nosniff"
    assert 'url: "openapi.json"' in get(app, "/docs/start.js").text


def test_the_policy_allows_no_host_and_the_page_has_no_inline_script(app: FastAPI) -> None:
    html = get(app, "/docs")
    policy = html.headers["content-security-policy"]
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    assert rules["default-src"] == "'none'" and rules["script-src"] == "'self'"
    assert "//" not in policy and "unsafe-eval" not in policy
    assert all(not body.strip() for body in re.findall(r"<script[^>]*>(.*?)</script>", html.text, re.DOTALL))
    assert get(app, "/docs/files/swagger-ui.css").headers["content-security-policy"] == policy


def test_there_is_no_other_reference_page(app: FastAPI) -> None:
    assert get(app, "/redoc").status_code == 404
    assert get(app, "/docs/oauth2-redirect").status_code == 404
    assert get(app, "/docs/files/../docs_page.py").status_code == 404
