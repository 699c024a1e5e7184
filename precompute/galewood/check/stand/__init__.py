"""What the wind does to the stems of a stand; in: an inventory, strain of built-in trees; out: a report."""

from galewood.check.stand.forms import TreeForm, form_of_rods
from galewood.check.stand.report import StandOptions, StandReport, form_name, stand_report
from galewood.check.stand.shelter import edge_distances_m, shelter_factor
from galewood.check.stand.writing import check_writable, write_report

__all__ = [
    "StandOptions",
    "StandReport",
    "TreeForm",
    "check_writable",
    "edge_distances_m",
    "form_name",
    "form_of_rods",
    "shelter_factor",
    "stand_report",
    "write_report",
]
