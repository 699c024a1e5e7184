"""What a job shows that resumes after a restart, and what it says of a file that is lost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from galewood.pipeline.results import BuildResult
from galewood.pipeline.stages.stage import Progress
from galewood.pipeline.stages.stage import Stage as BuildStage
from galewood_server.jobs import build_job, progress
from galewood_server.jobs.build_job import read_build_inputs
from galewood_server.jobs.job_process import run_job
from galewood_server.jobs.leases import claim, requeue_running
from galewood_server.jobs.progress import JobFailedError, JobLease, ProgressReporter
from galewood_server.jobs.queue import add_job, end_job
from galewood_server.jobs.stored_files import stored_bytes, stored_path
from galewood_server.settings import Settings
from galewood_server.storage.models import Job, JobKind, Tree

from tests.server.jobs.test_artefact_publisher import MESH, Build

Stage = tuple[str, float]


@pytest.fixture
def build(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Build:
    monkeypatch.setattr(progress, "REPORT_S", 0.0)
    return Build(tmp_path)


def restarted(build: Build, kind: JobKind = "build") -> ProgressReporter:
    """The reporter of the same job in the process of a server that was started again."""
    with build.sessions.begin() as session:
        assert requeue_running(session, "here") == 1
        claimed = claim(session, "here", (kind,), 60) or claim(session, "here", (kind,), 60, after_table=True)
    assert claimed
    build.job_lease = JobLease(build.sessions, *claimed)
    return ProgressReporter(build.job_lease)


def shown(build: Build) -> tuple[str, float, str]:
    with build.sessions() as session:
        job = session.get_one(Job, build.job_lease.job_id)
        return job.stage, job.fraction, job.message


def test_progress_does_not_decrease_after_a_restart(build: Build) -> None:
    first = ProgressReporter(build.job_lease)
    for stage, fraction in (("import", 0.0), ("mesh", 0.2), ("sampling", 0.6)):
        first.report(stage, fraction, "work")
        assert shown(build) == (stage, fraction, "work")
    again = restarted(build)
    for stage, fraction in (("import", 0.0), ("mesh", 0.2), ("sampling", 0.55)):
        again.report(stage, fraction, "work")
        assert shown(build) == ("sampling", 0.6, "Resuming: work")
    again.report("sampling", 0.65, "work")
    assert shown(build) == ("sampling", 0.65, "work")


def test_a_job_restarted_after_its_table_stays_in_the_stage_it_had_reached(build: Build) -> None:
    table = build.table(10.0)
    first = ProgressReporter(build.job_lease)
    first.report("sampling", 0.9, "work")
    build.default(table)
    assert shown(build)[:2] == ("records", 0.0)  # a part of its own, which counts from 0
    first.report("records", 0.4, "work")
    again = restarted(build)
    again.report("sampling", 0.95, "work")
    assert shown(build) == ("records", 0.4, "Resuming: work")
    build.default(table)
    assert shown(build)[:2] == ("records", 0.4)
    for stage, fraction in (("records", 0.5), ("bare", 0.1)):
        again.report(stage, fraction, "work")
        assert shown(build) == (stage, fraction, "work")


def test_a_build_with_its_table_goes_back_to_the_queue_when_a_tree_waits(
    build: Build, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("lower_priority", "load_early"):  # of the process of a job
        monkeypatch.setattr(build_job, name, lambda: None)
    monkeypatch.setattr(build_job, "YIELD_S", -1.0)
    settings, done = Settings(data_dir=tmp_path, prepare=False), list[str]()

    def compute(*given: Any) -> BuildResult:
        """A build during whose stage "records" another tree is uploaded, the first time."""
        on_progress, on_table = given[4], given[7]
        result = BuildResult(build.table(4.0), None, MESH, {})
        on_progress(Progress(BuildStage.SAMPLING, 0.5, "sampling"))
        on_table(result)
        on_progress(Progress(BuildStage.RECORDS, 0.1, "records"))
        if not done:
            done.append("a part of the records")
            with build.sessions.begin() as session:
                session.add(Tree(id="u", name="u", filename="u.obj", source_sha256="0" * 64))
                session.flush()
                add_job(session, session.get_one(Tree, "u"), "build", {})
        on_progress(Progress(BuildStage.RECORDS, 0.2, "records"))
        done.append("the records")
        return replace(result, records=b"records")

    run_job(build.job_lease, lambda: "", settings, compute)
    assert (build.job.state, build.job.stage, build.job.lease) == ("queued", "records", None)
    assert build.tree.state == "ready" and done == ["a part of the records"]
    with build.sessions.begin() as session:
        other = claim(session, "here", ("build",), 60)
        assert other and session.get_one(Job, other[0]).tree_id == "u", "the tree that waits comes first"
        end_job(session, other[0], "done", message="Done")
        claimed = claim(session, "here", ("build",), 60, after_table=True)
    assert claimed
    run_job(JobLease(build.sessions, *claimed), lambda: "", settings, compute)
    assert build.job.state == "done" and done[1:] == ["the records"]
    assert build.tree.records_sha256


def spoil(build: Build, kind: str, how: str) -> str:
    """Remove or damage the only stored file of a kind; its hash."""
    (sha256,) = build.stores.named(kind).names()
    path = build.stores.named(kind).path(sha256)
    if how == "is lost":
        path.unlink()
    else:
        path.write_bytes(b"something else")
    return sha256


@pytest.mark.parametrize("how", ["is lost", "is damaged"])
def test_a_lost_source_is_named_with_what_to_do(build: Build, how: str) -> None:
    sha256 = spoil(build, "sources", how)
    with pytest.raises(JobFailedError) as failed:
        read_build_inputs(build.sessions, build.stores, build.job_lease.job_id)
    text = str(failed.value)
    assert text.startswith(f"The uploaded file t.obj {how} (sources/{sha256[:12]}")
    assert "Upload it again" in text and "backup" in text


@pytest.mark.parametrize("read", [stored_bytes, stored_path])
def test_a_lost_input_of_an_analysis_is_named(build: Build, read: Callable[..., object]) -> None:
    build.stores.models.put(b"a model")
    sha256 = spoil(build, "models", "is lost")
    with pytest.raises(JobFailedError, match=f"model of this tree is lost .models/{sha256[:12]}.*Compute"):
        read(build.stores, "models", sha256)
