"""Twigs that are not drawn catch the wind: their area follows from their mass, and leaves shelter them."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from galewood.solid.model.crown_mass import twig_mass_per_area
from galewood.solid.model.foliage import crown_loads
from galewood.solid.model.twigs import END_TWIG_CM, shown_area, twig_area_per_mass
from galewood.wood import wood_of_species

from tests.precompute.solid.model.test_crown_mass import collected, read

WOOD = wood_of_species("maple")
DENSITY_KG_M3 = 900.0


def loads(leaves_drawn: bool, leaves: bool = True) -> Any:
    tree = read(add_leaves=leaves_drawn)
    return crown_loads(tree, WOOD, np.array([2.0, 6.0]), partial(collected, []), 1e6, leaves)


@pytest.mark.parametrize("finest_cm", [1.0, 2.0, 5.0])
def test_the_area_of_all_twigs_is_that_of_thin_slices_of_the_pipe_model(finest_cm: float) -> None:
    scale = twig_mass_per_area(2.0) / 2.0**0.79

    def mass_below(cm: Any) -> Any:
        return scale * cm**0.79

    edges = np.geomspace(END_TWIG_CM, finest_cm, 20_001)
    middle = np.sqrt(edges[1:] * edges[:-1])
    area = (np.diff(mass_below(edges)) / (DENSITY_KG_M3 * middle / 100)).sum()
    area += mass_below(END_TWIG_CM) / (DENSITY_KG_M3 * END_TWIG_CM / 100)
    found = twig_area_per_mass(finest_cm, DENSITY_KG_M3) * twig_mass_per_area(finest_cm)
    assert found == pytest.approx(area, rel=1e-6)


def test_few_twigs_show_all_their_area_and_many_fill_what_is_free() -> None:
    assert shown_area(0.01, 10.0) == pytest.approx(0.01, rel=1e-3)
    assert shown_area(1e3, 10.0) == pytest.approx(10.0)
    assert shown_area(5.0, 0.0) == 0.0 == shown_area(5.0, -1.0)


def test_twigs_catch_the_wind_in_winter_and_are_sheltered_in_leaf() -> None:
    leaf, winter, scan = loads(True), loads(True, leaves=False), loads(False)
    for bare in (winter, scan):
        report = bare.report
        assert 0 < report["added_twig_silhouette_m2"] < report["added_twig_area_m2"]
        assert bare.mass_kg.sum() == pytest.approx(report["added_twig_mass_kg"])
        drawn = report["silhouette_m2"] * WOOD.drag_coefficient
        assert bare.drag_area_m2.sum() > 1.2 * drawn * bare.wind_profile.min() ** 2
        assert (bare.exposed_area_m2 >= bare.drag_area_m2).all()
    assert leaf.report["added_twig_silhouette_m2"] == pytest.approx(0.0, abs=1e-9)
    assert leaf.report["added_twig_area_m2"] == pytest.approx(winter.report["added_twig_area_m2"])
    assert winter.drag_area_m2.sum() < leaf.drag_area_m2.sum()


def test_a_pole_has_no_twig_area() -> None:
    tree = read(add_leaves=False, bearing=2)
    found = crown_loads(tree, WOOD, np.array([2.0, 6.0]), partial(collected, []), 1e6)
    assert "added_twig_area_m2" not in found.report
