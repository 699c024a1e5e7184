"""What every stage of a build is given besides its input."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TypeVar

from galewood.pipeline.results import BuildResult
from galewood.pipeline.sampling import TrajectoryRunner
from galewood.pipeline.stages.artefacts import ArtefactPublisher
from galewood.pipeline.stages.stage import Stage, StageProgress
from galewood.pipeline.tables import BuildOptions
from galewood.tree import TreeMesh
from galewood.util import WorkerPool

OnImport = Callable[[TreeMesh], None]
"""Receives the tree as soon as it is read."""
OnTable = Callable[[BuildResult], None]
"""Receives the complete table of the default method, before the paper's records are computed; and again with
them if the table of the bare tree follows."""
Input = TypeVar("Input")
Output = TypeVar("Output")


@dataclass(frozen=True)
class BuildContext:
    """The options of a build, where it runs and whom it tells."""

    options: BuildOptions
    progress: StageProgress
    cache_dir: Path
    pool: WorkerPool
    runner: TrajectoryRunner
    artefacts: ArtefactPublisher
    on_import: OnImport
    on_table: OnTable


def runs_as(
    stage: Stage,
) -> Callable[[Callable[[Input, BuildContext], Output]], Callable[[Input, BuildContext], Output]]:
    """Decorator of a function that is a stage of a build: its call begins the stage."""

    def decorate(run: Callable[[Input, BuildContext], Output]) -> Callable[[Input, BuildContext], Output]:
        @wraps(run)
        def run_stage(given: Input, context: BuildContext) -> Output:
            context.progress.enter(stage)
            return run(given, context)

        return run_stage

    return decorate
