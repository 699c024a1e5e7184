"""What a build is asked for, what it tells on the way and what it hands back."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

from galewood.fem import FemSettings
from galewood.mesh import ImportOptions
from galewood.options import BuildRequest, ImportRequest, import_options
from galewood.pipeline.assemble import TableSettings
from galewood.sampling import SEED
from galewood.util import cpu_seconds
from galewood.wood import Wood

Stage = Literal["import", "meshing", "skeleton", "model", "sampling", "table", "done"]

SHARES: dict[Stage, float] = {
    "import": 0.02,
    "meshing": 0.22,
    "skeleton": 0.03,
    "model": 0.16,
    "sampling": 0.42,
    "table": 0.14,
    "done": 0.0,
}
"""Share of each stage in a usual build's time."""
MESSAGES: dict[Stage, str] = {
    "import": "Reading the mesh",
    "meshing": "Filling the wood with tetrahedra",
    "skeleton": "Finding the skeleton and hanging the leaves on it",
    "model": "Fitting stiffness, mass and damping",
    "sampling": "Simulating the sample winds",
    "table": "Comparing all states with each other",
    "done": "Done",
}
FURTHER = "Simulating more winds: this tree bends far"
"""In place of the table's message while it is so."""


@dataclass(frozen=True)
class Progress:
    """How far a build is: fraction 0..1 of the whole."""

    stage: Stage
    fraction: float
    message: str


@dataclass(frozen=True)
class BuildOptions:
    """Everything that shapes a table besides the mesh.

    ``frames`` is the length of each of the paper's cosine winds, ``seed`` that of the noise and gusts which
    the drift-free method learns from. ``fem.element`` "quadratic" makes the table from the reference itself.
    """

    mesh_import: ImportOptions = field(default_factory=ImportOptions)
    wood: Wood | None = None
    """What the tree is made of; None: the wood of its species."""
    target_tets: int = 5500
    sampled_elements: int = 35
    design_speed_m_s: float = 18.0
    frames: int = 180
    seed: int = SEED
    reference_frames: int = 60
    """Frames of the run that compares the model with the quadratic reference; 0: no comparison."""
    fem: FemSettings = field(default_factory=FemSettings)
    table: TableSettings = field(default_factory=TableSettings)


def build_options(request: BuildRequest) -> BuildOptions:
    """The options of a build; whatever the request leaves out keeps its default."""
    given = request.model_dump(exclude_none=True, exclude={"modes", "wood", *ImportRequest.model_fields})
    return BuildOptions(
        mesh_import=import_options(request),
        wood=request.wood.wood() if request.wood else None,
        table=TableSettings(modes=request.modes),
        **given,
    )


@dataclass(frozen=True)
class BuildResult:
    """The table file, the render mesh it moves (a GLB), and everything assumed and measured (JSON-able)."""

    table: bytes
    render_glb: bytes
    report: dict[str, Any]


class Stages:
    """Tells a callback where a build is, and notes the seconds of each stage: of the clock, and of all cores.

    The second counts the build's own processes, not a cluster's.
    """

    def __init__(self, progress: Callable[[Progress], None]) -> None:
        self._progress = progress
        self._begun = self._spent = 0.0
        self._stage: Stage | None = None
        self.seconds: dict[str, float] = {}
        self.cpu_seconds: dict[str, float] = {}

    def enter(self, stage: Stage) -> None:
        """The stage begins (and the one before is over)."""
        now_s, spent_s = time.perf_counter(), cpu_seconds()
        if self._stage is not None:
            self.seconds[self._stage] = round(now_s - self._begun, 3)
            self.cpu_seconds[self._stage] = round(spent_s - self._spent, 3)
        self._stage, self._begun, self._spent = stage, now_s, spent_s
        self.report(0.0)

    def report(self, fraction: float, message: str = "") -> None:
        """``fraction`` of the present stage is done. Raises what the callback raises."""
        stage = self._stage or "import"
        order = list(SHARES)
        before = sum(SHARES[other] for other in order[: order.index(stage)])
        whole = 1.0 if stage == "done" else before + SHARES[stage] * min(max(fraction, 0.0), 1.0)
        self._progress(Progress(stage, min(whole, 1.0), message or MESSAGES[stage]))
