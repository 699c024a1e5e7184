"""The checks of `galewood verify` pass as they are and fail once an error is planted in the model."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from galewood.check.verify import beam_checks, element_checks, motion_checks
from galewood.check.verify.bars import Bar, polygon_bar
from galewood.check.verify.checks import Check
from galewood.solid.fem.model import FemModel
from galewood.solid.model.construction import build_model
from galewood.wood.species import Wood

Plant = Callable[[Wood], Wood]


def stiffer(wood: Wood) -> Wood:
    return replace(wood, young_longitudinal_pa=1.15 * wood.young_longitudinal_pa)


def heavier(wood: Wood) -> Wood:
    return replace(wood, density_kg_m3=1.15 * wood.density_kg_m3)


def planted(monkeypatch: pytest.MonkeyPatch, change: Plant) -> None:
    """Every model of the beam checks is built of a changed wood, the exact values are not."""

    def build(mesh: Any, skeleton: Any, wood: Wood, lumped: Any, settings: Any) -> FemModel:
        return build_model(mesh, skeleton, change(wood), lumped, settings)

    monkeypatch.setattr(beam_checks, "build_model", build)


def failed(checks: Iterable[Check]) -> list[bool]:
    found = list(checks)
    print(*(check.line() for check in found), sep="\n")
    return [not check.passed for check in found]


GROUPS: dict[str, tuple[Callable[[], Iterable[Check]], tuple[Plant, ...]]] = {
    "convergence": (lambda: beam_checks._convergence(), (stiffer,)),
    "sag": (lambda: [beam_checks._sagging()], (stiffer, heavier)),
    "pole frequencies": (lambda: beam_checks._pole_frequencies(), (stiffer, heavier)),
}


@pytest.mark.parametrize("name", GROUPS)
def test_a_beam_check_passes_and_fails_with_15_percent_more_stiffness_or_mass(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    group, plants = GROUPS[name]
    assert not any(failed(group()))
    for plant in plants:
        with monkeypatch.context() as patch:
            planted(patch, plant)
            assert all(failed(group())), plant.__name__


def test_cantilever_tips_fail_with_15_percent_more_stiffness(monkeypatch: pytest.MonkeyPatch) -> None:
    for other in ("_convergence", "_pole_frequencies"):
        monkeypatch.setattr(beam_checks, other, lambda: iter(()))
    for other in ("_sagging", "_softened", "sprung", "bent_far"):
        monkeypatch.setattr(beam_checks, other, lambda *_: None)
    checks = [check for check in beam_checks.checks() if check is not None]
    assert len(checks) == 8
    assert not any(failed(checks))

    def coarser(*, layers: int, **size: Any) -> Bar:
        return polygon_bar(layers=layers // 2, **size)

    planted(monkeypatch, stiffer)
    monkeypatch.setattr(beam_checks, "polygon_bar", coarser)
    checks = [check for check in beam_checks.checks() if check is not None]
    assert all(failed(checks))
    # what the coarser mesh changes is small beside the planted error, which it is to show
    assert [check.deviation for check in checks] == pytest.approx([1 / 1.15 - 1] * 8, abs=0.04)


def test_softening_fails_without_the_weight_s_part_of_the_stiffness(monkeypatch: pytest.MonkeyPatch) -> None:
    assert beam_checks._softened().passed

    def light(mesh: Any, skeleton: Any, wood: Wood, lumped: Any, settings: Any) -> FemModel:
        heavy = replace(wood, density_kg_m3=0.95 * wood.density_kg_m3) if settings.gravity else wood
        return build_model(mesh, skeleton, heavy, lumped, settings)

    monkeypatch.setattr(beam_checks, "build_model", light)
    assert not beam_checks._softened().passed


def test_motion_checks_fail_with_another_mass_or_damping(monkeypatch: pytest.MonkeyPatch) -> None:
    model = motion_checks.loaded_pole()
    monkeypatch.setattr(motion_checks, "loaded_pole", lambda: model)
    assert not any(failed(motion_checks.checks()))
    heavy = replace(model, mass_kg=1.05 * model.mass_kg)
    ringing = list(motion_checks.ring_downs(heavy))
    assert [check.passed for check in ringing if "frequency" in check.name] == [False, False]
    damped = replace(model, alpha=1.05 * model.alpha, beta=1.05 * model.beta)
    ringing = list(motion_checks.ring_downs(damped))
    assert [check.passed for check in ringing if "damping" in check.name] == [False, False]


def test_energy_check_fails_when_damping_feeds_the_motion() -> None:
    model = motion_checks.loaded_pole()
    assert motion_checks.energy_rise(model, 40) <= 1e-6
    assert motion_checks.energy_rise(replace(model, alpha=-0.5, beta=0.0), 40) > 1e-6


def test_element_checks_fail_with_a_millionth_more_stiffness(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not any(failed(element_checks.checks()))
    exact = element_checks.stiffness_blocks

    def scaled(*arguments: Any) -> tuple[np.ndarray, np.ndarray]:
        axial, shear = exact(*arguments)
        return axial * (1 + 1e-6), shear

    monkeypatch.setattr(element_checks, "stiffness_blocks", scaled)
    wrong = [check for check in element_checks.checks() if not check.passed]
    assert sum("scikit-fem" in check.name for check in wrong) == 2

    def uneven(*arguments: Any) -> tuple[np.ndarray, np.ndarray]:
        axial, shear = exact(*arguments)
        return axial * np.linspace(1, 1 + 1e-6, len(axial))[:, None, None, None], shear

    monkeypatch.setattr(element_checks, "stiffness_blocks", uneven)
    wrong = [check for check in element_checks.checks() if not check.passed]
    assert sum("patch test" in check.name for check in wrong) == 2
