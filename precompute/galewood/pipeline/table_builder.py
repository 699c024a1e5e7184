"""Tables of one tree from its runs: an early one from the first of them, and the whole one."""

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
class TableMaker:
    """All that a table says and shows besides its motion."""

    tree: TreeMesh
    model: FemModel
    wind: DesignWind
    surface: RenderMesh
    options: BuildOptions
    render_glb: bytes

    @cached_property
    def oscillators(self) -> Oscillators:
        """The tree's own free motion, which every table of it builds on."""
        return oscillators_of(self.model)

    def preliminary(self, samples: Samples) -> Table:
        """A small table of the first runs alone, marked as preliminary."""
        table = self.make(samples.first())
        table.metadata["provenance"]["preliminary"] = True
        return table

    def make(
        self,
        samples: Samples,
        on_progress: Callable[[float], None] = lambda fraction: None,
        further: Callable[[], Sequence[SampledRun]] = tuple,
    ) -> Table:
        """The table of these runs, and of the ``further`` ones if the tree asks for them."""
        winds, asked = samples.winds, list[SampleWind]()

        def ask() -> Sequence[SampledRun]:
            runs = further()
            asked.extend(task.wind for task in samples.further[: len(runs)])
            return runs

        description = describe(self.tree, self.model, self.wind, winds, self.options, self.render_glb)
        training = ModalTraining(
            self.oscillators,
            self.options.fem,
            samples.training_runs(),
            sizes_for(self.options.table.modes),
            ask,
        )
        mass_kg = self.model.mass_kg[: self.model.vertex_count]
        table = assemble_table(
            samples.recorded_runs(),
            mass_kg,
            self.surface,
            description,
            self.options.table,
            training,
            on_progress,
        )
        provenance = table.metadata["provenance"]
        provenance["winds"] += [wind.name for wind in asked]
        provenance["frames"] += [len(wind.pressure_pa) for wind in asked]
        return table
