"""Builds the tables of one tree from its runs: the preliminary and the final one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from galewood.fem import FemModel
from galewood.mesh import TreeMesh
from galewood.pipeline.assemble import RenderMesh, assemble_table
from galewood.pipeline.options import BuildOptions
from galewood.pipeline.report import describe
from galewood.reduction import ModalTraining, Oscillators, oscillators_of, sizes_for
from galewood.sampling import DesignWind, SampledRun, Samples, SampleWind
from galewood.table import Table


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

    def preliminary(self, samples: Samples) -> Table:
        """Build a small table from the first runs only, marked as preliminary."""
        table = self.build(samples.first())
        table.metadata["provenance"]["preliminary"] = True
        return table

    def build(
        self,
        samples: Samples,
        on_progress: Callable[[float], None] = lambda fraction: None,
        further: Callable[[], Sequence[SampledRun]] = tuple,
    ) -> Table:
        """Build the table of these runs.

        ``further`` returns additional training runs; it is called only if the first ones do not suffice.
        """
        winds, further_winds = samples.winds, list[SampleWind]()

        def further_runs() -> Sequence[SampledRun]:
            runs = further()
            own = {task.path for task in samples.paper}
            added = [task for task in samples.further[: len(runs)] if task.path not in own]
            further_winds.extend(task.wind for task in added)
            return runs

        description = describe(self.tree, self.model, self.wind, winds, self.options, self.render_glb)
        training = ModalTraining(
            self.oscillators,
            self.options.fem,
            samples.default_runs(),
            sizes_for(self.options.table.modes),
            further_runs,
        )
        mass_kg = self.model.mass_kg[: self.model.vertex_count]
        table = assemble_table(
            samples.paper_runs(),
            mass_kg,
            self.surface,
            description,
            self.options.table,
            training,
            on_progress,
        )
        provenance = table.metadata["provenance"]
        provenance["winds"] += [wind.name for wind in further_winds]
        provenance["frames"] += [len(wind.pressure_pa) for wind in further_winds]
        return table
