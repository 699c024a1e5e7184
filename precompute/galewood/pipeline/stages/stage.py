"""The stages of a build in order, and the progress through them."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Self

from galewood.constants import STAGES_AFTER_TABLE
from galewood.util import cpu_seconds


class Stage(StrEnum):
    """A stage of a build; the value is its name in reports, in the database and in the REST interface."""

    share: float
    """Share of the stage in the time until the complete table of the default method."""
    message: str
    """What is done, in words for the user."""

    def __new__(cls, name: str, share: float, message: str) -> Self:
        """A stage of this name."""
        stage = str.__new__(cls, name)
        stage._value_ = name
        stage.share, stage.message = share, message
        return stage

    IMPORT = "import", 0.05, "Reading the mesh"
    MESHING = "meshing", 0.29, "Meshing the wood"
    SKELETON = "skeleton", 0.05, "Extracting the skeleton and attaching the foliage"
    MODEL = "model", 0.15, "Assigning material"
    SAMPLING = "sampling", 0.36, "Computing the training runs"
    TABLE = "table", 0.1, "Fitting the modal model"
    RECORDS = "records", 0.0, "Computing the records of the paper's method"
    BARE = "bare", 0.0, "Computing the table of the tree without its leaves"
    DONE = "done", 0.0, "Done"

    @property
    def share_before(self) -> float:
        """Share of the stages before this one."""
        stages = list(Stage)
        return sum(other.share for other in stages[: stages.index(self)])


@dataclass(frozen=True)
class Progress:
    """Progress of a build: current stage, completed fraction 0..1, and a message for the user.

    The fraction reaches 1 with the complete table of the default method, and then counts the stages "records"
    and "bare" from 0 to 1 each.
    """

    stage: Stage
    fraction: float
    message: str


class StageProgress:
    """Reports the progress of a build and records the duration of each stage."""

    def __init__(self, progress: Callable[[Progress], None]) -> None:
        self._progress = progress
        self._started_s = self._started_cpu_s = 0.0
        self._stage: Stage | None = None
        self._seconds: dict[str, float] = {}
        self._cpu_seconds: dict[str, float] = {}

    @property
    def durations(self) -> dict[str, dict[str, float]]:
        """Durations of the stages that have ended: ``seconds`` of wall-clock time, and ``cpu_seconds`` of the
        build's processes on this machine.
        """
        return {"seconds": dict(self._seconds), "cpu_seconds": dict(self._cpu_seconds)}

    def enter(self, stage: Stage) -> None:
        """End the previous stage and start this one."""
        now_s, cpu_s = time.perf_counter(), cpu_seconds()
        if self._stage is not None:
            self._seconds[self._stage.value] = round(now_s - self._started_s, 3)
            self._cpu_seconds[self._stage.value] = round(cpu_s - self._started_cpu_s, 3)
        self._stage, self._started_s, self._started_cpu_s = stage, now_s, cpu_s
        self.report(0.0)

    def report(self, fraction: float, message: str = "") -> None:
        """Report that ``fraction`` of the current stage is done. Raises what the callback raises."""
        stage = self._stage or Stage.IMPORT
        part = min(max(fraction, 0.0), 1.0)
        if stage is Stage.DONE:
            part = 1.0
        elif stage not in STAGES_AFTER_TABLE:
            part = min(stage.share_before + stage.share * part, 1.0)
        self._progress(Progress(stage, part, message or stage.message))
