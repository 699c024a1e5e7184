"""The given shape is that under the weight: it stays, and is softened by the weight as beam theory says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.check.verify.bars import Bar, polygon_bar
from galewood.check.verify.beams import softening
from galewood.solid.fem import Element, FemModel, FemSettings, Simulator, load_model, save_model, solve_static
from galewood.solid.model import build_model
from galewood.wood import wood_of_species

WOOD = wood_of_species("poplar")
ELEMENTS: tuple[Element, ...] = ("fitted", "quadratic")
POLE_M = 4.5


def built(bar: Any, element: Element, *, gravity: bool = True) -> FemModel:
    return build_model(bar, bar, WOOD, bar, FemSettings(element=element, gravity=gravity))


def leaning(bar: Bar, degrees: float) -> Bar:
    """The bar turned about z, its base where it was."""
    turn = np.radians(degrees)
    rotation = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    return replace(bar, vertices_m=bar.vertices_m @ rotation.T, tet_fibre=bar.tet_fibre @ rotation.T)


def standing_pole() -> Bar:
    """A pole at about 30 % of its buckling load."""
    return polygon_bar(sides=6, radius_m=0.0155, length_m=POLE_M, layers=30)


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_pole_is_softened_by_its_weight_as_in_beam_theory(element: Element) -> None:
    pole = standing_pole()
    free, loaded = built(pole, element, gravity=False), built(pole, element)
    pose = loaded.report["rest_pose"]
    assert pose["kind"] == "loaded" and 0.25 < pose["load_factor"] < 1 / 3
    weight = 9.81 * WOOD.density_kg_m3 * pole.area_m2 * POLE_M
    exact = softening(weight, POLE_M, WOOD.young_longitudinal_pa, pole.second_moment_m4)
    ratio = loaded.report["frequencies_hz"][0] / free.report["frequencies_hz"][0]
    assert ratio == pytest.approx(exact, rel=0.01)
    assert pose["load_factor"] == pytest.approx(1 - exact**2, rel=0.04)


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_leaning_pole_stays_where_it_is_drawn(element: Element) -> None:
    model = built(leaning(polygon_bar(sides=6, radius_m=0.03, length_m=4.0, layers=24), 60), element)
    simulator = Simulator(model)
    for _ in range(5):
        simulator.step(np.zeros(2))
    assert np.abs(simulator.u).max() < 1e-7, "the weight is balanced exactly"
    u, _, converged = solve_static(model.system(), model.gravity_n)
    assert converged and np.abs(u).max() < 1e-7, "regression: rounding was taken for a displacement"


def test_a_horizontal_twig_keeps_its_weight() -> None:
    twig = leaning(polygon_bar(sides=5, radius_m=0.006, length_m=4.0, layers=24), 90)
    model = built(twig, "fitted")
    assert np.abs(model.gravity_n).max() > 0
    weightless = built(twig, "fitted", gravity=False)
    ratio = model.report["frequencies_hz"][0] / weightless.report["frequencies_hz"][0]
    assert 0.9 < ratio < 1.1


def test_the_file_of_a_loaded_model_is_exact(tmp_path: Path) -> None:
    model = built(standing_pole(), "fitted")
    save_model(model, tmp_path / "model.npz")
    again = load_model(tmp_path / "model.npz")
    assert again.strain_m is not None and model.strain_m is not None
    assert again.strain_m.tobytes() == model.strain_m.tobytes()
    ends: list[bytes] = []
    for one in (model, again):
        simulator = Simulator(one)
        simulator.step(np.array([3.0, 1.0]))
        ends.append(simulator.u.tobytes())
    assert ends[0] == ends[1]


def test_energy_of_a_loaded_pole_does_not_grow() -> None:
    """After a push the sway decays, although the weight pulls the bent pole further over."""
    model = built(standing_pole(), "fitted")
    simulator = Simulator(model)
    far: list[float] = []
    for frame in range(600):
        simulator.step(np.array([0.5 if frame < 15 else 0.0, 0.0]))
        far.append(float(np.abs(simulator.u).max()))
    assert max(far[-150:]) < max(far[15:165])
