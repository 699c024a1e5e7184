"""Comparison of a table with the finite-element reference solution on winds it was not built from.

First in gusts that differ within the crown, as every forest plays them; then in winds that are the same over
the whole crown.
"""

from galewood.check.evaluation.evaluate import METHODS, Forest, Make, evaluate_table, play_pressures
from galewood.check.evaluation.gusts import GustCase, evaluate_in_gusts
from galewood.check.evaluation.long_run import play_beyond_range
from galewood.check.evaluation.measures import FRAMES_SHOWN, hausdorff
from galewood.check.evaluation.model_file import SourceError
from galewood.check.evaluation.plot import error_figure
from galewood.check.evaluation.reference_runs import ReferenceTask, read_reference_run, run_references
from galewood.check.evaluation.report import run_evaluation, sentences
from galewood.check.evaluation.source import Source, recorded_runs, samples_of, source_of
from galewood.check.evaluation.tracks import Comparison, Errors, comparison_tracks, nodes_on_wood
from galewood.check.evaluation.winds import directed_pressure, unseen_winds

__all__ = [
    "FRAMES_SHOWN",
    "METHODS",
    "Comparison",
    "Errors",
    "Forest",
    "GustCase",
    "Make",
    "ReferenceTask",
    "Source",
    "SourceError",
    "comparison_tracks",
    "directed_pressure",
    "error_figure",
    "evaluate_in_gusts",
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
    "sentences",
    "source_of",
    "unseen_winds",
]
