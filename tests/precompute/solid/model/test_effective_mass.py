"""Effective modal masses: all modes together move the whole tree, and the first of a pole 0.613 of it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from galewood.check.verify.bars import polygon_bar
from galewood.solid.fem import FemModel, FemSettings, Modes
from galewood.solid.model import LumpedMasses, build_model
from galewood.solid.model.effective_mass import effective_masses, sway_report
from galewood.wood import wood_of_species
from scipy.linalg import eigh
from scipy.optimize import brentq

WOOD = wood_of_species("ash")


def built(tree: Any) -> FemModel:
    return build_model(tree, tree, WOOD, tree, FemSettings(element="linear", gravity=False))


def all_modes(model: FemModel) -> Modes:
    """Every mode of a small model, by a dense solver."""
    system = model.system()
    zero = np.zeros_like(system.rest)
    system.assemble(zero, zero, 1.0, np.zeros(len(zero)), zero.copy())
    stiffness = system.solver.to_scipy(system.values).toarray()
    mass = np.repeat(model.mass_kg[system.order][: system.free], 3)
    squares, vectors = eigh(stiffness, np.diag(mass))
    shapes = np.zeros((len(squares), *model.nodes_m.shape))
    shapes[:, system.order[: system.free]] = vectors.T.reshape(len(squares), -1, 3)
    return Modes(np.sqrt(squares) / (2 * np.pi), shapes)


def test_all_modes_together_have_the_mass_that_is_free() -> None:
    seed = 3
    bar = polygon_bar(sides=4, radius_m=0.05, length_m=1.0, layers=6)
    bar = replace(bar, mass_kg=np.random.default_rng(seed).uniform(0, 1, len(bar.mass_kg)))
    model = built(bar)
    free = np.delete(model.mass_kg, model.fixed).sum()
    total = effective_masses(all_modes(model), model.mass_kg).sum(axis=0)
    np.testing.assert_allclose(total, free, rtol=1e-9, err_msg=f"seed {seed}")


def test_the_first_modes_of_a_pole_have_the_shares_of_beam_theory() -> None:
    model = built(polygon_bar(sides=6, radius_m=0.05, length_m=6.0, layers=60))
    sway = model.report["sway"]
    effective = np.array(sway["effective_mass_kg"])
    pairs = effective[:4, [0, 2]].sum(axis=1).reshape(2, 2).mean(axis=1) / model.mass_kg.sum()
    for share, guess in zip(pairs, (1.875, 4.694), strict=True):
        assert share == pytest.approx(cantilever_share(guess), rel=0.02)
    assert sway["main_mode"] in (0, 1)
    assert sway["main_frequency_hz"] == pytest.approx(model.report["frequencies_hz"][0], rel=1e-3)


def cantilever_share(guess: float) -> float:
    """Effective mass of a mode of a uniform cantilever over its mass: 0.613, 0.188, …"""
    root: Any = brentq(lambda x: np.cos(x) * np.cosh(x) + 1, guess - 0.1, guess + 0.1)
    k = float(root)
    x = np.linspace(0, 1, 20_001)
    shape = np.cosh(k * x) - np.cos(k * x)
    shape -= (np.cosh(k) + np.cos(k)) / (np.sinh(k) + np.sin(k)) * (np.sinh(k * x) - np.sin(k * x))
    return float(np.trapezoid(shape, x) ** 2 / np.trapezoid(shape**2, x))


def test_shares_of_beam_theory_are_the_known_ones() -> None:
    assert [cantilever_share(k) for k in (1.875, 4.694)] == pytest.approx([0.613, 0.188], abs=5e-4)


def test_a_heavy_high_frequency_mode_is_the_main_one() -> None:
    """Of a light twig that sways slowly and a heavy trunk that sways fast, the trunk is the main mode."""
    model: Any = SimpleNamespace(mass_kg=np.array([1.0, 100.0, 50.0]), fixed=np.array([2]))
    shapes = np.zeros((2, 3, 3))
    shapes[0, 0, 0] = 1.0
    shapes[1, 1, 2] = 0.1
    sway = sway_report(model, Modes(np.array([0.2, 0.7]), shapes))
    assert (sway["main_mode"], sway["main_frequency_hz"]) == (1, 0.7)
    assert sway["main_share"] == pytest.approx(100 / 101)
    assert sway["free_mass_kg"] == pytest.approx(101)


def test_the_bare_tree_sways_as_one_built_without_leaves() -> None:
    bar = polygon_bar(sides=6, radius_m=0.04, length_m=5.0, layers=40)
    leaves = np.zeros(len(bar.mass_kg))
    leaves[bar.tip] = 4.0 / len(bar.tip)
    laden = LumpedMasses(leaves, bar.drag_area_m2, bar.fixed, {}, leaf_mass_kg=leaves)
    report = build_model(bar, bar, WOOD, laden, FemSettings(element="linear")).report
    alone = build_model(bar, bar, WOOD, bar, FemSettings(element="linear")).report
    assert report["frequencies_hz"][0] < 0.9 * alone["frequencies_hz"][0]
    np.testing.assert_allclose(report["bare"]["frequencies_hz"], alone["frequencies_hz"], rtol=1e-6)
    assert report["bare"]["mass_kg"] == pytest.approx(alone["mass_kg"])
    assert "bare" not in alone
