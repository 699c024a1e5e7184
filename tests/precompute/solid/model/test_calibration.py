"""The fitted linear mesh compared with the quadratic mesh it was fitted to."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from galewood.check.verify.bars import Bar, polygon_bar
from galewood.check.verify.beam_checks import POLE_WOOD, tip_under_force
from galewood.check.verify.beams import pole_frequencies, tip_deflection
from galewood.solid.fem.model import FemModel
from galewood.solid.fem.settings import Element, FemSettings
from galewood.solid.model.calibration import random_couples
from galewood.solid.model.construction import build_model
from galewood.solid.model.reference import compare_with_reference

SIDES = (3, 4, 6)


@cache
def bar(sides: int) -> Bar:
    return polygon_bar(sides=sides, radius_m=0.06, length_m=4.0, layers=24)


@cache
def model(sides: int, element: Element) -> FemModel:
    one = bar(sides)
    return build_model(one, one, POLE_WOOD, one, FemSettings(element=element, gravity=False))


@pytest.mark.parametrize(("element", "limit"), [("quadratic", 0.01), ("fitted", 0.05)])
@pytest.mark.parametrize("sides", SIDES)
def test_cantilever_agrees_with_euler_bernoulli_theory(sides: int, element: Element, limit: float) -> None:
    exact = tip_deflection(1.0, 4.0, POLE_WOOD.young_longitudinal_pa, bar(sides).second_moment_m4)
    assert tip_under_force(model(sides, element), bar(sides)) == pytest.approx(exact, rel=limit)


def test_plain_linear_tets_lock() -> None:
    exact = tip_deflection(1.0, 4.0, POLE_WOOD.young_longitudinal_pa, bar(3).second_moment_m4)
    assert tip_under_force(model(3, "linear"), bar(3)) < 0.4 * exact


def test_fitted_frequencies_agree_with_the_reference() -> None:
    fast, reference = (np.array(model(6, e).report["frequencies_hz"]) for e in ("fitted", "quadratic"))
    # The pole's four bending modes only: torsion agrees less well in its layered mesh than in trees.
    np.testing.assert_allclose(fast[:4], reference[:4], rtol=0.05)
    np.testing.assert_allclose(fast, reference, rtol=0.15)


def test_fit_has_a_report_and_is_reproducible() -> None:
    report = model(4, "fitted").report["fit"]
    assert report["displacement_error_rms"] < 0.2
    one = bar(4)
    again = build_model(one, one, POLE_WOOD, one, model(4, "fitted").settings)
    assert again.blocks.tobytes() == model(4, "fitted").blocks.tobytes()


def test_build_reports_the_comparison_with_the_reference() -> None:
    one = replace(bar(6), drag_area_m2=np.full(len(bar(6).vertices_m), 1e-3))
    fast = build_model(one, one, POLE_WOOD, one, FemSettings())
    figures = compare_with_reference(fast, one, one, POLE_WOOD, one, 20)
    assert figures["frequency_error"] < 0.1
    assert figures["trajectory_error"] < 0.06


def test_couples_have_zero_resultant() -> None:
    load = random_couples(bar(6).vertices_m, 5, seed=2)
    np.testing.assert_allclose(load.sum(axis=1), 0, atol=1e-12 * np.abs(load).sum())


def test_beam_theory_itself() -> None:
    young, density, area, moment = 7e9, 800.0, 0.01, 8e-6
    found = pole_frequencies(5.0, young, density, area, moment)
    exact = (
        np.array([1.8751040687, 4.6940911330]) ** 2
        * np.sqrt(young * moment / (density * area))
        / 25
        / (2 * np.pi)
    )
    np.testing.assert_allclose(found, exact, rtol=1e-6)
