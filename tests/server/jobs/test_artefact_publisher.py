"""Artefacts published by running builds, and garbage collection of replaced files."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import pytest
from galewood.pipeline.results import BuildResult
from galewood.table import format as table_format
from galewood.util.cancelled import Cancelled
from galewood_server.jobs.analyses.analysis_files import PLOT_FILE, store_result
from galewood_server.jobs.artefact_publisher import ArtefactPublisher
from galewood_server.jobs.build_job import BuiltTree, publish_result, publish_table
from galewood_server.jobs.leases import claim
from galewood_server.jobs.progress import JobLease
from galewood_server.jobs.queue import add_job
from galewood_server.storage.database import Sessions, migrate, open_database
from galewood_server.storage.files import FileStore
from galewood_server.storage.garbage import collect_garbage, mark_garbage, referenced_files
from galewood_server.storage.models import Garbage, Job, JobKind, Tree, utc_now
from galewood_server.storage.stores import Stores
from sqlalchemy import select, update

from tests.golden import GOLDEN_FOLDER

POLE = (GOLDEN_FOLDER / "pole-table.safetensors").read_bytes()
RECORDS = b"records of the table"
MESH = b"glTF of the tree"


def known(sha256: str | None) -> str:
    """The name of a file that the tree has."""
    assert sha256
    return sha256


INPUTS = BuiltTree("t", "fingerprint")


class Build:
    """A tree with a running job, in a separate database and stores."""

    def __init__(self, folder: Path) -> None:
        url = f"sqlite:///{folder / 'galewood.sqlite'}"
        migrate(url)
        self.sessions: Sessions = open_database(url)
        self.stores = Stores(folder)
        with self.sessions.begin() as session:
            session.add(Tree(id="t", name="t", filename="t.obj", source_sha256=self.stores.sources.put(b"t")))
        self.next()

    def next(self, kind: JobKind = "build") -> None:
        """Add and claim another job."""
        with self.sessions.begin() as session:
            add_job(session, session.get_one(Tree, "t"), kind, {})
            claimed = claim(session, "here", (kind,), 60)
        assert claimed
        self.job_lease = JobLease(self.sessions, *claimed)
        self.publish = ArtefactPublisher(self.job_lease, self.stores)

    def table(self, height_m: float, model: str = "model") -> bytes:
        """A table of the mesh, different for each height."""
        pole = table_format.decode(POLE)
        mesh_sha256 = self.stores.meshes.put(MESH)
        provenance = {"model_sha256": model}
        metadata = {
            **pole.metadata, "height_m": height_m, "mesh_sha256": mesh_sha256, "provenance": provenance
        }  # fmt: skip
        return table_format.encode(replace(pole, metadata=metadata))

    def default(self, table: bytes) -> None:
        """Publish the complete table; the records follow."""
        publish_table(self.job_lease, self.stores, INPUTS, BuildResult(table, None, MESH, {}), b"model")

    def finish(self, table: bytes, records: bytes | None = None, bare: bytes | None = None) -> None:
        result = BuildResult(table, records, MESH, {"done": True}, bare)
        publish_result(self.job_lease, self.stores, INPUTS, result, b"model")

    @property
    def tree(self) -> Tree:
        with self.sessions() as session:
            tree = session.get_one(Tree, "t")
            assert tree.jobs
            return tree

    @property
    def job(self) -> Job:
        job = self.tree.job
        assert job
        return job

    def collect_garbage(self, grace_s: float = -1.0) -> int:
        return collect_garbage(self.sessions, self.stores, grace_s)


@pytest.fixture
def build(tmp_path: Path) -> Build:
    return Build(tmp_path)


def test_the_first_table_is_replaced_by_the_complete_one(build: Build) -> None:
    first, full = build.table(1.0), build.table(4.0)
    build.publish("render.glb", MESH)
    assert build.tree.state == "building" and build.stores.meshes.get(known(build.tree.mesh_sha256)) == MESH
    build.publish("beams.table", first)
    assert build.tree.state == "preliminary"
    old = known(build.tree.table_sha256)
    assert build.stores.tables.get(old) == first
    build.publish("beams.table", build.table(2.0))  # of a resumed build
    assert build.tree.table_sha256 == old
    build.finish(full)
    assert build.tree.state == "ready" and build.stores.tables.get(known(build.tree.table_sha256)) == full
    assert build.stores.models.get(known(build.tree.model_sha256)) == b"model"
    assert build.stores.tables.has(old)  # clients may still fetch it
    assert build.collect_garbage(grace_s=600) == 0 and build.stores.tables.has(old)
    assert build.collect_garbage() == 2 and not build.stores.tables.has(old)
    assert build.stores.tables.has(known(build.tree.table_sha256))


def test_the_table_is_ready_before_its_records(build: Build) -> None:
    build.publish("beams.table", build.table(3.0))
    build.default(build.table(4.0))
    tree, job = build.tree, build.job
    assert (tree.state, tree.records_sha256, tree.fingerprint) == ("ready", None, "fingerprint")
    assert (job.state, job.stage, job.fraction) == ("running", "records", 0.0)
    assert build.stores.models.get(known(tree.model_sha256)) == b"model"
    build.finish(build.table(4.0), RECORDS)
    done = build.tree
    assert done.table_sha256 == tree.table_sha256 and done.report == {"done": True}
    assert build.stores.records.get(known(done.records_sha256)) == RECORDS
    assert build.job.state == "done"


def test_a_build_that_ends_without_records_keeps_its_table(build: Build) -> None:
    build.default(build.table(4.0))
    build.job_lease.end("cancelled", "Cancelled")
    assert (build.tree.state, build.tree.records_sha256, build.job.state) == ("ready", None, "cancelled")


def test_records_are_replaced_with_their_table(build: Build) -> None:
    build.finish(build.table(4.0), RECORDS)
    records = known(build.tree.records_sha256)
    build.next()
    build.default(build.table(4.0))  # the same table keeps its records
    assert build.tree.records_sha256 == records
    build.default(build.table(5.0))
    assert build.tree.records_sha256 is None
    assert build.stores.records.has(records)  # clients may still fetch it
    build.collect_garbage()
    assert not build.stores.records.has(records)


def test_the_bare_table_belongs_to_the_table(build: Build) -> None:
    build.finish(build.table(4.0), RECORDS, build.table(4.5))
    tree = build.tree
    bare = known(tree.bare_table_sha256)
    assert build.stores.tables.get(bare) == build.table(4.5) and bare != tree.table_sha256
    build.next()
    build.default(build.table(4.0))  # the same table keeps it
    build.collect_garbage()
    assert build.tree.bare_table_sha256 == bare and build.stores.tables.has(bare)
    build.default(build.table(5.0))
    assert build.tree.bare_table_sha256 is None
    assert build.stores.tables.has(bare)  # clients may still fetch it
    build.collect_garbage()
    assert list(build.stores.tables.names()) == [build.tree.table_sha256]


def test_a_bare_table_that_is_another_trees_table_is_kept(build: Build) -> None:
    build.finish(build.table(4.0), bare=build.table(4.5))
    shared = known(build.tree.bare_table_sha256)
    with build.sessions.begin() as session:
        session.add(Tree(id="u", name="u", filename="u.obj", source_sha256="0" * 64, table_sha256=shared))
    build.next()
    build.finish(build.table(6.0))
    build.collect_garbage()
    assert build.stores.tables.has(shared)


def test_a_preliminary_table_has_no_records(build: Build) -> None:
    build.finish(build.table(4.0), RECORDS)
    with build.sessions.begin() as session:
        session.execute(update(Tree).values(table_sha256=build.stores.tables.put(b"of another age")))
    build.next()
    build.publish("beams.table", build.table(2.0))
    assert (build.tree.state, build.tree.records_sha256) == ("preliminary", None)


def test_a_preliminary_table_does_not_replace_a_complete_one(build: Build) -> None:
    build.finish(build.table(4.0))
    full = build.tree.table_sha256
    build.next()
    build.publish("beams.table", build.table(3.0))
    assert build.tree.table_sha256 == full and build.tree.state == "ready"
    build.collect_garbage()
    assert list(build.stores.tables.names()) == [full]


def test_a_preliminary_table_replaces_an_unreadable_one(build: Build) -> None:
    with build.sessions.begin() as session:
        session.execute(update(Tree).values(table_sha256=build.stores.tables.put(b"of another age")))
    first = build.table(3.0)
    build.publish("beams.table", first)
    assert build.stores.tables.get(known(build.tree.table_sha256)) == first


def test_pictures_are_stored_by_name(build: Build) -> None:
    build.publish("skeleton.png", b"a picture")
    build.publish("skeleton.png", b"a better one")
    build.publish("tetrahedra.png", b"another")
    pictures = build.job.pictures
    assert {name: build.stores.pictures.get(sha256) for name, sha256 in pictures.items()} == {
        "skeleton.png": b"a better one",
        "tetrahedra.png": b"another",
    }


def test_a_build_without_a_valid_lease_publishes_nothing(build: Build) -> None:
    with build.sessions.begin() as session:
        session.execute(update(Job).values(lease="another's"))
    build.publish("beams.table", build.table(3.0))
    build.publish("skeleton.png", b"a picture")
    build.finish(build.table(4.0))
    assert build.tree.table_sha256 is None and build.job.pictures == {}
    assert build.job.state == "running"


def test_a_replaced_table_is_kept_while_a_comparison_uses_it(build: Build) -> None:
    build.finish(build.table(3.0))
    old = known(build.tree.table_sha256)
    with build.sessions.begin() as session:
        tree = session.get_one(Tree, "t")
        analysis = add_job(
            session, tree, "comparison", {"table_sha256": old, "model_sha256": tree.model_sha256}
        )
    build.next()
    build.finish(build.table(4.0))
    assert build.collect_garbage() == 0 and build.stores.tables.has(old)
    with build.sessions.begin() as session:
        session.get_one(Job, analysis.id).state = "done"
    assert build.collect_garbage() == 1 and not build.stores.tables.has(old)


def test_a_file_of_two_trees_is_kept_when_one_drops_it(build: Build) -> None:
    build.finish(build.table(3.0))
    shared = known(build.tree.table_sha256)
    with build.sessions.begin() as session:
        session.add(Tree(id="u", name="u", filename="u.obj", source_sha256="0" * 64, table_sha256=shared))
    build.next()
    build.finish(build.table(4.0))
    build.collect_garbage()
    assert build.stores.tables.has(shared)
    with build.sessions() as session:
        assert referenced_files(session)["tables"] == {shared, build.tree.table_sha256}
        late = utc_now() + timedelta(days=1)
        assert not session.scalars(select(Garbage).where(Garbage.garbage_since < late)).all()


@pytest.fixture
def collect_after_every_put(build: Build, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], None]]:
    """A function that enables garbage collection after every stored file, the worst case for a race."""
    put, rivals = FileStore.put, list[threading.Thread]()

    def put_and_collect(store: FileStore, data: bytes) -> str:
        sha256 = put(store, data)
        rival = threading.Thread(target=build.collect_garbage)
        rivals.append(rival)
        rival.start()
        rival.join(0.5)  # waits if the file is held by a transaction
        return sha256

    yield lambda: monkeypatch.setattr(FileStore, "put", put_and_collect)
    for rival in rivals:
        rival.join()


def test_concurrent_garbage_collection_keeps_analysis_files(
    build: Build, collect_after_every_put: Callable[[], None]
) -> None:
    build.next("evaluation")
    collect_after_every_put()
    store_result(build.job_lease, build.stores, {"largest": 1.0}, b"a report", {PLOT_FILE: b"a picture"})
    analysis = build.tree.jobs[-1]
    assert analysis.state == "done" and analysis.result_sha256
    build.collect_garbage()
    assert build.stores.results.get(analysis.result_sha256) == b"a report"
    assert build.stores.pictures.get(analysis.pictures[PLOT_FILE]) == b"a picture"


def test_concurrent_garbage_collection_keeps_build_files(
    build: Build, collect_after_every_put: Callable[[], None]
) -> None:
    table = build.table(3.0)
    with build.sessions.begin() as session:  # the same files are marked as garbage of an earlier build
        for kind, data in (("tables", table), ("meshes", MESH), ("models", b"model")):
            mark_garbage(session, kind, build.stores.named(kind).put(data))
    collect_after_every_put()
    build.finish(table)
    build.collect_garbage()
    tree = build.tree
    assert build.stores.tables.get(known(tree.table_sha256)) == table
    assert build.stores.meshes.get(known(tree.mesh_sha256)) == MESH
    assert build.stores.models.get(known(tree.model_sha256)) == b"model"


def test_an_analysis_without_a_valid_lease_leaves_no_file(build: Build) -> None:
    build.next("evaluation")
    kept = JobLease(build.sessions, build.job_lease.job_id, "another's")
    with pytest.raises(Cancelled):
        store_result(kept, build.stores, {}, b"a report")
    build.collect_garbage()
    assert list(build.stores.results.names()) == [] and build.tree.jobs[-1].state == "running"
