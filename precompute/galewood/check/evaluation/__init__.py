"""Comparison of a table with the finite-element reference solution on winds it was not built from."""

from galewood.check.evaluation.evaluate import METHODS, Forest, Make, evaluate_table, play_pressures
from galewood.check.evaluation.long_run import play_beyond_range
from galewood.check.evaluation.measures import FRAMES_SHOWN, hausdorff
from galewood.check.evaluation.plot import error_figure
from galewood.check.evaluation.reference_runs import ReferenceTask, read_reference_run, run_references
from galewood.check.evaluation.report import run_evaluation
from galewood.check.evaluation.source import Source, SourceError, recorded_runs, samples_of, source_of
from galewood.check.evaluation.tracks import Comparison, Place, comparison_tracks, nodes_on_wood
from galewood.check.evaluation.winds import directed_pressure

__all__ = [
    "FRAMES_SHOWN",
    "METHODS",
    "Comparison",
    "Forest",
    "Make",
    "Place",
    "ReferenceTask",
    "Source",
    "SourceError",
    "comparison_tracks",
    "directed_pressure",
    "error_figure",
    "evaluate_table",
    "hausdorff",
    "nodes_on_wood",
    "play_beyond_range",
    "play_pressures",
    "read_reference_run",
    "recorded_runs",
    "run_evaluation",
    "run_references",
    "samples_of",
    "source_of",
]
