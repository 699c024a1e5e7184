"""Builds the tables of one tree: the first from its modes, an early and the final one from its runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from galewood.pipeline.reduction import (
    ModalTraining,
    Oscillators,
    TrainingWinds,
    oscillators_of,
    sizes_for,
    training_winds,
)
from galewood.pipeline.sampling import DesignWind, SampledRun, Samples, SampleTask, SampleWind
from galewood.pipeline.stages.assemble import (
    DefaultPart,
    TableContext,
    assemble_default,
    assemble_first,
    assemble_records,
)
from galewood.pipeline.stages.options import BuildOptions
from galewood.pipeline.stages.report import body_of, describe
from galewood.pipeline.stages.surface import RenderMesh
from galewood.solid.fem import FemModel
from galewood.table import Records, Table
from galewood.tree import TreeMesh

LEFT_OUT_OF_FIRST = [
    "the change of stiffness, damping and wind load with the sway",
    "the curved paths of branches that bend far",
]
LEFT_OUT_OF_EARLY = ["two thirds of the training runs"]


@dataclass(frozen=True)
class TableBuilder:
    """Everything that a table contains besides its motion."""

    tree: TreeMesh
    model: FemModel
    wind: DesignWind
    surface: RenderMesh
    options: BuildOptions
    render_glb: bytes

    @cached_property
    def oscillators(self) -> Oscillators:
        """Natural modes of the tree; computed once for all its tables."""
        return oscillators_of(self.model)

    @cached_property
    def training_winds(self) -> TrainingWinds:
        """The winds of the default method's runs."""
        body, mass_kg = self.oscillators, self.model.mass_kg[: self.model.vertex_count]
        return training_winds(body, mass_kg, self.tree.height_m, self.options.fem, self.options.seed)

    def first(self, samples: Samples) -> Table:
        """The table of the natural modes alone, for motion before any run is simulated."""
        winds = [task.wind for task in samples.default]
        of = self._context([])
        table = assemble_first(self.oscillators, [wind.pressure_pa for wind in winds], self.options.fem, of)
        return _preliminary(table, "first", LEFT_OUT_OF_FIRST)

    def early(self, samples: Samples) -> Table:
        """The table of the first runs only."""
        return _preliminary(self.default(samples.first()).table, "early", LEFT_OUT_OF_EARLY)

    def default(self, samples: Samples, further: Callable[[], Sequence[SampledRun]] = tuple) -> DefaultPart:
        """The complete table of the default method.

        ``further`` returns additional training runs; it is called only if the first ones do not suffice.
        """
        tasks: list[SampleTask] = [*samples.default]

        def further_runs() -> Sequence[SampledRun]:
            runs = further()
            tasks.extend(samples.further[: len(runs)])
            return runs

        training = ModalTraining(
            self.oscillators,
            self.options.fem,
            samples.default_runs(),
            sizes_for(self.options.table.modes),
            further_runs,
        )
        part = assemble_default(training, self._context([]))
        part.table.metadata["provenance"]["stage"] = "complete"
        part.table.metadata["provenance"].update(_winds([task.wind for task in tasks]))
        return part

    def records(
        self, default: DefaultPart, samples: Samples, on_progress: Callable[[float], None]
    ) -> Records:
        """The records of the paper's state search for a table of ``default``."""
        winds = [task.wind for task in samples.paper]
        records = assemble_records(samples.paper_runs(), winds, default, self.options.table, on_progress)
        records.metadata["sampled_elements"] = self.options.sampled_elements
        return records

    def _context(self, winds: list[SampleWind]) -> TableContext:
        body, speed_m_s = body_of(self.model), self.wind.speed_m_s
        description = describe(self.tree, body, speed_m_s, self.options, self.render_glb)
        description["provenance"].update(_winds(winds))
        mass_kg = self.model.mass_kg[: self.model.vertex_count]
        return TableContext(mass_kg, self.surface, description, self.options.table)


def _winds(winds: Sequence[SampleWind]) -> dict[str, list[object]]:
    return {"winds": [wind.name for wind in winds], "frames": [len(wind.pressure_pa) for wind in winds]}


def _preliminary(table: Table, stage: str, left_out: list[str]) -> Table:
    table.metadata["provenance"] |= {"stage": stage, "preliminary": True, "left_out": left_out}
    return table
