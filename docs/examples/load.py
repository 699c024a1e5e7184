"""A pole whose top gets heavier, by finite elements and exactly: the plot of docs/physics.md, "Rest pose".

Run from the repository: ``python docs/examples/load.py docs/physics/load.svg``.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from galewood.check.verify.bars import polygon_bar
from galewood.check.verify.beams import laden_pole
from galewood.solid.fem import FemSettings
from galewood.solid.model import build_model
from galewood.wood import wood_of_species
from matplotlib.figure import Figure

LENGTH_M, RADIUS_M, LAYERS = 5.0, 0.03, 40
TOPS_TENTHS = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0, 17.0, 20.0])
"""Masses on the top, in tenths of the one under which the pole buckles without its own weight."""
SAFE_SHARE = 1 / 3

wood = wood_of_species("poplar")
bar = polygon_bar(sides=6, radius_m=RADIUS_M, length_m=LENGTH_M, layers=LAYERS)
bending = wood.young_longitudinal_pa * bar.second_moment_m4
per_metre = wood.density_kg_m3 * bar.area_m2
euler_kg = np.pi**2 / 4 * bending / LENGTH_M**2 / 9.81

loads, found, light = [], [], []
for top_kg in TOPS_TENTHS / 10 * euler_kg:
    mass = np.zeros(len(bar.vertices_m))
    mass[bar.tip] = top_kg / len(bar.tip)
    laden = replace(bar, mass_kg=mass)
    report = build_model(laden, laden, wood, laden, FemSettings(element="quadratic")).report
    exact = laden_pole(LENGTH_M, bending, per_metre, top_kg)
    pose = report["rest_pose"]
    loads.append(pose["load_factor"])
    found.append(report["frequencies_hz"][0])
    light.append(exact.weightless_hz)
    print(
        f"load factor {loads[-1]:.3f}: {found[-1]:.4f} Hz, exactly {exact.frequency_hz:.4f} Hz, weightless "
        f"{light[-1]:.4f} Hz; thin mass x {pose.get('thin_mass_factor', 1):.2f}, stiffness x "
        f"{pose.get('stiffness_factor', 1):.2f}",
        flush=True,
    )

curve = [laden_pole(LENGTH_M, bending, per_metre, kg) for kg in np.linspace(0, 1.05 * euler_kg, 120)]
standing = [one for one in curve if one.load_factor < 1]
figure = Figure(figsize=(8.8, 3.4), layout="constrained")
ratio, hertz = figure.subplots(1, 2)
exact_load = [one.load_factor for one in standing] + [1.0]
ratio.plot(exact_load, [one.frequency_hz / one.weightless_hz for one in standing] + [0.0], color="0.6")
ratio.plot(loads, np.array(found) / light, marker=".", linewidth=1)
hertz.plot(exact_load, [one.frequency_hz for one in standing] + [0.0], color="0.6", label="exact")
hertz.plot(loads, found, marker=".", linewidth=1, label="finite elements with the rule")
ratio.set_ylabel("first frequency over weightless", fontsize=8)
hertz.set_ylabel("first frequency, Hz", fontsize=8)
hertz.legend(fontsize=7, frameon=False)
for panel in (ratio, hertz):
    panel.axvline(SAFE_SHARE, color="0.85", linewidth=1)
    panel.set_xlabel("load factor: weight over buckling load", fontsize=8)
    panel.set_ylim(bottom=0)
    panel.tick_params(labelsize=7)
    panel.spines[["top", "right"]].set_visible(False)
figure.savefig(Path(sys.argv[1]))
