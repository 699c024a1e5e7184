"""Built-in species, and rejection of invalid wood."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.wood.species import SPECIES, is_evergreen, wood_of_species

MEASURED_EXPONENTS = {"oak": 1.64, "spruce": 1.49, "pine": 1.25, "larch": 1.25}


@pytest.mark.parametrize("name", sorted(SPECIES))
def test_every_species_is_stable_green_wood(name: str) -> None:
    wood = wood_of_species(name)
    assert wood.is_stable()
    assert 5e9 < wood.young_longitudinal_pa < 15e9
    assert wood.young_transverse_pa < 0.2 * wood.young_longitudinal_pa
    assert 500 < wood.density_kg_m3 < 1200
    assert 0.02 <= wood.damping_ratio <= 0.05
    assert wood.streamlined_exponent == MEASURED_EXPONENTS.get(name, 1.3)
    assert 0.005 < wood.rupture_strain < 0.008
    assert wood.source


@pytest.mark.parametrize(
    ("name", "strain"), [("oak", 0.0069), ("ash", 0.007), ("birch", 0.0074), ("sycamore", 0.0079)]
)
def test_rupture_strains_of_the_measured_trees(name: str, strain: float) -> None:
    assert wood_of_species(name).rupture_strain == pytest.approx(strain, rel=0.005)


def test_conifers_but_the_larch_are_evergreen() -> None:
    assert {name for name in SPECIES if is_evergreen(name)} == {"conifer", "pine", "spruce"}
    assert is_evergreen(" Fir ")
    assert not is_evergreen("triffid") and not is_evergreen(None)


def test_aliases_are_accepted_in_any_case() -> None:
    assert wood_of_species(" Aspen ") is SPECIES["poplar"]


def test_unknown_species_error_lists_the_known_ones() -> None:
    with pytest.raises(KeyError, match=r"apricot.*maple.*poplar"):
        wood_of_species("triffid")


@pytest.mark.parametrize(
    "change",
    [
        {"young_longitudinal_pa": 0.0},
        {"density_kg_m3": float("nan")},
        {"damping_ratio": 1.0},
        {"poisson_transverse": 1.2},
        {"streamlined_exponent": 2.1},
    ],
)
def test_impossible_wood_is_rejected(change: dict[str, float]) -> None:
    with pytest.raises(ValueError):
        replace(wood_of_species("maple"), **change)


def test_transverse_shear_follows_from_isotropy_across_the_fibre() -> None:
    wood = wood_of_species("maple")
    assert np.isclose(wood.shear_transverse_pa * 2 * (1 + wood.poisson_transverse), wood.young_transverse_pa)
