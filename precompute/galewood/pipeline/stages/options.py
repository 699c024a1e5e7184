"""Options, progress and result of a build."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from galewood.constants import STAGES_AFTER_TABLE
from galewood.options import BuildRequest
from galewood.solid.fem import FemSettings
from galewood.table import decode, encode
from galewood.util import cpu_seconds

Stage = Literal["import", "meshing", "skeleton", "model", "sampling", "table", "records", "bare", "done"]

SHARES: dict[Stage, float] = {
    "import": 0.05,
    "meshing": 0.29,
    "skeleton": 0.05,
    "model": 0.15,
    "sampling": 0.36,
    "table": 0.1,
    "records": 0.0,
    "bare": 0.0,
    "done": 0.0,
}
"""Share of each stage in the time until the default method's table is complete."""
MESSAGES: dict[Stage, str] = {
    "import": "Reading the mesh",
    "meshing": "Meshing the wood",
    "skeleton": "Extracting the skeleton and attaching the foliage",
    "model": "Assigning material",
    "sampling": "Computing the training runs",
    "table": "Fitting the modal model",
    "records": "Computing the records of the paper's method",
    "bare": "Computing the table of the tree without its leaves",
    "done": "Done",
}
FURTHER_RUNS_MESSAGE = "Computing additional training runs for large bending"
"""Message of the table stage while additional training runs are simulated."""


@dataclass(frozen=True)
class Progress:
    """Progress of a build: current stage, completed fraction 0..1, and a message for the user.

    The fraction reaches 1 with the complete table of the default method, and then counts the stages "records"
    and "bare" from 0 to 1 each.
    """

    stage: Stage
    fraction: float
    message: str


@dataclass(frozen=True)
class TableSettings:
    """Parameters and tolerances of a table (docs/design/0002-pose-easing.md explains the defaults)."""

    modes: int | None = None
    """Oscillators of the modal model; None: as few of the standard sizes as follow the training runs."""
    sigma_share: float = 0.3
    """σ of Eq. 16 over the RMS pressure of the records."""
    weight_leverage: float = 0.94
    """w / (1 − w) at the largest weight, over the median E_int; relative, as stiff trees differ less."""
    weight_initial: float | None = None
    """Initial weight; None: 5 % below the largest weight."""
    weight_maximum: float | None = None
    """Largest weight; None: derived from ``weight_leverage``."""
    weight_growth: float = 0.01
    pose_easing: float = 0.08
    truncation_share: float = 8.6e-4
    """Largest vertex error of the reduced basis over the height."""
    node_share: float = 5e-4
    """Largest deviation of a branch from the interpolation between nodes in strong wind, over the height."""
    node_sway_share: float = 0.003
    """The same over the largest motion of the tree, so that stiff trees also bend smoothly."""


class BuildOptions(BuildRequest):
    """All inputs of a build besides the mesh: a request, and what the service does not offer.

    With ``reference`` the table is built from the reference model itself.
    """

    reference: bool = Field(
        default=False, description="Use the quadratic reference elements: about ten times as slow."
    )
    reference_frames: int = Field(
        default=60,
        ge=0,
        description="Frames of the run that is compared with the reference elements; 0: no comparison.",
    )

    @property
    def fem(self) -> FemSettings:
        """Settings of the finite elements."""
        element = "quadratic" if self.reference else "fitted"
        return FemSettings(element=element, root_stiffness_nm_rad=self.root_stiffness_nm_rad)

    @property
    def table(self) -> TableSettings:
        """Parameters of the table."""
        return TableSettings(modes=self.modes)


EXPECTED_MOTION = "galewood.pipeline.stages.expected:with_expected_motion"
"""What a sandboxed mesh import can add to its report: how the tree will move."""


@dataclass(frozen=True)
class BuildResult:
    """The table file, its render mesh (GLB), and a JSON-able report of all assumptions and measurements."""

    table: bytes
    records: bytes | None
    """The records file of the paper's state search; None: not computed, or not yet."""
    render_glb: bytes
    report: dict[str, Any]
    bare_table: bytes | None = None
    """The table of the same mesh without its leaves; None: not wanted, not computed yet, or no leaves."""
    compliance: bytes | None = None
    """The compliance file, for pulling the tree; None: unstable rest pose, or too many nodes."""

    def whole_table(self) -> bytes:
        """The table file with the records inside, for use outside the service."""
        return encode(decode(self.table, self.records)) if self.records else self.table


def bare_path(table: Path) -> Path:
    """Where the bare table of a tree is kept: tree.bare.gwt beside tree.gwt."""
    return table.with_name(f"{table.stem}.bare{table.suffix}")


class Stages:
    """Reports the progress of a build and records the duration of each stage.

    ``seconds`` is wall-clock time; ``cpu_seconds`` is CPU time of the build's processes on this machine.
    """

    def __init__(self, progress: Callable[[Progress], None]) -> None:
        self._progress = progress
        self._started_s = self._started_cpu_s = 0.0
        self._stage: Stage | None = None
        self.seconds: dict[str, float] = {}
        self.cpu_seconds: dict[str, float] = {}

    def enter(self, stage: Stage) -> None:
        """End the previous stage and start this one."""
        now_s, cpu_s = time.perf_counter(), cpu_seconds()
        if self._stage is not None:
            self.seconds[self._stage] = round(now_s - self._started_s, 3)
            self.cpu_seconds[self._stage] = round(cpu_s - self._started_cpu_s, 3)
        self._stage, self._started_s, self._started_cpu_s = stage, now_s, cpu_s
        self.report(0.0)

    def report(self, fraction: float, message: str = "") -> None:
        """Report that ``fraction`` of the current stage is done. Raises what the callback raises."""
        stage = self._stage or "import"
        if stage in STAGES_AFTER_TABLE:
            self._progress(Progress(stage, min(max(fraction, 0.0), 1.0), message or MESSAGES[stage]))
            return
        order = list(SHARES)
        before = sum(SHARES[other] for other in order[: order.index(stage)])
        whole = 1.0 if stage == "done" else before + SHARES[stage] * min(max(fraction, 0.0), 1.0)
        self._progress(Progress(stage, min(whole, 1.0), message or MESSAGES[stage]))
