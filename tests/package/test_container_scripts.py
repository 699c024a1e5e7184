"""The operators' scripts for the containers, with a program in place of Docker."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from email.message import Message
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import Any
from urllib.error import HTTPError

import pytest

from tests.server.support.server_process import FAKE_JOB, FAKE_SERVER, NO_CLUSTER, Server

REPOSITORY = Path(__file__).resolve().parents[2]
DIGEST = "sha256:" + "ab" * 32
FILES = ("docker-compose.yml", "Dockerfile")


@pytest.fixture(autouse=True)
def no_bytecode(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)


def script(name: str) -> ModuleType:
    path = REPOSITORY / "scripts" / name
    module = ModuleType(name)
    module.__file__ = str(path)
    SourceFileLoader(name, str(path)).exec_module(module)
    return module


@pytest.fixture
def docker(tmp_path: Path) -> Callable[[str], dict[str, str]]:
    """A `docker` that writes its arguments to a file and then does what is given in shell."""

    def make(does: str) -> dict[str, str]:
        program = tmp_path / "docker"
        program.write_text(f'#!/bin/sh\necho "$*" >> {tmp_path}/asked\n{does}\n')
        program.chmod(0o755)
        return {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}

    return make


def test_every_image_of_others_is_pinned() -> None:
    """A tag names another image whenever its publisher moves it."""
    command = [sys.executable, str(REPOSITORY / "scripts" / "pin-images"), "--check"]
    checked = subprocess.run(command, capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout
    texts = "".join((REPOSITORY / name).read_text() for name in FILES)
    named = re.findall(r"(?:image: +|FROM +|syntax=)(\S+)", texts)
    assert {name for name in named if "@sha256:" not in name} == {"galewood:0.1.0"}


def test_images_are_pinned_anew() -> None:
    pin = script("pin-images")
    for name in pin.FILES:
        text = re.sub("@sha256:[0-9a-f]{64}", "", (REPOSITORY / name).read_text())
        assert not any(pin.images(text).values())
        known = dict.fromkeys(pin.images(text), DIGEST)
        once = pin.pinned(text, known)
        assert known and all(pin.images(once).values())
        assert pin.pinned(once, known) == once  # a second run only updates
        assert re.sub("@sha256:[0-9a-f]{64}", "", once) == text
        assert "image: galewood:0.1.0\n" in once or name == "Dockerfile"


def test_digests_come_from_the_registry(docker: Callable[[str], dict[str, str]],
                                        monkeypatch: pytest.MonkeyPatch) -> None:  # fmt: skip
    pin = script("pin-images")
    monkeypatch.setattr(os, "environ", docker(f"echo {DIGEST}"))
    assert pin.digest_of("caddy:2.10-alpine") == DIGEST
    docker("echo unauthorized")
    with pytest.raises(SystemExit, match="unexpected digest"):
        pin.digest_of("caddy:2.10-alpine")


def test_the_build_stage_uses_a_supported_node() -> None:
    """Only even versions are supported for years (LTS); 20 is out of support."""
    found = re.search(r"^FROM node:(\d+)-", (REPOSITORY / "Dockerfile").read_text(), re.MULTILINE)
    assert found and int(found[1]) >= 22 and int(found[1]) % 2 == 0


def test_containers_that_do_not_start_are_taken_down(docker: Callable[[str], dict[str, str]],
                                                     tmp_path: Path) -> None:  # fmt: skip
    environment = docker('case "$*" in *" up "*) exit 1;; esac')
    command = [sys.executable, str(REPOSITORY / "scripts" / "compose-smoke")]
    assert subprocess.run(command, env=environment).returncode == 1
    asked = (tmp_path / "asked").read_text().splitlines()
    kinds = [re.sub(r".*--env-file \S+ (\w+).*", r"\1", line) for line in asked]
    assert kinds == ["up", "ps", "logs", "down"]
    assert all("galewood-smoke" in line for line in asked) and "--volumes" in asked[-1]


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    (tmp_path / "data").mkdir()
    environment = {
        "GALEWOOD_JOB_MODULE": FAKE_JOB,
        "FAKE_STEP_S": "0.01",
        **NO_CLUSTER,
    }
    server = Server(tmp_path / "data", FAKE_SERVER, environment).start()
    yield server
    server.stop()


def test_the_smoke_test_builds_a_tree(server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    smoke = script("compose-smoke")
    monkeypatch.setattr(smoke, "SITE_URL", server.url)
    monkeypatch.setattr(smoke.time, "sleep", lambda seconds: None)
    with pytest.raises(SystemExit, match="/metrics is visible"):  # there is no proxy that hides it
        smoke.check(smoke.Site("any"), 60)
    with server.client() as api:
        built, grown = api.get("/api/trees").json()["trees"]
    assert (built["state"], grown["state"]) == ("ready", "ready") and built["grown"] != grown["grown"]


def test_the_smoke_test_waits_until_the_tree_can_be_deleted(
    server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tree is ready before its job ends; until then DELETE is answered with 409."""
    smoke, refusals = script("compose-smoke"), {"/metrics": [404] * 9, "DELETE": [409, 409]}
    monkeypatch.setattr(smoke, "SITE_URL", server.url)
    monkeypatch.setattr(smoke.time, "sleep", lambda seconds: None)
    fetch = smoke.Site.fetch

    def fetch_behind_a_proxy(site: Any, method: str, path: str, *rest: Any) -> bytes:
        for status in (refusals.get(path) or refusals.get(method) or [])[:1]:
            (refusals.get(path) or refusals[method]).pop()
            raise HTTPError(path, status, "", Message(), None)
        return fetch(site, method, path, *rest)

    monkeypatch.setattr(smoke.Site, "fetch", fetch_behind_a_proxy)
    smoke.check(smoke.Site("any"), 60)
    with server.client() as api:
        assert api.get("/api/trees").json()["trees"] == [] and not refusals["DELETE"]


def test_the_smoke_test_builds_a_closed_pole() -> None:
    lines = script("compose-smoke").pole_obj().decode().splitlines()
    faces = [line.split()[1:] for line in lines if line.startswith("f ")]
    edges = [(a, b) for face in faces for a, b in zip(face, face[1:] + face[:1], strict=True)]
    assert len(set(edges)) == len(edges) and {(b, a) for a, b in edges} == set(edges)
