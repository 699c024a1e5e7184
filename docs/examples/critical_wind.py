"""Strain and critical wind of the built-in trees: the table of docs/physics.md and the plot above it.

Run from the repository: ``python docs/examples/critical_wind.py docs/physics.md docs/physics/strain.svg``.
Other tree files may follow; their rows are printed only.
"""

import sys
from pathlib import Path

import galewood
import numpy as np
from galewood.check.paper import PAPER_SPECIES
from galewood.packaged import species_folder
from galewood.pipeline.stages import builtin_meshes
from galewood.solid.strain import CriticalWind, Rupture
from galewood.table import Foliage
from matplotlib.figure import Figure

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
MEASURED_STRAINS = (0.00063, 0.00068)
"""Of four sycamores of 19 to 20 m, bare, at 1.3 m in 15 m/s."""
FASTEST_M_S = 40.0


def row(name: str, found: CriticalWind, foliage: Foliage) -> str:
    """The line of a tree, in leaf or bare."""
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


page, picture = Path(sys.argv[1]), Path(sys.argv[2])
figure = Figure(figsize=(8.8, 3.6), layout="constrained")
panels = dict(zip(FOLIAGE, figure.subplots(1, 2, sharey=True), strict=True))
lines = [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
for mesh in builtin_meshes(species_folder()):
    if mesh.options["species"] not in PAPER_SPECIES:
        continue
    tree = galewood.read(mesh.path, species=str(mesh.options["species"]), accept=True)
    for foliage in FOLIAGE:
        found = galewood.critical_wind(tree, foliage=foliage, options=OPTIONS)
        lines.append(row(mesh.name, found, foliage))
        print(lines[-1], flush=True)
        speed, _, breast = found.curve[found.curve[:, 0] <= FASTEST_M_S].T
        panels[foliage].plot(speed, 1000 * breast, label=mesh.name, linewidth=1.2)
for foliage, panel in panels.items():
    panel.set_title(FOLIAGE[foliage], fontsize=9)
    panel.set_xlabel("steady wind at the top, m/s", fontsize=8)
    panel.tick_params(labelsize=7)
    panel.spines[["top", "right"]].set_visible(False)
panels["bare"].plot(
    (15, 15), 1000 * np.array(MEASURED_STRAINS), color="0.3", linewidth=4, label="sycamores, measured"
)
panels["leaf"].set_ylabel("strain at 1.3 m, mm/m", fontsize=8)
panels["leaf"].set_ylim(0, 5)
panels["bare"].legend(fontsize=7, frameon=False, loc="upper left")
figure.savefig(picture)
text = page.read_text(encoding="utf-8")
before, rest = text.split(BEGIN)
table = "\n".join(lines)
page.write_text(f"{before}{BEGIN}\n{table}\n{END}{rest.split(END)[1]}", encoding="utf-8")
for path in map(Path, sys.argv[3:]):
    tree = galewood.read(path, accept=True)
    for foliage in FOLIAGE:
        found = galewood.critical_wind(tree, foliage=foliage, options=OPTIONS)
        print(row(path.stem, found, foliage), flush=True)
