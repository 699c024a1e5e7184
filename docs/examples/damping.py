"""Pull and release of the built-in trees with and without leaves: the table and the plot of docs/physics.md.

Run from the repository: ``python docs/examples/damping.py assets/species docs/physics/damping.svg``.
"""

import sys
from pathlib import Path

import numpy as np
from galewood.check.field import pull_and_release, tree_of_file
from galewood.options import BuildRequest
from matplotlib.figure import Figure

NAMES = ("poplar", "maple", "apricot", "poplar-forest", "maple-forest", "apricot-forest")
SWAY, CYCLES = 0.09, 10.0
"""Sway of the release over the height, and periods of the decay."""
AT = (0.02, 0.03, 0.04, 0.05)
"""Sways of the table."""
MEASURED = {"leaf": ((0.05, 0.06), (0.11, 0.12)), "bare": ((0.020, 0.027), (0.035, 0.05))}
"""Ranges of two real trees each, of unknown sway (docs/physics.md, "Damping")."""

folder, picture = Path(sys.argv[1]), Path(sys.argv[2])
figure = Figure(figsize=(8.8, 3.6), layout="constrained")
panels = dict(zip(("leaf", "bare"), figure.subplots(1, 2, sharey=True), strict=True))
for season, panel in panels.items():
    for low, high in MEASURED[season]:
        panel.axhspan(low, high, color="0.85", linewidth=0)
    for name in NAMES:
        options = BuildRequest(species=name.split("-")[0], foliage=season)
        tree = tree_of_file(folder / f"{name}.glb", options)
        released = pull_and_release(tree.fem, sway=SWAY, cycles=CYCLES)
        sway, ratio = released.decay.by_cycle
        rising = np.argsort(sway)
        at = np.interp(AT, sway[rising], ratio[rising])
        figures = " ".join(f"{value:.3f}" for value in at)
        print(f"{name} {season} {released.mode.frequency_hz:.2f} Hz, at 2, 3, 4, 5 %: {figures}", flush=True)
        panel.plot(100 * sway, ratio, marker=".", label=name, linewidth=1)
    panel.set_title({"leaf": "in leaf", "bare": "without leaves"}[season], fontsize=9)
    panel.set_xlabel("sway, % of the height", fontsize=8)
    panel.tick_params(labelsize=7)
    panel.spines[["top", "right"]].set_visible(False)
panels["leaf"].set_ylabel("damping ratio of a cycle", fontsize=8)
panels["leaf"].set_ylim(0, 0.16)
panels["leaf"].legend(fontsize=7, frameon=False, loc="upper left")
figure.savefig(picture)
