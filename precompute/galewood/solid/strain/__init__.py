"""Bending strain of a tree in wind; in: an imported tree, wood, wind; out: strain of its sections, and the
gust speed that breaks it."""

from galewood.solid.strain.critical import (
    DIRECTIONS_DEG,
    QUANTILES,
    STRONGEST_M_S,
    CriticalOptions,
    CriticalWind,
    Rupture,
    critical_wind_of,
)
from galewood.solid.strain.gust_strain import GustStrain, strain_in_gusts, with_top_speed
from galewood.solid.strain.limited import strain_limited
from galewood.solid.strain.sections import CAUTION_TEXT, TreeStrain, strain_in_wind
from galewood.solid.strain.spread import Sample, samples
from galewood.solid.strain.tree_rods import WindRods, wind_rods

__all__ = [
    "CAUTION_TEXT",
    "DIRECTIONS_DEG",
    "QUANTILES",
    "STRONGEST_M_S",
    "CriticalOptions",
    "CriticalWind",
    "GustStrain",
    "Rupture",
    "Sample",
    "TreeStrain",
    "WindRods",
    "critical_wind_of",
    "samples",
    "strain_in_gusts",
    "strain_in_wind",
    "strain_limited",
    "wind_rods",
    "with_top_speed",
]
