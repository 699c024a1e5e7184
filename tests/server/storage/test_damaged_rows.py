"""Rows that cannot be read or serialised: lists and events leave them out, and nothing stores such a row."""

from __future__ import annotations

import asyncio
import json
import logging
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import httpx
import pytest
from fastapi import FastAPI
from galewood_server.api import events
from galewood_server.app.builtin_trees import queue_outdated_uploads
from galewood_server.cli.doctor import run_checks
from galewood_server.context import Service
from galewood_server.settings import Settings
from galewood_server.storage import Job, Stores, Tree, engine_of, open_database
from sqlalchemy import select, text

from tests.server.support.in_process import application
from tests.server.support.server_process import empty_database

SURROGATE = '{"credits": "\\ud800"}'
NOT_UTF8 = b"a\xff".hex()
TREE_DAMAGE = {
    "unknown form": "UPDATE trees SET form = 'diagonal' WHERE id = 'tree2'",
    "height that is a text": "UPDATE trees SET height_m = 'tall' WHERE id = 'tree2'",
    "name that is not UTF-8": f"UPDATE trees SET name = CAST(x'{NOT_UTF8}' AS TEXT) WHERE id = 'tree2'",
    "time that is none": "UPDATE trees SET created_at = 'soon' WHERE id = 'tree2'",
    "time that is a number": "UPDATE trees SET updated_at = 1e300 WHERE id = 'tree2'",
    "flag that is none": "UPDATE trees SET builtin = '' WHERE id = 'tree2'",
}
JOB_DAMAGE = {
    "unknown state": "UPDATE jobs SET state = 'exploded' WHERE id = 'job2'",
    "broken JSON": "UPDATE jobs SET pictures = '{' WHERE id = 'job2'",
    "lone surrogate": "UPDATE jobs SET pictures = '{\"a\": \"\\ud800\"}' WHERE id = 'job2'",
    "time that is none": "UPDATE jobs SET created_at = 'soon' WHERE id = 'job2'",
    "fraction that is a text": "UPDATE jobs SET fraction = 'half' WHERE id = 'job2'",
}


def add_trees(app: FastAPI, count: int = 5) -> None:
    with app.state.service.sessions.begin() as session:
        for k in range(count):
            table = app.state.service.stores.tables.put(b"table %d" % k)
            session.add(
                Tree(
                    id=f"tree{k}", name=f"tree {k}", filename="x", source_sha256="0" * 64, table_sha256=table
                )
            )
            session.flush()
            session.add(Job(id=f"job{k}", tree_id=f"tree{k}", state="done"))


def damage(app: FastAPI, statement: str) -> None:
    with engine_of(app.state.service.sessions).begin() as connection:
        connection.execute(text(statement.replace(":", "\\:")))


async def first_events(app: FastAPI) -> list[dict[str, Any]]:
    stream = events.all_changes(app.state.feed)
    try:
        lines = (await anext(stream)).decode().splitlines()
    finally:
        await stream.aclose()
    return [json.loads(line.removeprefix("data: ")) for line in lines if line]


async def listed(
    api: httpx.AsyncClient, kind: str, key: str = "id", **query: Any
) -> tuple[list[str], list[str]]:
    """The ids of all rows of a list, page by page, and of those that are left out."""
    found: list[str] = []
    left_out: set[str] = set()
    after: dict[str, str] = {}
    while True:
        answer = await api.get(f"/api/{kind}", params={**query, **after})
        assert answer.status_code == 200, answer.text
        page = answer.json()
        found += [one[key] for one in page[kind]]
        left_out |= set(page["damaged"])
        if page["next"] is None:
            return found, sorted(left_out)
        after = {"after": page["next"]}


@pytest.mark.parametrize("limit", [1, 2, 100])
@pytest.mark.parametrize("statement", TREE_DAMAGE.values(), ids=TREE_DAMAGE.keys())
def test_lists_and_events_leave_a_damaged_tree_out(
    tmp_path: Path, statement: str, limit: int, caplog: pytest.LogCaptureFixture
) -> None:
    async def ask() -> None:
        async with application(tmp_path) as (app, api):
            add_trees(app)
            before = [event["tree"]["id"] for event in await first_events(app)]
            assert before == [f"tree{k}" for k in range(5)]
            damage(app, statement)
            damage(app, "UPDATE jobs SET updated_at = '2100-01-01 00:00:00.000000' WHERE id = 'job2'")
            intact = ["tree0", "tree1", "tree3", "tree4"]
            for _ in range(3):
                found, left_out = await listed(api, "trees", limit=limit)
                assert (sorted(found), left_out) == (intact, ["tree2"])
                app.state.feed._polled_s = -1.0
                assert [event["tree"]["id"] for event in await first_events(app)] == intact
            refused = await api.get("/api/trees/tree2")
            problem = refused.json()
            assert (refused.status_code, problem["code"]) == (500, "damaged-tree")
            assert "DELETE /api/trees/" in problem["hint"]
            said = [record for record in caplog.records if "tree2" in record.getMessage()]
            assert 1 <= len(said) <= 2  # the summary and the whole tree, however often they are asked for
            assert (await api.delete("/api/trees/tree2")).status_code == 204
            assert await listed(api, "trees") == (intact, [])

    with caplog.at_level(logging.ERROR, "galewood.rows"):
        asyncio.run(ask())


