"""Strain and critical wind of the built-in trees: the table of docs/physics.md.

Run from the repository: ``python docs/examples/critical_wind.py docs/physics.md``. Other tree files may
follow; their rows are printed only.
"""

import sys
from pathlib import Path

import galewood
import numpy as np
from galewood.packaged import species_folder
from galewood.pipeline.stages import builtin_meshes
from galewood.solid.strain import Rupture
from galewood.table import Foliage

BEGIN, END = "<!-- strain: written by docs/examples/critical_wind.py -->", "<!-- end of strain -->"
HEAD = (
    "tree",
    "strain at 1.3 m: 5, 15 m/s",
    "largest of the stem, 15 m/s",
    "breaks at",
    "height, diameter there",
    "median, 10 to 90 %",
    "first bough breaks at",
    "1.3 m breaks at",
    "a U²",
)
FOLIAGE: dict[Foliage, str] = {"leaf": "in leaf", "bare": "bare"}
OPTIONS = galewood.CriticalOptions()


def row(name: str, tree: galewood.Tree, foliage: Foliage) -> str:
    """The line of a tree, in leaf or bare."""
    found = galewood.critical_wind(tree, foliage=foliage, options=OPTIONS)
    (_, _, breast_5), (_, largest_15, breast_15) = (
        found.curve[found.curve[:, 0] == speed][0] for speed in (5.0, 15.0)
    )
    low, median, high = found.quantiles_m_s or (None, None, None)
    at = found.stem.section
    cells = (
        f"{name}, {FOLIAGE[foliage]}",
        f"{breast_5:.5f}, {breast_15:.5f}",
        f"{largest_15:.5f}",
        speed_text(found.gust_m_s),
        "–" if at is None else f"{at.height_m:.1f} m, {at.diameter_cm:.0f} cm",
        f"{speed_text(median)}, {speed_text(low)} to {speed_text(high)}",
        bough_text(found.boughs),
        speed_text(found.breast_height_m_s),
        speed_text(found.extrapolated_m_s),
    )
    return f"| {' | '.join(cells)} |"


def speed_text(speed_m_s: float | None) -> str:
    if speed_m_s is None:
        return "–"
    return f"{speed_m_s:.0f}" if np.isfinite(speed_m_s) else "over 100"


def bough_text(boughs: Rupture | None) -> str:
    if boughs is None:
        return "no bough of 4 cm"
    low, _, high = boughs.quantiles_m_s or (None, None, None)
    return f"{speed_text(boughs.gust_m_s)}, {speed_text(low)} to {speed_text(high)}"


page = Path(sys.argv[1])
lines = [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
for mesh in builtin_meshes(species_folder()):
    tree = galewood.read(mesh.path, species=str(mesh.options["species"]), accept=True)
    for foliage in FOLIAGE:
        lines.append(row(mesh.name, tree, foliage))
        print(lines[-1], flush=True)
text = page.read_text(encoding="utf-8")
before, rest = text.split(BEGIN)
table = "\n".join(lines)
page.write_text(f"{before}{BEGIN}\n{table}\n{END}{rest.split(END)[1]}", encoding="utf-8")
for path in map(Path, sys.argv[2:]):
    tree = galewood.read(path, accept=True)
    for foliage in FOLIAGE:
        print(row(path.stem, tree, foliage), flush=True)
