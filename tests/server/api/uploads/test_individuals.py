"""Individuals over REST: asked for once, made by a job, and what can go wrong with it."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import pytest
from galewood.constants import TABLE_VERSION
from galewood.packaged import species_folder
from galewood.table import read_metadata
from galewood.util import glb_parts
from galewood_server.access import new_key

from tests.server.support.server_process import NO_CLUSTER, Server, wait_until

ADDRESS = "/api/individuals"
FIND = f"{ADDRESS}/find"
APRICOT = {"species": "apricot", "seed": 3, "height_m": 9.0, "dbh_cm": 25.0}
SLENDER = {"species": "birch", "form": "forest", "seed": 4, "height_m": 90.0, "nearest_size": True}
Start = Callable[..., Server]


def grown(api: httpx.Client, order: dict[str, Any]) -> dict[str, Any]:
    """Ask for a tree, and wait until it is made."""
    asked = api.post(ADDRESS, json=order)
    assert asked.status_code == 202, asked.text
    address = asked.headers["location"]

    def ended() -> Any:
        tree = api.get(address).json()
        return tree["state"] not in ("building", "uploaded") and tree

    tree = wait_until(ended)
    job = api.get(f"/api/jobs/{tree['job_id']}").json()
    assert tree["state"] == "ready", job
    return dict(tree)


def test_an_individual_is_made_once_and_is_as_light_as_its_built_in_tree(start_server: Start) -> None:
    server = start_server(**NO_CLUSTER)
    with server.client() as api:
        tree = grown(api, APRICOT)
        assert (tree["name"], tree["species"], tree["grown"], tree["builtin"]) == (
            "apricot-3", "apricot", True, False,
        )  # fmt: skip
        assert tree["height_m"] == pytest.approx(9.0, rel=1e-3)
        jobs = api.get("/api/jobs", params={"tree_id": tree["id"]}).json()
        assert [job["state"] for job in jobs["jobs"]] == ["done"]
        found = api.post(FIND, json={"individuals": [{**APRICOT, "seed": 4}, APRICOT]}).json()
        assert found == {
            "trees": [None, {key: tree[key] for key in tree if key != "report"}],
            "cannot_grow": None,
        }
        again = api.post(ADDRESS, json=APRICOT)
        assert (again.status_code, again.json()["id"]) == (200, tree["id"])
        assert api.get("/api/jobs").json()["total"] == 1

        table = api.get(f"/api/tables/{tree['table_sha256']}").content
        metadata = read_metadata(table)
        assert (metadata["version"], metadata["mesh_sha256"]) == (TABLE_VERSION, tree["mesh_sha256"])
        bare = read_metadata(api.get(f"/api/tables/{tree['bare_table_sha256']}").content)
        assert (bare["foliage"], bare["mesh_sha256"]) == ("bare", tree["mesh_sha256"])
        mesh = api.get(f"/api/meshes/{tree['mesh_sha256']}").content
        light = api.get(f"/api/light-meshes/{tree['mesh_sha256']}").content
        assert len(light) < 0.25 * len(mesh)
        document, _ = glb_parts(light)
        builtin, _ = glb_parts((species_folder() / "light" / "apricot.glb").read_bytes())
        assert [image["uri"] for image in document["images"]] == [one["uri"] for one in builtin["images"]]
        assert document["materials"][-1]["extras"] == builtin["materials"][-1]["extras"]

        for refused in (
            api.post(f"/api/trees/{tree['id']}/pieces"),
            api.post(f"/api/trees/{tree['id']}/copies", json={"height_m": 4}),
            api.patch(f"/api/trees/{tree['id']}", json={"height_m": 4}),
        ):
            assert (refused.status_code, refused.json()["code"]) == (403, "grown-tree")
        assert api.delete(f"/api/trees/{tree['id']}").status_code == 204
        assert not list((server.data_dir / "cache" / "light").glob("*.glb"))
        assert not [path for path in (server.data_dir / "meshes").rglob("*") if path.is_file()]
        assert api.post(FIND, json={"individuals": [APRICOT]}).json()["trees"] == [None]
        assert api.post(ADDRESS, json=APRICOT).status_code == 202
        # one that is being made is not found yet
        assert api.post(FIND, json={"individuals": [APRICOT]}).json()["trees"] == [None]


def test_whoever_has_no_key_finds_trees_but_makes_none(start_server: Start) -> None:
    with start_server(**NO_CLUSTER, GALEWOOD_API_KEYS=new_key()[1]).client() as api:
        assert api.post(ADDRESS, json=APRICOT).status_code == 401
        found = api.post(FIND, json={"individuals": [APRICOT]})
        assert (found.status_code, found.json()) == (200, {"trees": [None], "cannot_grow": None})


def test_a_size_that_no_tree_has_becomes_the_nearest_or_fails_with_a_sentence(start_server: Start) -> None:
    with start_server(**NO_CLUSTER).client() as api:
        tree = grown(api, SLENDER)
        assert 15 < tree["height_m"] < 60
        assert tree["form"] == "forest"
        asked = api.post(ADDRESS, json={**SLENDER, "nearest_size": False}).json()
        assert asked["id"] != tree["id"]
        job = wait_until(
            lambda: (found := api.get(f"/api/jobs/{asked['job_id']}").json())["state"] == "failed" and found
        )
        assert "A height of 90 m is out of range for Silver birch" in job["error"]
        retried = api.post(f"/api/jobs/{job['id']}/retry")
        assert retried.status_code == 202
        wait_until(lambda: api.get(f"/api/jobs/{retried.json()['id']}").json()["state"] == "failed")


@pytest.mark.parametrize(
    ("wrong", "status"),
    [
        ({"species": "elm"}, 422), ({"seed": -1}, 422), ({"seed": 2**32}, 422), ({"height_m": 0}, 422),
        ({"dbh_cm": -3}, 422), ({"form": "round"}, 422), ({"age": 3}, 422), ({"species": ""}, 422),
    ],
)  # fmt: skip
def test_what_cannot_be_asked_for_is_refused(server: Server, wrong: dict[str, Any], status: int) -> None:
    with server.client() as api:
        for path, body in ((ADDRESS, APRICOT | wrong), (FIND, {"individuals": [APRICOT | wrong]})):
            answer = api.post(path, json=body)
            assert (answer.status_code, answer.json()["hint"] != "") == (status, True), answer.text


def without_node(folder: Path) -> str:
    """A search path that has everything but Node."""
    (folder / "empty").mkdir()
    return str(folder / "empty")


def test_without_node_the_answer_says_what_to_install(start_server: Start, tmp_path: Path) -> None:
    with start_server(**NO_CLUSTER, PATH=without_node(tmp_path)).client() as api:
        answer = api.post(ADDRESS, json=APRICOT)
        assert (answer.status_code, answer.json()["code"]) == (503, "cannot-grow")
        assert "Install Node 20 or newer" in answer.json()["hint"]
        assert api.get("/api/trees").json()["total"] == 0
        found = api.post(FIND, json={"individuals": [APRICOT]}).json()
        assert found["trees"] == [None]
        assert "Install Node 20 or newer" in found["cannot_grow"]


def test_the_quota_counts_trees_before_they_are_made(start_server: Start, tmp_path: Path) -> None:
    with start_server(
        **NO_CLUSTER, PATH=slow_node(tmp_path), GALEWOOD_STORED_BYTES=str(10_000_000)
    ).client() as api:
        statuses = [api.post(ADDRESS, json=APRICOT | {"seed": seed}).status_code for seed in range(5)]
        assert statuses == [202, 202, 202, 507, 507]
        answer = api.post(ADDRESS, json=APRICOT | {"seed": 9})
        assert answer.json()["code"] == "quota-reached"
        assert api.get("/api/trees").json()["total"] == 3
        for job in api.get("/api/jobs").json()["jobs"]:
            api.post(f"/api/jobs/{job['id']}/cancel")


def slow_node(folder: Path) -> str:
    """A search path whose first Node never ends; it notes its process."""
    program = folder / "node"
    program.write_text(f"#!/bin/sh\necho $$ >> {folder}/started\nexec sleep 600\n")
    program.chmod(0o755)
    return f"{folder}{os.pathsep}{os.environ['PATH']}"


def test_a_tree_that_is_no_longer_wanted_ends_node(start_server: Start, tmp_path: Path) -> None:
    with start_server(**NO_CLUSTER, PATH=slow_node(tmp_path)).client() as api:
        tree = api.post(ADDRESS, json=APRICOT).json()
        assert api.post(ADDRESS, json=APRICOT).status_code == 202
        started = tmp_path / "started"
        wait_until(lambda: started.exists() and started.read_text().strip())
        api.post(f"/api/jobs/{tree['job_id']}/cancel")
        wait_until(lambda: api.get(f"/api/jobs/{tree['job_id']}").json()["state"] == "cancelled")
        process = int(started.read_text().split()[0])
        wait_until(lambda: not Path(f"/proc/{process}").exists())
        assert api.get("/api/jobs").json()["total"] == 1
        assert api.delete(f"/api/trees/{tree['id']}").status_code == 204


def test_too_many_waiting_trees_are_refused(start_server: Start, tmp_path: Path) -> None:
    unlimited = {"GALEWOOD_WRITES_PER_MINUTE": "0", "GALEWOOD_CONCURRENT_INDIVIDUALS": "1"}
    with start_server(**NO_CLUSTER, **unlimited, PATH=slow_node(tmp_path)).client() as api:
        answers = [api.post(ADDRESS, json=APRICOT | {"seed": seed}) for seed in range(65)]
        assert {answer.status_code for answer in answers[:-1]} == {202}
        assert (answers[-1].status_code, answers[-1].json()["code"]) == (429, "too-many-individuals")
