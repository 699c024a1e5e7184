"""The stages of a build after its table: the paper's records, and the table of the bare tree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from galewood.pipeline.results import BuildResult
from galewood.pipeline.sampling import simulate
from galewood.pipeline.stages.context import BuildContext, runs_as
from galewood.pipeline.stages.motion import FittedTree, plan_runs
from galewood.pipeline.stages.stage import Stage
from galewood.pipeline.tables import assemble_records, build_report, has_leaves
from galewood.solid.model import bind_foliage, build_model, compare_with_reference
from galewood.table import Records, encode, encode_records

BARE_TABLE_FILE = "bare.table"
"""Name under which a build publishes the table without leaves."""
BARE_REPORT_KEYS = ("foliage", "model", "design_wind", "table", "drawn")
"""Parts of the report that differ for the tree without its leaves."""


@dataclass(frozen=True)
class RecordedTree:
    """A tree with its table, and what belongs to it."""

    fitted: FittedTree
    records: Records | None
    """The records of the paper's state search; None: not wanted."""
    records_file: bytes | None
    reference: dict[str, Any] | None
    """The comparison with the reference model; None: there is none."""

    def result(self, context: BuildContext) -> BuildResult:
        """The result of the build so far."""
        report = self.fitted.report(self.records, self.reference) | context.progress.durations
        return replace(self.fitted.result(context), records=self.records_file, report=report)


@dataclass(frozen=True)
class BareTable:
    """The table of a tree without its leaves, which has no records, and what the report says of it."""

    table: bytes
    report: dict[str, Any]


@runs_as(Stage.RECORDS)
def compute_records(fitted: FittedTree, context: BuildContext) -> RecordedTree:
    """Compute the records of the paper's method, if they are wanted, and compare the model meanwhile.

    They are passed on if the bare table follows, so that they need not wait for it.
    """
    reference = _start_comparison(fitted, context)
    records = _records(fitted, context) if context.options.paper else None
    records_file = encode_records(records, fitted.table_sha256) if records else None
    recorded = RecordedTree(fitted, records, records_file, reference())
    if records and wants_bare_table(recorded, context):
        context.on_table(recorded.result(context))
    return recorded


def _records(fitted: FittedTree, context: BuildContext) -> Records:
    """Simulate the paper's recorded runs and compute their candidate lists."""
    options, progress, samples = context.options, context.progress, fitted.modelled.samples
    count = max(len(samples.paper), 1)
    context.runner(samples.paper, lambda number: progress.report(0.6 * number / count))
    records = assemble_records(
        samples.paper_runs(),
        [task.wind for task in samples.paper],
        fitted.part,
        options.table,
        lambda share: progress.report(0.6 + 0.4 * share),
    )
    records.metadata["sampled_elements"] = options.sampled_elements
    return records


def _start_comparison(fitted: FittedTree, context: BuildContext) -> Callable[[], dict[str, Any] | None]:
    """Start the comparison with the reference model; the returned function waits for the result.

    The result is None if no frames are wanted, or if the model is the reference itself.
    """
    model, solid, frames = fitted.modelled.model.fem, fitted.modelled.solid, context.options.reference_frames
    if model.settings.element != "fitted" or not frames:
        return lambda: None
    return context.pool.start(
        compare_with_reference, model, solid.mesh, solid.skeleton, solid.wood, solid.lumped, frames
    ).result


def wants_bare_table(recorded: RecordedTree, context: BuildContext) -> bool:
    """Whether a build also makes the table of the tree without its leaves; evergreens keep theirs."""
    solid = recorded.fitted.modelled.solid
    return context.options.bare_table and has_leaves(solid.tree, context.options) and not solid.wood.evergreen


@runs_as(Stage.BARE)
def build_bare_table(recorded: RecordedTree, context: BuildContext) -> BareTable:
    """Build the table of the same tree, tetrahedra and vertices without its leaves."""
    in_leaf = recorded.fitted.modelled.solid
    options = context.options.model_copy(update={"foliage": "bare", "paper": False})
    lumped = bind_foliage(in_leaf.tree, in_leaf.mesh, in_leaf.wood, leaves=False)
    solid = replace(in_leaf, lumped=lumped)
    fem = build_model(solid.mesh, solid.skeleton, solid.wood, lumped, options.fem)
    bare = plan_runs(solid, fem, options, context.cache_dir)
    simulate(bare.samples, context.runner, lambda share: context.progress.report(0.9 * share))
    table = bare.table().table
    report = build_report(solid.tree, solid.with_model(fem), bare.wind, table, None, None)
    made = BareTable(encode(table), {name: report[name] for name in BARE_REPORT_KEYS})
    context.artefacts.publish(BARE_TABLE_FILE, lambda: made.table)
    return made
