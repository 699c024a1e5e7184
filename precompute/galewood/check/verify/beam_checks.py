"""Checks of bars and poles against beam theory: tip deflection, convergence, sag, frequencies."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.optimize import root_scalar

from galewood.check.verify.bars import Bar, box_bar, polygon_bar
from galewood.check.verify.beams import (
    Section,
    elastica_tip,
    pole_frequencies,
    sag,
    shear_tip,
    softening,
    sprung_pole_frequency,
    tip_deflection,
)
from galewood.check.verify.checks import Check, relative
from galewood.solid.fem import Element, FemModel, FemSettings, solve_static
from galewood.solid.model import GRAVITY_M_S2, build_model
from galewood.wood import wood_of_species

POLE_WOOD = wood_of_species("poplar")
LENGTH_M, RADIUS_M = 5.0, 0.06
SECTIONS = (
    ("triangle", 3, 1, 0.045),
    ("square", 4, 1, 0.03),
    ("hexagon", 6, 1, 0.012),
    ("round (12 sides, 2 rings)", 12, 2, 0.012),
)
"""Label, sides, rings, and the limit of the fast element's tip deflection."""
REFERENCE_TIP_LIMIT = 0.0025
FREQUENCY_LIMITS: dict[tuple[Element, str], float] = {
    ("quadratic", "first"): 0.0025,
    ("quadratic", "second"): 0.02,
    ("fitted", "first"): 0.0035,
    ("fitted", "second"): 0.03,
}
"""Euler-Bernoulli theory has no shear, which lowers the second frequency of the solid pole by about 1 %."""
SPRUNG_LIMITS = {0.5: 0.001, 5.0: 0.003}
"""Rotational stiffness of the ground over E I / L, and the limit of the first frequency's error."""
ELASTICA_LIMITS = {0.2: 0.00015, 0.4: 0.0008}
"""Sway of the elastica over its length, and the limit of the tip's error over the sway."""
NAMES: dict[Element, str] = {"quadratic": "reference", "fitted": "fast"}


def checks() -> Iterator[Check]:
    """All checks of this module."""
    for label, sides, rings, fast_limit in SECTIONS:
        bar = polygon_bar(sides=sides, rings=rings, radius_m=RADIUS_M, length_m=LENGTH_M, layers=40)
        exact = tip_deflection(1.0, LENGTH_M, POLE_WOOD.young_longitudinal_pa, bar.second_moment_m4)
        limits: dict[Element, float] = {"quadratic": REFERENCE_TIP_LIMIT, "fitted": fast_limit}
        for element, limit in limits.items():
            tip = tip_under_force(weightless(bar, element), bar)
            yield relative(f"cantilever tip, {label}, {NAMES[element]}", exact, tip, "m", limit)
    yield from _convergence()
    yield _sagging()
    yield from _pole_frequencies()
    yield _softened()
    for ratio, limit in SPRUNG_LIMITS.items():
        yield sprung(ratio, limit, "quadratic")
    for sway, limit in ELASTICA_LIMITS.items():
        yield bent_far(sway, limit)


def weightless(bar: Bar, element: Element) -> FemModel:
    """Model of the bar in poplar wood without gravity."""
    settings = FemSettings(element=element, gravity=False)
    return build_model(bar, bar, POLE_WOOD, bar, settings)


def tip_under_force(model: FemModel, bar: Bar, axis: int = 0) -> float:
    """Mean displacement of the tip along an axis, m, under 1 N distributed over the tip."""
    load = np.zeros_like(model.nodes_m)
    load[bar.tip, axis] = 1.0 / len(bar.tip)
    u, _, _ = solve_static(model.system(), load)
    return float(u[bar.tip, axis].mean())


def sprung(ratio: float, limit: float, element: Element) -> Check:
    """First frequency of a uniform pole on a rotational spring of stiffness ratio · E I / L."""
    bar = polygon_bar(sides=12, rings=2, radius_m=RADIUS_M, length_m=LENGTH_M, layers=40)
    bending = POLE_WOOD.young_longitudinal_pa * bar.second_moment_m4
    settings = FemSettings(element=element, gravity=False, root_stiffness_nm_rad=ratio * bending / LENGTH_M)
    found = build_model(bar, bar, POLE_WOOD, bar, settings).report["frequencies_hz"][0]
    clamped, _ = pole_frequencies(
        LENGTH_M, POLE_WOOD.young_longitudinal_pa, POLE_WOOD.density_kg_m3, bar.area_m2, bar.second_moment_m4
    )
    exact = sprung_pole_frequency(float(clamped), ratio)
    note = f"{exact / clamped:.0%} of the clamped pole's"
    return relative(f"pole on a root plate of {ratio:g} E I / L, reference", exact, found, "Hz", limit, note)


