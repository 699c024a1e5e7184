"""Checks of whole trees: beam frame, generator's skeleton, eigenvalues, reference element, measured trees."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial import KDTree

from galewood.check.field import broadleaf_hz, conifer_hz
from galewood.check.verify.checks import Check, absolute, relative
from galewood.check.verify.motion_checks import ring_down
from galewood.check.verify.skeleton_match import branches_found, fibre_errors
from galewood.check.verify.specimens import TARGETS, Form, Mesher, Specimen, forms_of, read_tree, specimen
from galewood.solid.beams import frame_frequencies
from galewood.solid.model import gusty_pressure, trajectory_difference
from galewood.util import Floats

FRAME_COUNT = 180
RING_M = 0.005
"""Amplitude of the ring-down: small, because the weight on bent limbs makes larger ones nonlinear."""
MODE_COUNT = 10
CONIFERS = ("spruce", "pine", "larch")
"""Species of wood."""
MOST_WRONG_BRANCHES = 0.05
"""Share of branches missed or spurious. Where limbs touch, a mesh may join them, and a tip more is found.

Two runs of the mesher never give the same tetrahedra; one branch of twenty is allowed.
"""
ON_MESHES = "apricot"
"""The tree that is checked on several meshes."""
RESIDUALS: dict[Form, float] = {"forest": 0.227, "open": 0.365}
"""Standard deviation of ln f about the regressions for broadleaves (`galewood.check.field.broadleaf_hz`), of
111 forest-grown trees of 7 to 40 m and 88 open-grown trees of 9 to 30 m and 30 to 101 cm."""
CONIFER_LIMIT = 0.25
"""Of the frequency over that of `galewood.check.field.conifer_hz`."""


def checks(folder: Path, mesher: Mesher) -> Iterator[Check]:
    """All checks of all trees; one of them also on three meshes."""
    for name in forms_of(folder):
        tree = read_tree(folder, name)
        one = specimen(folder, name, tree, mesher(name, tree, TARGETS[1]))
        yield from of_specimen(one)
        if name == ON_MESHES:
            others = [specimen(folder, name, tree, mesher(name, tree, target)) for target in TARGETS[::2]]
            yield from on_meshes([others[0], one, others[1]])


def of_specimen(one: Specimen, frames: int = FRAME_COUNT) -> Iterator[Check]:
    """All checks of one tree."""
    yield wood_mass(one)
    yield from against_beams(one)
    yield from against_reference(one, frames)
    yield from ringing(one)
    yield from against_generator(one)
    yield against_measured_trees(one)


def wood_mass(one: Specimen) -> Check:
    """Mass of the wood in the model against the beam frame without hidden links."""
    exact = one.frame.volume_m3() * one.wood.density_kg_m3
    return relative(f"{one.name}: mass of the wood", exact, one.fast.report["wood_mass_kg"], "kg", 0.015)


def against_beams(one: Specimen) -> Iterator[Check]:
    """Ten lowest frequencies without gravity, bare and in leaf: reference element against the beam frame."""
    hung = np.bincount(
        KDTree(one.frame.points_m).query(one.mesh.vertices_m)[1], one.lumped.mass_kg, len(one.frame.points_m)
    ).astype(np.float64)
    for leaves, label in ((False, "bare"), (True, "in leaf")):
        exact = frame_frequencies(one.frame, one.wood, 0.0, MODE_COUNT, hung if leaves else None)
        found = np.array(one.model("quadratic", gravity=False, leaves=leaves).report["frequencies_hz"])
        name = f"{one.name}, {label}, no gravity"
        yield relative(f"{name}: first frequency against a frame of beams", exact[0], found[0], "Hz", 0.08)
        yield absolute(f"{name}: worst of ten frequencies against the frame", _worst(found, exact), 0.13)


def against_reference(one: Specimen, frames: int) -> Iterator[Check]:
    """Fast against reference element: ten frequencies, and a run in gusts."""
    fast, slow = (np.array(m.report["frequencies_hz"]) for m in (one.fast, one.reference))
    yield absolute(f"{one.name}: worst of ten frequencies, fast against reference", _worst(fast, slow), 0.08)
    apart = trajectory_difference(one.fast, one.reference, gusty_pressure(one.fast, frames))
    name = f"{one.name}: {frames} frames, fast against reference, of the largest displacement"
    yield absolute(name, apart, 0.12)


def ringing(one: Specimen) -> Iterator[Check]:
    """Ring-down without drag in the first mode against the eigenvalue and the damping ratio of the wood."""
    still = replace(one.fast, drag_area_m2=np.zeros_like(one.fast.drag_area_m2), exposed_area_m2=None)
    frequency = float(one.fast.report["frequencies_hz"][0])
    found_hz, ratio = ring_down(still, 0, RING_M)
    yield relative(f"{one.name}: ring-down frequency against the eigenvalue", frequency, found_hz, "Hz", 0.01)
    given = one.wood.damping_ratio
    yield relative(f"{one.name}: ring-down damping against the ratio given", given, ratio, "–", 0.015)


def against_generator(one: Specimen) -> Iterator[Check]:
    """Extracted skeleton against that of the generator."""
    points, radius = one.reference_of("points_m"), one.reference_of("radius_m")
    branch = one.reference_of("branch").astype(np.int32)
    error = np.degrees(fibre_errors(one.mesh, one.skeleton, points, radius, branch))
    note = f"median {np.median(error):.1f}°, 90 % below {np.percentile(error, 90):.1f}°"
    name = f"{one.name}: fibre direction against the generator, median over 5°"
    yield absolute(name, float(np.median(error)) / 5, 1.0, note)
    match = branches_found(one.skeleton, points, branch)
    extra = len(match.extra_tips_m)
    note = f"{match.found} of {match.true} found, {extra} spurious"
    note += f"; limbs touch {one.skeleton.report['meetings']} times"
    wrong = (match.true - match.found + extra) / match.true
    yield absolute(f"{one.name}: branches missed or spurious", wrong, MOST_WRONG_BRANCHES, note)


def on_meshes(specimens: list[Specimen]) -> Iterator[Check]:
    """Spread of the first frequency over meshes of different density."""
    counts = ", ".join(str(len(one.mesh.tets)) for one in specimens)
    for label, limit in (("fast", 0.1), ("reference", 0.08)):
        models = [one.fast if label == "fast" else one.reference for one in specimens]
        hertz = np.array([m.report["frequencies_hz"][0] for m in models])
        note = f"{' / '.join(f'{h:.3f}' for h in hertz)} Hz on {counts} tetrahedra"
        spread = float(np.ptp(hertz) / hertz.mean())
        yield absolute(f"{specimens[0].name} on three meshes: first frequency, {label}", spread, limit, note)


def against_measured_trees(one: Specimen) -> Check:
    """First frequency in leaf under gravity, beside measured trees of its size.

    Broadleaves are within a standard deviation of those of their form; conifers within a quarter of theirs.
    """
    height_m, girth_cm = one.tree.height_m, 200 * breast_radius_m(one)
    size = np.array(height_m), np.array(girth_cm)
    found = float(one.fast.report["frequencies_hz"][0])
    note = f"DBH {girth_cm:.0f} cm, {height_m:.1f} m"
    if one.wood.name in CONIFERS:
        name = f"{one.name}: first frequency beside measured conifers of its size"
        return relative(name, float(conifer_hz(*size)), found, "Hz", CONIFER_LIMIT, note)
    measured = float(broadleaf_hz(one.form, *size))
    return Check(
        name=f"{one.name}: first frequency beside measured {one.form}-grown trees of its size",
        exact=measured,
        computed=found,
        unit="Hz",
        deviation=float(np.log(found / measured)) / RESIDUALS[one.form],
        limit=1.0,
        note=f"in standard deviations; {note}",
    )


def breast_radius_m(one: Specimen) -> float:
    """Radius of the trunk at 1.3 m, m."""
    trunk = one.reference_of("branch") == 0
    return float(np.interp(1.3, one.reference_of("points_m")[trunk, 1], one.reference_of("radius_m")[trunk]))


def _worst(found: Floats, exact: Floats) -> float:
    return float(np.abs(found / exact - 1).max())
