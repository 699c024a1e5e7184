"""Strain of the built-in trees in gusts: a table of docs/physics.md.

Run from the repository: ``python docs/examples/gust_strain.py docs/physics.md``.
"""

import sys
from dataclasses import replace
from pathlib import Path

import galewood
import numpy as np
from galewood.check.paper import PAPER_SPECIES
from galewood.packaged import species_folder
from galewood.pipeline.stages import builtin_meshes
from galewood.table import Foliage

BEGIN, END = "<!-- gusts: written by docs/examples/gust_strain.py -->", "<!-- end of gusts -->"
HEAD = (
    "tree",
    "first frequency",
    "strain at 1.3 m: mean, RMS, largest",
    "over steady mean wind: 1.3 m, stem, boughs",
    "over steady strongest gust: 1.3 m, stem, boughs",
)
FOLIAGE: dict[Foliage, str] = {"leaf": "in leaf", "bare": "bare"}
SPEED_M_S = 15.0
GUSTS = replace(galewood.PRESETS["autumn-gusts"], direction_deg=0.0)


def row(name: str, tree: galewood.Tree, foliage: Foliage) -> str:
    """The line of a tree, in leaf or bare."""
    found = galewood.gust_strain(tree, GUSTS, wind_m_s=SPEED_M_S, foliage=foliage)
    breast = found.breast_height_strain
    stem, boughs = found.peak("stem"), found.peak("boughs")
    if breast is None or found.breast_height_factor is None or stem is None:
        raise ValueError(f"{name} is lower than 1.3 m")
    in_gust = found.in_gust and found.in_gust.breast_height_strain
    over_gust = float(np.abs(breast).max()) / in_gust if in_gust else None
    cells = (
        f"{name}, {FOLIAGE[foliage]}",
        f"{found.frequency_hz:.2f} Hz",
        f"{breast.mean():.5f}, {breast.std():.5f}, {np.abs(breast).max():.5f}",
        f"{found.breast_height_factor:.1f}, {stem.over_mean:.1f}, "
        + ("–" if boughs is None else f"{boughs.over_mean:.1f}"),
        ", ".join(ratio_text(one) for one in (over_gust, stem.over_gust, boughs and boughs.over_gust)),
    )
    print(f"gust {found.gust_m_s:.1f} m/s, mean {found.mean_m_s:.1f} m/s")
    return f"| {' | '.join(cells)} |"


def ratio_text(ratio: float | None) -> str:
    return "–" if ratio is None else f"{ratio:.2f}"


page = Path(sys.argv[1])
lines = [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
for mesh in builtin_meshes(species_folder()):
    if mesh.options["species"] not in PAPER_SPECIES:
        continue
    read = galewood.read(mesh.path, species=str(mesh.options["species"]), accept=True)
    for season in FOLIAGE:
        lines.append(row(mesh.name, read, season))
        print(lines[-1], flush=True)
text = page.read_text(encoding="utf-8")
before, rest = text.split(BEGIN)
table = "\n".join(lines)
page.write_text(f"{before}{BEGIN}\n{table}\n{END}{rest.split(END)[1]}", encoding="utf-8")
