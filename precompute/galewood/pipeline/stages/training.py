"""The runs of a model that a table is made from, and what they are fitted with.

A build and the evaluation of its table plan the same runs and fit the same modes by these functions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from galewood.options import TableRequest
from galewood.pipeline.reduction import (
    ModalTraining,
    Oscillators,
    oscillators_of,
    size_for,
    training_winds,
)
from galewood.pipeline.sampling import SampledRun, Samples, plan_samples
from galewood.solid.fem import FemModel
from galewood.util import Array, Floats


@dataclass(frozen=True)
class TrainingModel:
    """The finite-element model of a tree of this height, whose runs make a table."""

    fem: FemModel
    height_m: float
    points: Array
    """Vertices at which the paper's states are recorded."""

    @cached_property
    def oscillators(self) -> Oscillators:
        """The natural modes; computed once for all tables."""
        return oscillators_of(self.fem)

    @property
    def mass_kg(self) -> Floats:
        """(n,) masses of the vertices of the tetrahedra, kg."""
        return self.fem.mass_kg[: self.fem.vertex_count]

    def plan(self, design_speed_m_s: float, options: TableRequest, cache_dir: Path) -> Samples:
        """The runs of a table, simulated or not; the paper's have winds up to the design speed."""
        winds = training_winds(self.oscillators, self.mass_kg, self.height_m, self.fem.settings, options.seed)
        return plan_samples(
            self.fem, design_speed_m_s, self.points, cache_dir, winds,
            frames=options.frames, all_winds=options.all_cosine_winds,
        )  # fmt: skip

    def training(self, runs: Sequence[SampledRun], modes: int | None) -> ModalTraining:
        """The training of a modal model of ``modes`` oscillators, or of the standard size."""
        return ModalTraining(self.oscillators, self.fem.settings, runs, size_for(modes))
