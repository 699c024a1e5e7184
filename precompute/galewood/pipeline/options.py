"""Options, progress and result of a build."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from galewood.fem import FemSettings
from galewood.mesh import ImportOptions
from galewood.options import BuildRequest, ImportRequest, import_options
from galewood.pipeline.table_settings import TableSettings
from galewood.sampling import SEED
from galewood.table import Foliage, decode, encode
from galewood.util import cpu_seconds
from galewood.wood import Wood

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
AFTER_TABLE: tuple[Stage, ...] = ("records", "bare")
"""Stages after the complete table of the default method; each counts from 0 to 1 on its own."""
FURTHER = "Computing additional training runs for large bending"
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
class BuildOptions:
    """All inputs of a build besides the mesh.

    ``frames`` is the length of each of the paper's cosine winds, ``seed`` the seed of the training winds of
    the modal model. With ``fem.element`` "quadratic" the table is built from the reference model itself.
    """

    mesh_import: ImportOptions = field(default_factory=ImportOptions)
    wood: Wood | None = None
    """Wood of the tree; None: the wood of its species."""
    first_frequency_hz: float | None = None
    """First frequency to which the stiffness of the wood is scaled, Hz; None: as stiff as its wood."""
    sway: float | None = None
    """Share of the height by which a steady wind of 18 m/s bends the tree; sets the stiffness likewise."""
    target_tets: int = 5500
    sampled_elements: int = 35
    design_speed_m_s: float = 18.0
    frames: int = 180
    seed: int = SEED
    reference_frames: int = 60
    """Frames of the run that compares the model with the quadratic reference model; 0: no comparison."""
    paper: bool = True
    """Whether the records of the paper's state search are computed after the default method's table."""
    foliage: Foliage = "leaf"
    """Whether the model bears its leaves; "bare": only the mass and the wind area of the wood."""
    bare_table: bool = False
    """Whether a tree with leaves also gets a table without them; no effect with ``foliage`` "bare"."""
    all_cosine_winds: bool = False
    """Whether the paper's records come from all its 36 cosine winds, not from 18 of them."""
    fem: FemSettings = field(default_factory=FemSettings)
    table: TableSettings = field(default_factory=TableSettings)


EXPECTED_MOTION = "galewood.pipeline.expected:with_expected_motion"
"""What a sandboxed mesh import can add to its report: how the tree will move."""
OF_PARTS = ("modes", "wood", "root_stiffness_knm")
"""Fields of a request that belong to a part of the build options."""


def build_options(request: BuildRequest) -> BuildOptions:
    """Convert a request to build options; what the request omits keeps its default."""
    given = request.model_dump(exclude_none=True, exclude={*OF_PARTS, *ImportRequest.model_fields})
    root_knm = request.root_stiffness_knm
    return BuildOptions(
        mesh_import=import_options(request),
        wood=request.wood.wood() if request.wood else None,
        fem=FemSettings(root_stiffness_nm_rad=None if root_knm is None else 1000 * root_knm),
        table=TableSettings(modes=request.modes),
        **given,
    )


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
        if stage in AFTER_TABLE:
            self._progress(Progress(stage, min(max(fraction, 0.0), 1.0), message or MESSAGES[stage]))
            return
        order = list(SHARES)
        before = sum(SHARES[other] for other in order[: order.index(stage)])
        whole = 1.0 if stage == "done" else before + SHARES[stage] * min(max(fraction, 0.0), 1.0)
        self._progress(Progress(stage, min(whole, 1.0), message or MESSAGES[stage]))
