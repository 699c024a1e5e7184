"""The stages of a build that make the table of the default method: model, training runs, fit."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from galewood.pipeline.results import BuildResult
from galewood.pipeline.sampling import DesignWind, Samples, SampleTask, design_wind, simulate
from galewood.pipeline.stages.context import BuildContext, runs_as
from galewood.pipeline.stages.kept_fit import KeptFit, fit_path, keep_fit, kept_fit
from galewood.pipeline.stages.solid import SolidTree
from galewood.pipeline.stages.stage import Stage
from galewood.pipeline.stages.training import TrainingModel
from galewood.pipeline.tables import (
    BuildOptions,
    DefaultPart,
    TableContext,
    TableStage,
    assemble_default,
    body_of,
    build_report,
    compliance_file,
    describe,
    goal_of,
    scaled_to,
)
from galewood.solid.fem import FemModel, Simulator
from galewood.solid.model import unloaded_model
from galewood.table import Records


@dataclass(frozen=True)
class ModelledTree:
    """A tree with its finite-element model, its design wind and the runs of its table."""

    solid: SolidTree
    model: TrainingModel
    wind: DesignWind
    samples: Samples
    options: BuildOptions

    def table(self) -> DefaultPart:
        """Fit a table to the simulated runs."""
        training = self.model.training(self.samples.default_runs(), self.options.modes)
        part = assemble_default(training, self._context())
        TableStage.COMPLETE.mark(part.table)
        part.table.metadata["provenance"].update(_winds(self.samples.default))
        return part

    def _context(self) -> TableContext:
        body, render_glb = body_of(self.model.fem), self.solid.imported.render_glb
        description = describe(self.solid.tree, body, self.wind.speed_m_s, self.options, render_glb)
        description["provenance"].update(_winds(()))
        return TableContext(self.model.mass_kg, self.solid.surface, description, self.options.table)


@dataclass(frozen=True)
class SimulatedTree:
    """A tree whose training runs are simulated."""

    modelled: ModelledTree


@dataclass(frozen=True)
class FittedTree:
    """A tree with the complete table of the default method."""

    modelled: ModelledTree
    part: DefaultPart
    table: bytes
    """The table file."""
    compliance: bytes | None
    """The compliance file."""

    @property
    def table_sha256(self) -> str:
        """Hash of the table file."""
        return hashlib.sha256(self.table).hexdigest()

    def report(
        self, records: Records | None = None, reference: dict[str, Any] | None = None
    ) -> dict[str, Any]:
        """What the build assumed and measured, with the records and the comparison if there are some."""
        tree = self.modelled
        made = tree.solid.with_model(tree.model.fem)
        return build_report(tree.solid.tree, made, tree.wind, self.part.table, records, reference)

    def result(self, context: BuildContext) -> BuildResult:
        """The result of the build so far."""
        render_glb = self.modelled.solid.imported.render_glb
        report = self.report() | context.progress.durations
        return BuildResult(self.table, None, render_glb, report, compliance=self.compliance)


@runs_as(Stage.MODEL)
def build_fem(solid: SolidTree, context: BuildContext) -> ModelledTree:
    """Build the finite-element model, find its design wind and plan its runs. Raises MeshError."""
    model, solid = fem_of(solid, context.options)
    modelled = plan_runs(solid, model, context.options, context.cache_dir)
    context.artefacts.wait()
    return modelled


def fem_of(solid: SolidTree, options: BuildOptions) -> tuple[FemModel, SolidTree]:
    """The model of a tree, and the tree with the wood of that model, which may be softer or stiffer."""
    unloaded = unloaded_model(solid.mesh, solid.skeleton, solid.wood, solid.lumped, options.fem)
    goal = goal_of(solid.tree, solid.wood, options)
    if goal is None:
        return unloaded.standing(), solid
    model, factor = scaled_to(goal, unloaded.standing)
    return model, replace(solid, wood=solid.wood.scaled(factor))


def plan_runs(solid: SolidTree, fem: FemModel, options: BuildOptions, cache_dir: Path) -> ModelledTree:
    """A model at its design wind, with the runs of its table, simulated or not."""
    height_m = solid.tree.height_m
    wind = design_wind(
        Simulator(fem), options.design_speed_m_s, height_m, options.fem.dt_s, fem.streamlined_exponent
    )
    model = TrainingModel(fem, height_m, solid.points)
    return ModelledTree(solid, model, wind, model.plan(wind.speed_m_s, options, cache_dir), options)


@runs_as(Stage.SAMPLING)
def simulate_runs(modelled: ModelledTree, context: BuildContext) -> SimulatedTree:
    """Simulate the training runs of the default method."""
    simulate(modelled.samples, context.runner, context.progress.report)
    return SimulatedTree(modelled)


@runs_as(Stage.TABLE)
def fit_table(simulated: SimulatedTree, context: BuildContext) -> FittedTree:
    """Fit the default method to the training runs, and pass on its complete table."""
    tree = simulated.modelled
    path = fit_path(
        context.cache_dir,
        [task.path.stem for task in tree.samples.default],
        hashlib.sha256(tree.solid.imported.render_glb).hexdigest(),
        context.options.model_dump(mode="json"),
    )
    with ThreadPoolExecutor(1) as beside:  # compiled code for the most part, which lets the fit go on
        compliance = beside.submit(
            compliance_file,
            tree.model.fem,
            tree.solid.surface.embedding,
            hashlib.sha256(tree.solid.imported.render_glb).hexdigest(),
        )
        fit = kept_fit(path)
        if fit is None:
            fit = KeptFit.of(tree.table())
            keep_fit(path, fit)
    fitted = FittedTree(tree, fit.part, fit.table, compliance.result())
    context.on_table(fitted.result(context))
    return fitted


def _winds(tasks: Sequence[SampleTask]) -> dict[str, list[object]]:
    return {
        "winds": [task.wind.name for task in tasks],
        "frames": [len(task.wind.pressure_pa) for task in tasks],
    }
