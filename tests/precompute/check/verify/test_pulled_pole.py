"""The elastica of a pulled pole against closed solutions, and the checks of pulling against it."""

from __future__ import annotations

import numpy as np
import pytest
from galewood.check.verify.beams import Section, elastica_tip
from galewood.check.verify.pull_checks import checks
from galewood.check.verify.pulled_pole import PulledPole

LENGTH_M, BENDING_N_M2 = 5.0, 4000.0
HEIGHT_M = np.linspace(0.0, LENGTH_M, 50)


def uniform(pulled_at_m: float = LENGTH_M, weight_n: float = 0.0) -> PulledPole:
    """A uniform pole without mass, with a weight at its top."""
    return PulledPole(
        height_m=HEIGHT_M,
        bending_n_m2=np.full(len(HEIGHT_M), BENDING_N_M2),
        weight_n=np.full(len(HEIGHT_M), weight_n),
        pulled_at_m=pulled_at_m,
    )


@pytest.mark.parametrize("force_n", [20.0, 150.0])
def test_a_uniform_pole_pulled_at_its_tip_is_the_elastica(force_n: float) -> None:
    rigid = Section(BENDING_N_M2, 1e15, 1e15)
    assert uniform().sway_m(force_n) == pytest.approx(elastica_tip(force_n, LENGTH_M, rigid)[0], rel=1e-6)


def test_the_linear_sway_is_that_of_a_cantilever() -> None:
    at_m = 3.5
    expected = 7.0 * at_m**3 / (3 * BENDING_N_M2)
    assert uniform(at_m).sway_m(7.0, linear=True) == pytest.approx(expected, rel=1e-6)
    assert uniform(at_m).sway_m(0.01) == pytest.approx(uniform(at_m).sway_m(0.01, linear=True), rel=1e-5)


def test_a_weight_at_the_top_increases_the_linear_sway_as_the_beam_column_does() -> None:
    weight_n = 0.4 * np.pi**2 * BENDING_N_M2 / (4 * LENGTH_M**2)
    number = LENGTH_M * np.sqrt(weight_n / BENDING_N_M2)
    # Timoshenko and Gere: P (tan u − u) / (W k) with u = k L
    expected = 3.0 * LENGTH_M / weight_n * (np.tan(number) / number - 1)
    assert uniform(weight_n=weight_n).sway_m(3.0, linear=True) == pytest.approx(expected, rel=1e-5)


def test_the_checks_of_pulling_pass() -> None:
    found = list(checks())
    print(*(check.line() for check in found), sep="\n")
    assert len(found) == 2 and all(check.passed for check in found)