def test_a_report_that_cannot_be_serialised_affects_its_own_tree_only(tmp_path: Path) -> None:
    async def ask() -> None:
        async with application(tmp_path) as (app, api):
            add_trees(app)
            for report in (SURROGATE, "[]", "{", '{"a": ' * 5000 + "1" + "}" * 5000):
                with engine_of(app.state.service.sessions).begin() as connection:
                    changed = text("UPDATE trees SET report = :report WHERE id = 'tree2'")
                    connection.execute(changed, {"report": report})
                assert (await api.get("/api/trees/tree2")).json()["code"] == "damaged-tree"
                found, left_out = await listed(api, "trees")
                assert len(found) == 5 and left_out == []
            assert (await api.delete("/api/trees/tree2")).status_code == 204
            assert (await api.get("/api/jobs/job2")).status_code == 404

    asyncio.run(ask())


@pytest.mark.parametrize("statement", JOB_DAMAGE.values(), ids=JOB_DAMAGE.keys())
def test_the_list_of_jobs_leaves_a_damaged_one_out(tmp_path: Path, statement: str) -> None:
    async def ask() -> None:
        async with application(tmp_path) as (app, api):
            add_trees(app)
            damage(app, statement)
            found, left_out = await listed(api, "jobs", limit=1)
            assert (sorted(found), left_out) == (["job0", "job1", "job3", "job4"], ["job2"])
            assert (await api.get("/api/jobs/job2")).json()["code"] == "damaged-job"
            of_trees = {event["tree"]["id"]: event["job"] for event in await first_events(app)}
            assert len(of_trees) == 5 and of_trees["tree2"] is None
            assert (await api.delete("/api/trees/tree2")).status_code == 204
            assert await listed(api, "jobs") == (found, [])

    asyncio.run(ask())


def test_the_list_of_tables_leaves_damaged_rows_out(tmp_path: Path) -> None:
    async def ask() -> None:
        async with application(tmp_path) as (app, api):
            add_trees(app)
            damage(app, "UPDATE trees SET table_sha256 = 'nonsense' WHERE id = 'tree1'")
            damage(app, "UPDATE trees SET created_at = 'soon' WHERE id = 'tree2'")
            damage(app, "UPDATE trees SET height_m = 'tall' WHERE id = 'tree3'")
            found, left_out = await listed(api, "tables", "tree_id", limit=1)
            assert (found, left_out) == (["tree0", "tree4"], ["tree1", "tree2", "tree3"])

    asyncio.run(ask())


@pytest.mark.parametrize("statement", JOB_DAMAGE.values(), ids=JOB_DAMAGE.keys())
def test_the_evaluations_of_a_tree_survive_a_damaged_one(tmp_path: Path, statement: str) -> None:
    async def ask() -> None:
        async with application(tmp_path) as (app, api):
            add_trees(app)
            damage(app, "UPDATE jobs SET kind = 'evaluation', tree_id = 'tree2'")
            damage(app, statement)
            page = (await api.get("/api/trees/tree2/evaluations")).json()
            kept = sorted(one["id"] for one in page["evaluations"])
            readable = (
                "surrogate" in statement or "ud800" in statement
            )  # pictures are no part of an evaluation
            assert kept == ["job0", "job1", *(["job2"] if readable else []), "job3", "job4"]
            assert page["damaged"] == ([] if readable else ["job2"]) and page["total"] == 5

    asyncio.run(ask())


def test_damaged_rows_keep_no_other_tree_from_its_update_and_are_found_by_doctor(tmp_path: Path) -> None:
    (tmp_path / "galewood.sqlite").write_bytes(empty_database())
    settings = Settings(data_dir=tmp_path)
    sessions = open_database(settings.database)
    service = SimpleNamespace(sessions=sessions, stores=Stores(tmp_path), wake_supervisor=lambda: None)
    app = cast(FastAPI, SimpleNamespace(state=SimpleNamespace(service=service)))
    add_trees(app)
    damage(app, "UPDATE trees SET fingerprint = 'of an older version'")
    damage(app, "UPDATE trees SET options = '{' WHERE id = 'tree2'")
    asyncio.run(queue_outdated_uploads(cast(Service, service)))
    with sessions() as session:
        queued = set(session.scalars(select(Job.tree_id).where(Job.state == "queued")))
    assert queued == {"tree0", "tree1", "tree3", "tree4"}
    found = [finding.what for finding in run_checks(settings)]
    assert [what for what in found if "'tree2'" in what and "delete its tree" in what]


def surrogate_importer(data: bytes, filename: str, options: Any) -> Any:
    names = ["\ud800"] if b"odd" in data or options.height_m == 9 else []
    content = data + str(options.height_m).encode()
    return SimpleNamespace(
        species=options.species, height_m=5.0, report={"names": names}, render_glb=b"glTF of " + content,
        tree=b"tree of " + content, beams=b"table of " + content,
    )  # fmt: skip


def stored_names(stores: Stores) -> set[str]:
    """The files of all imports."""
    return {
        name
        for store in (stores.sources, stores.meshes, stores.imports, stores.tables)
        for name in store.names()
    }


def test_what_cannot_be_answered_is_not_stored(tmp_path: Path) -> None:
    async def ask() -> None:
        async with application(tmp_path, surrogate_importer) as (app, api):
            stores = app.state.service.stores
            refused = await api.post("/api/trees", files={"file": ("a.obj", b"odd")})
            assert (refused.status_code, refused.json()["code"]) == (500, "unserialisable")
            assert await listed(api, "trees") == ([], [])
            assert not stored_names(stores)
            tree = (await api.post("/api/trees", files={"file": ("a.obj", b"even")})).json()
            files = stored_names(stores)
            assert len(files) == 4
            refused = await api.patch(f"/api/trees/{tree['id']}", json={"height_m": 9, "name": "nine"})
            assert refused.json()["code"] == "unserialisable"
            assert (await api.get(f"/api/trees/{tree['id']}")).json() == tree
            assert stored_names(stores) == files

    asyncio.run(ask())
