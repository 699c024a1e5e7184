"""Trees whose given shape is taken as already bent by their weight: it stays, and keeps its stiffness."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.check.verify.bars import Bar, polygon_bar
from galewood.solid.fem import Element, FemModel, FemSettings, Simulator, load_model, save_model, statics
from galewood.solid.model import build_model
from galewood.wood import wood_of_species

WOOD = wood_of_species("poplar")
ELEMENTS: tuple[Element, ...] = ("fitted", "quadratic")


def built(bar: Any, element: Element, *, gravity: bool = True) -> FemModel:
    return build_model(bar, bar, WOOD, bar, FemSettings(element=element, gravity=gravity))


def loaded(bar: Any, element: Element, monkeypatch: pytest.MonkeyPatch) -> FemModel:
    """The model of a bar whose given shape is taken as loaded, however little it sags."""
    with monkeypatch.context() as patch:
        patch.setattr(statics, "LARGEST_SAG", -1.0)
        model = built(bar, element)
    assert model.report["rest_pose"] == {"kind": "loaded"}
    return model


def leaning(bar: Bar, degrees: float) -> Bar:
    """The bar turned about z, its base where it was."""
    turn = np.radians(degrees)
    rotation = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    return replace(bar, vertices_m=bar.vertices_m @ rotation.T, tet_fibre=bar.tet_fibre @ rotation.T)


def standing_pole() -> Bar:
    """A pole at about half its buckling load."""
    return polygon_bar(sides=6, radius_m=0.012, length_m=4.5, layers=30)


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_pole_is_softened_by_its_weight_as_if_it_stood_unstrained(
    element: Element, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A straight pole only shortens under its weight, so both treatments must give the same modes."""
    pole = standing_pole()
    free, sagged = built(pole, element, gravity=False), built(pole, element)
    assert sagged.report["rest_pose"]["kind"] == "sagged"
    softened = np.array(sagged.report["frequencies_hz"][:6])
    found = np.array(loaded(pole, element, monkeypatch).report["frequencies_hz"][:6])
    assert softened[0] < 0.9 * free.report["frequencies_hz"][0], "the test needs a heavy pole"
    np.testing.assert_allclose(found, softened, rtol=2e-3)


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_leaning_pole_stays_where_it_is_drawn_and_moves_alike(
    element: Element, monkeypatch: pytest.MonkeyPatch
) -> None:
    pole = leaning(polygon_bar(sides=6, radius_m=0.03, length_m=4.0, layers=24), 60)
    model = loaded(pole, element, monkeypatch)
    simulator = Simulator(model)
    for _ in range(5):
        simulator.step(np.zeros(2))
    assert np.abs(simulator.u).max() < 1e-7, "the weight is balanced exactly"
    # it still has its weight: pushed sideways, it moves as a pole that was drawn unstrained and then sagged
    small = leaning(polygon_bar(sides=6, radius_m=0.04, length_m=4.0, layers=24), 60)
    pair = [loaded(small, element, monkeypatch), built(small, element)]
    assert pair[1].report["rest_pose"]["kind"] == "sagged"
    first = [np.array(one.report["frequencies_hz"][:4]) for one in pair]
    np.testing.assert_allclose(first[0], first[1], rtol=0.02)


def test_a_horizontal_twig_that_would_hang_far_down_is_loaded_and_not_weightless() -> None:
    twig = leaning(polygon_bar(sides=5, radius_m=0.006, length_m=4.0, layers=24), 90)
    trunk = np.ptp(twig.vertices_m[:, 1])
    assert trunk < 0.1
    model = built(twig, "fitted")
    assert model.report["rest_pose"] == {"kind": "loaded"}
    assert np.abs(model.gravity_n).max() > 0
    weightless = built(twig, "fitted", gravity=False)
    ratio = model.report["frequencies_hz"][0] / weightless.report["frequencies_hz"][0]
    assert 0.9 < ratio < 1.1


def test_the_file_of_a_loaded_model_is_exact(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = loaded(standing_pole(), "fitted", monkeypatch)
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


def test_energy_of_a_loaded_pole_does_not_grow(monkeypatch: pytest.MonkeyPatch) -> None:
    """After a push the sway decays, although the weight pulls the bent pole further over."""
    model = loaded(standing_pole(), "fitted", monkeypatch)
    simulator = Simulator(model)
    far: list[float] = []
    for frame in range(600):
        simulator.step(np.array([0.5 if frame < 15 else 0.0, 0.0]))
        far.append(float(np.abs(simulator.u).max()))
    assert max(far[-150:]) < max(far[15:165])
