"""A job process whose build takes a fixed time and computes nothing, for tests of the queue.

Started through GALEWOOD_JOB_MODULE. The name of the file chooses what happens; steps done are kept in the
cache, so that a test can see that a resumed job goes on.
"""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from galewood.pipeline.results import BuildResult
from galewood.pipeline.stages.stage import Progress, Stage
from galewood.pipeline.tables.options import BuildOptions
from galewood_server.jobs.analyses.analysis_files import PLOT_FILE, store_result
from galewood_server.jobs.job_process import main
from galewood_server.jobs.progress import JobLease, ProgressReporter
from galewood_server.settings import Settings
from galewood_server.storage.models import JobKind
from galewood_server.storage.stores import Stores

STEPS = 20


def fake_build(
    source: bytes,
    filename: str,
    options: BuildOptions,
    runner: object,
    progress: Callable[[Progress], None],
    cache_dir: Path,
    publish: Callable[[str, bytes], None],
    on_table: Callable[[BuildResult], None],
) -> BuildResult:
    if filename.startswith("fail"):
        raise ValueError("a build that fails")
    if filename.startswith("freeze") and not (mark := cache_dir / f"frozen-{filename}").exists():
        mark.parent.mkdir(parents=True, exist_ok=True)
        mark.touch()
        os.kill(os.getpid(), signal.SIGSTOP)
    if filename.startswith("crash"):
        os.abort()
    if filename.startswith("study"):
        runner.model = _model(cache_dir)  # type: ignore[attr-defined]
    step_s = float(os.environ.get("FAKE_STEP_S", "0.05"))
    log = cache_dir / f"steps-{filename}"
    log.parent.mkdir(parents=True, exist_ok=True)
    done = len(log.read_text().split()) if log.exists() else 0
    for step in range(done, STEPS):
        progress(Progress(Stage.SAMPLING, step / STEPS, f"step {step}"))
        time.sleep(step_s)
        with log.open("a") as file:
            file.write(f"{step}\n")
    report = {"options": json.loads(json.dumps(str(options)))}
    result = BuildResult(b"table of " + source[:64], None, b"glTF" + source[:64], report)
    on_table(result)
    if filename.startswith("bare"):
        return result
    compute_records(filename, cache_dir, progress)
    result = replace(result, records=b"records of " + source[:64])
    if not options.bare_table:
        return result
    on_table(result)
    progress(Progress(Stage.BARE, 0.5, "without leaves"))
    return replace(result, bare_table=b"bare table of " + source[:64])


def compute_records(filename: str, cache_dir: Path, progress: Callable[[Progress], None]) -> None:
    """The stage "records"; it lasts while the file exists that `hold_records` makes."""
    progress(Progress(Stage.RECORDS, 0.0, "records"))
    while held(cache_dir, filename).exists():
        progress(Progress(Stage.RECORDS, 0.5, "records"))
        time.sleep(0.02)


def held(cache_dir: Path, filename: str) -> Path:
    """The file that keeps builds of a mesh in the stage "records"."""
    return cache_dir / f"hold-records-{filename}"


def hold_records(data_dir: Path, filename: str) -> Path:
    """Keep builds of a mesh in the stage "records" until the returned file is removed."""
    path = held(data_dir / "cache", filename)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()
    return path


def _model(cache_dir: Path) -> Path:
    path = cache_dir / "models" / "model.npz"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"a model")
    return path


def fake_analysis(job_lease: JobLease, kind: JobKind, settings: Settings, stores: Stores) -> None:
    """An analysis in STEPS steps, recorded in its folder like the runs of an evaluation."""
    reporter, folder = ProgressReporter(job_lease), settings.analysis_folder(job_lease.job_id)
    folder.mkdir(parents=True, exist_ok=True)
    for step in range(STEPS):
        reporter.report("evaluating", step / STEPS, f"step {step}")
        time.sleep(float(os.environ.get("FAKE_STEP_S", "0.05")))
        with (folder / "steps").open("a") as file:
            file.write(f"{step}\n")
    report = json.dumps({"kind": kind, "job": job_lease.job_id}).encode()
    store_result(
        job_lease, stores, {"kind": kind}, report, {PLOT_FILE: b"\x89PNG of " + job_lease.job_id.encode()}
    )


if __name__ == "__main__":
    main(fake_build, fake_analysis)
