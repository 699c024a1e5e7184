"""Comparison with trees in the field; in: tree files, measured frequencies; out: report, pull and release."""

from galewood.check.field.comparison import FieldOptions, run_field
from galewood.check.field.decay import fitted_decay
from galewood.check.field.measurements import FieldError, Measurement, read_measurements
from galewood.check.field.plots import decay_figure
from galewood.check.field.release import pull_and_release
from galewood.check.field.simulated import tree_of_file
from galewood.check.field.statistics import broadleaf_hz, conifer_hz
from galewood.check.field.stem_section import diameter_cm

__all__ = [
    "FieldError",
    "FieldOptions",
    "Measurement",
    "broadleaf_hz",
    "conifer_hz",
    "decay_figure",
    "diameter_cm",
    "fitted_decay",
    "pull_and_release",
    "read_measurements",
    "run_field",
    "tree_of_file",
]
