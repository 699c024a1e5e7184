"""Lists are serialised once, and are nevertheless always those of the database, whoever has changed it."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import httpx
import pytest
from galewood_server.http import JobOut, TreeSummary
from galewood_server.jobs import Supervisor
from galewood_server.storage import Job, Sessions, Tree, engine_of, open_database
from sqlalchemy import delete, select, update
from sqlalchemy.orm import Session

from tests.server.support.in_process import application

SEED, STEPS = 32, 150
NOW = datetime(2026, 1, 1, tzinfo=UTC)
STATES = ("queued", "running", "done", "failed", "cancelled")


def some(session: Session, dice: random.Random, kind: type[Any]) -> Any:
    rows = session.scalars(select(kind).order_by(kind.id)).all()
    return dice.choice(rows) if rows else None


def add_tree(session: Session, dice: random.Random) -> None:
    name = f"{dice.getrandbits(64):016x}"
    session.add(
        Tree(id=name, name="tree", filename="x", source_sha256="0" * 64, report={"n": dice.random()},
             created_at=NOW, updated_at=NOW)
    )  # fmt: skip


def add_job(session: Session, dice: random.Random) -> None:
    tree = some(session, dice, Tree)
    if tree:
        kind = dice.choice(("build", "build", "evaluation"))
        name = f"{dice.getrandbits(64):016x}"
        session.add(Job(id=name, tree_id=tree.id, kind=kind, created_at=NOW, updated_at=NOW))


def change_job(session: Session, dice: random.Random) -> None:
    job = some(session, dice, Job)
    if job:
        values = {"state": dice.choice(STATES), "fraction": dice.random(), "updated_at": NOW}
        session.execute(update(Job).where(Job.id == job.id).values(**values))


def change_tree(session: Session, dice: random.Random) -> None:
    """Without a change of `updated_at`, as by two changes in the same tick of the clock."""
    tree = some(session, dice, Tree)
    if tree:
        table = dice.choice((None, f"{dice.getrandbits(256):064x}"))
        values = dice.choice(
            (
                {"name": f"tree {dice.random()}"},
                {"table_sha256": table, "preliminary": dice.random() < 0.5},
                {"report": {"n": dice.random()}},
                {"height_m": dice.random()},
            )
        )
        session.execute(update(Tree).where(Tree.id == tree.id).values(**values, updated_at=NOW))


def remove(session: Session, dice: random.Random) -> None:
    kind = dice.choice((Tree, Job))
    row = some(session, dice, kind)
    if row:
        session.execute(delete(kind).where(kind.id == row.id))


def replace(session: Session, dice: random.Random) -> None:
    """As many trees and the same times as before."""
    if some(session, dice, Tree):
        session.execute(delete(Tree).where(Tree.id == some(session, dice, Tree).id))
        add_tree(session, dice)


CHANGES: tuple[Callable[[Session, random.Random], None], ...] = (
    add_tree, add_job, add_job, change_job, change_job, change_tree, change_tree, remove, replace,
)  # fmt: skip


def truth(sessions: Sessions) -> dict[str, Any]:
    """What the lists must say, from the objects of a new session."""
    with sessions() as session:
        trees = session.scalars(select(Tree).order_by(Tree.created_at, Tree.id)).all()
        jobs = session.scalars(select(Job).where(Job.kind == "build").order_by(Job.id.desc())).all()
        summaries: list[Any] = []
        for tree in trees:
            names = [name for name in TreeSummary.model_fields if name != "job_id"]
            values = {name: getattr(tree, name) for name in names}
            one = TreeSummary(**values, job_id=tree.job.id if tree.job else None)
            summaries.append(one.model_dump(mode="json"))
        return {
            "trees": summaries,
            "jobs": [JobOut.model_validate(job).model_dump(mode="json") for job in jobs],
            "reports": {tree.id: tree.report for tree in trees},
        }


async def fresh(api: httpx.AsyncClient, path: str, tags: dict[str, tuple[str, Any]]) -> Any:
    """A list as a client with a cache sees it: the one it has if the server says that it is current."""
    tag, known = tags.get(path, ("", None))
    answer = await api.get(path, headers={"If-None-Match": tag} if tag else {})
    if answer.status_code == 304:
        return known
    assert answer.status_code == 200
    tags[path] = (answer.headers["etag"], answer.json())
    return answer.json()


def test_the_lists_are_those_of_the_database_after_every_change_of_another_server(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def no_jobs(_: Supervisor) -> None:
        """Nothing else changes the rows meanwhile."""

    monkeypatch.setattr(Supervisor, "run", no_jobs)
    dice = random.Random(SEED)

    async def ask() -> None:
        async with application(tmp_path) as (_, api):
            other = open_database(f"sqlite:///{tmp_path / 'galewood.sqlite'}")
            tags: dict[str, tuple[str, Any]] = {}
            for step in range(STEPS):
                change = add_tree if step < 5 else dice.choice(CHANGES)
                with other.begin() as session:
                    change(session, dice)
                expected = truth(other)
                for name in ("trees", "jobs"):
                    found = await fresh(api, f"/api/{name}?limit=500", tags)
                    assert (found[name], found["total"]) == (expected[name], len(expected[name])), change
                for tree in expected["trees"]:
                    found = await fresh(api, f"/api/trees/{tree['id']}", tags)
                    assert found == {**tree, "report": expected["reports"][tree["id"]]}, change
            engine_of(other).dispose()

    asyncio.run(ask())


def test_a_list_is_serialised_once_and_has_no_reports(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    serialised: list[str] = []
    dump = TreeSummary.model_dump_json

    def counted(self: TreeSummary, **given: Any) -> str:
        serialised.append(self.id)
        return dump(self, **given)

    monkeypatch.setattr(TreeSummary, "model_dump_json", counted)
    dice = random.Random(SEED + 1)  # rows that no other test has

    async def ask() -> None:
        async with application(tmp_path) as (app, api):
            with app.state.service.sessions.begin() as session:
                for _ in range(8):
                    add_tree(session, dice)
            first = await api.get("/api/trees")
            assert len(serialised) == 8 and "report" not in first.text
            tag = first.headers["etag"]
            answers = [await api.get("/api/trees", headers={"If-None-Match": tag}) for _ in range(3)]
            pages = [await api.get("/api/trees?limit=3") for _ in range(3)]
            assert [one.status_code for one in (*answers, *pages)] == [304] * 3 + [200] * 3
            assert len(serialised) == 8
            with app.state.service.sessions.begin() as session:
                some(session, dice, Tree).name = "renamed"
            changed = await api.get("/api/trees", headers={"If-None-Match": tag})
            assert changed.status_code == 200 and "renamed" in changed.text and len(serialised) == 9

    asyncio.run(ask())