def bent_far(sway: float, limit: float) -> Check:
    """Tip of a pole that a dead force sways by a share of its length, against the elastica.

    The pole bends in the plane in which its mesh is symmetric, to both sides.
    """
    bar = polygon_bar(sides=6, radius_m=RADIUS_M, length_m=LENGTH_M, layers=160)
    young, shear = POLE_WOOD.young_longitudinal_pa, POLE_WOOD.shear_longitudinal_pa
    section = Section(young * bar.second_moment_m4, young * bar.area_m2, 0.9 * shear * bar.area_m2)
    linear = 3 * sway * section.bending_n_m2 / LENGTH_M**2

    def excess(force: float) -> float:
        return elastica_tip(force, LENGTH_M, section)[0] - sway * LENGTH_M

    force = root_scalar(excess, bracket=(0.5 * linear, 2 * linear), rtol=1e-9).root
    model = weightless(bar, "quadratic")
    system, load = model.system(), np.zeros_like(model.nodes_m)
    load[bar.tip, 2] = force / len(bar.tip)
    both: list[float] = []
    solutions = 0
    for side in (1, -1):
        u, count, converged = solve_static(system, side * load)
        both.append(side * float(u[bar.tip, 2].mean()) if converged else np.nan)
        solutions = max(solutions, count)
    name = f"elastica: pole swayed by {sway:.0%} of its length, reference"
    return relative(name, sway * LENGTH_M, float(np.mean(both)), "m", limit, f"{solutions} linear solutions")


def _convergence() -> Iterator[Check]:
    """Order of convergence of the tip of a cantilever of plain linear elements; theory: second order."""
    size = (0.2, 1.0, 0.2)
    errors: list[float] = []
    for k in (2, 4, 8):
        bar = box_bar(size_m=size, cells=(k, 4 * k, k))
        young, shear = POLE_WOOD.young_longitudinal_pa, POLE_WOOD.shear_longitudinal_pa
        exact = tip_deflection(1.0, size[1], young, bar.second_moment_m4)
        exact += shear_tip(1.0, size[1], shear, bar.area_m2)
        errors.append(abs(tip_under_force(weightless(bar, "linear"), bar) / exact - 1))
    rate = float(np.log2(errors[-2] / errors[-1]))
    note = "errors " + ", ".join(f"{error:.1%}" for error in errors)
    yield relative("linear tets: order of convergence of a cantilever's tip", 2.0, rate, "–", 0.25, note)


def _sagging() -> Check:
    """Sag of a horizontal bar under its own weight."""
    standing = polygon_bar(sides=6, radius_m=RADIUS_M, length_m=2.0, layers=24)
    lying = replace(
        standing,
        vertices_m=np.ascontiguousarray(standing.vertices_m[:, [1, 2, 0]]),
        tet_fibre=np.ascontiguousarray(standing.tet_fibre[:, [1, 2, 0]]),
    )
    # Solved directly: in a model the given shape has sagged already.
    model = weightless(lying, "quadratic")
    load = np.zeros_like(model.nodes_m)
    load[:, 1] = -GRAVITY_M_S2 * model.mass_kg
    u, _, _ = solve_static(model.system(), load)
    weight = GRAVITY_M_S2 * POLE_WOOD.density_kg_m3 * standing.area_m2
    exact = sag(weight, 2.0, POLE_WOOD.young_longitudinal_pa, standing.second_moment_m4)
    return relative("sag of a lying bar, reference", exact, float(-u[standing.tip, 1].mean()), "m", 0.025)


def _pole_frequencies() -> Iterator[Check]:
    for label, tip_ratio in (("uniform", 1.0), ("tapered to half", 0.5)):
        bar = polygon_bar(
            sides=12, radius_m=RADIUS_M, length_m=LENGTH_M, layers=40, tip_radius_m=RADIUS_M * tip_ratio
        )
        exact = pole_frequencies(
            LENGTH_M,
            POLE_WOOD.young_longitudinal_pa,
            POLE_WOOD.density_kg_m3,
            bar.area_m2,
            bar.second_moment_m4,
            tip_ratio,
        )
        for element in NAMES:
            found = weightless(bar, element).report["frequencies_hz"]
            # Bending modes come in pairs, one per axis of the section.
            for mode, index in (("first", 0), ("second", 2)):
                name = f"{label} pole, {mode} frequency, {NAMES[element]}"
                yield relative(
                    name, float(exact[index // 2]), found[index], "Hz", FREQUENCY_LIMITS[element, mode]
                )


def _softened() -> Check:
    """Frequency of a pole under its own weight relative to the weightless pole."""
    length, radius = 12.0, 0.06
    bar = polygon_bar(sides=6, radius_m=radius, length_m=length, layers=60)
    light = weightless(bar, "quadratic").report["frequencies_hz"][0]
    settings = FemSettings(element="quadratic")
    heavy = build_model(bar, bar, POLE_WOOD, bar, settings).report["frequencies_hz"][0]
    weight = GRAVITY_M_S2 * POLE_WOOD.density_kg_m3 * bar.area_m2 * length
    exact = softening(weight, length, POLE_WOOD.young_longitudinal_pa, bar.second_moment_m4)
    share = 1 - exact**2
    note = f"at {share:.0%} of the buckling load"
    return relative(
        "standing pole: frequency over weightless frequency", exact, heavy / light, "–", 0.002, note
    )
