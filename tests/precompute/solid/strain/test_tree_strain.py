"""Strain of whole trees in wind: a scanned pole against theory, forks, the critical wind, its spread."""

from dataclasses import replace
from functools import cache

import galewood
import numpy as np
import pytest
from galewood.motion.wind import dynamic_pressure
from galewood.options import ImportRequest
from galewood.solid.beams import Rods
from galewood.solid.strain import CriticalOptions, critical_wind_of, strain_in_wind, wind_rods
from galewood.solid.strain.spread import VARIATION_COEFFICIENTS, Sample, samples
from galewood.solid.strain.tree_rods import WindRods
from galewood.tree import TreeMesh
from galewood.tree.importer import read_tree
from galewood.wood import wood_of_species

from tests.precompute.fixtures.cylinder_models import pole, simpleforest, y_model

OAK = wood_of_species("oak")
WEAK = replace(OAK, modulus_of_rupture_pa=OAK.modulus_of_rupture_pa / 100)
"""Breaks the stout tree of the fixtures in an ordinary storm."""


@cache
def rods_of(name: str, add_leaves: bool = False) -> WindRods:
    return wind_rods(tree_of(name, add_leaves), OAK)


@cache
def tree_of(name: str, add_leaves: bool = False) -> TreeMesh:
    data = simpleforest({"pole": pole, "fork": y_model}[name]())
    return read_tree(data, f"{name}.csv", ImportRequest(species="oak", add_leaves=add_leaves))


def test_strain_of_a_scanned_pole_is_that_of_a_cantilever():
    """6 m high, 16 cm thick at the foot and 8 cm at the top; the moment is that of the forces above."""
    rods = rods_of("pole")
    wind_m_s = 4.0  # bends it so little that the weight adds next to nothing
    found, _ = strain_in_wind(rods, wind_m_s, 90.0)
    pressure = float(dynamic_pressure(wind_m_s, 2.0))
    force, height = pressure * rods.drag_area_m2, rods.points_m[:, 1]
    middle = found.stem & (found.place_m[:, 1] > 0.5) & (found.place_m[:, 1] < 4)
    assert middle.sum() > 10
    for at, strain in zip(found.place_m[middle, 1], found.strain[middle], strict=True):
        radius = 0.08 - 0.04 * at / 6
        moment = (force * np.maximum(height - at, 0)).sum()
        exact = moment / (OAK.young_longitudinal_pa * np.pi / 4 * radius**3)
        assert strain == pytest.approx(exact, rel=0.05)  # the radius of a drawn section enters cubed
    radius = 0.08 - 0.04 * 1.3 / 6
    exact = (force * np.maximum(height - 1.3, 0)).sum() / (OAK.young_longitudinal_pa * np.pi / 4 * radius**3)
    assert found.breast_height_strain == pytest.approx(exact, rel=0.03)
    assert found.base_moment_nm == pytest.approx((force * height).sum(), rel=0.01)


def test_no_strain_is_sought_where_two_limbs_are_still_one_piece_of_wood():
    rods = rods_of("fork")
    assert rods.inside[(np.abs(rods.section_m[:, 1] - 2.03) < 0.05) & (rods.radius_m < 0.05)].all()
    found, _ = strain_in_wind(rods, 40.0, 0.0)
    line = found.branch == 0
    at_fork = line & (np.abs(found.place_m[:, 1] - 2.0) < 0.25)
    above = line & (found.place_m[:, 1] > 2.25) & (found.place_m[:, 1] < 2.6)
    assert found.strain[at_fork].max() < 1.2 * found.strain[above].max()


def test_a_tree_breaks_at_the_wind_that_strains_it_to_rupture():
    rods = replace(rods_of("fork"), wood=WEAK)
    critical = critical_wind_of(rods, CriticalOptions(direction_deg=0, sample_count=0))
    assert np.isfinite(critical.gust_m_s)
    found, _ = strain_in_wind(rods, critical.gust_m_s, 0.0)
    assert found.strain[found.stem].max() == pytest.approx(WEAK.rupture_strain, rel=5e-3)
    assert critical.quantiles_m_s is None
    assert critical.overturning_m_s is None
    # a stiff tree without leaves: the square law holds
    assert critical.extrapolated_m_s == pytest.approx(critical.breast_height_m_s, rel=0.03)
    knotty = critical_wind_of(rods, CriticalOptions(direction_deg=0, sample_count=0, knot_factor=0.7))
    assert knotty.gust_m_s == pytest.approx(np.sqrt(0.7) * critical.gust_m_s, rel=0.02)


def test_a_bough_breaks_at_the_wind_of_an_exact_cantilever():
    """A level bough of 2 m across the wind, with wind on its tip only; without weight."""
    count, radius, tip_m2, at_m = 20, 0.03, 0.5, 3.0
    stem = np.column_stack([np.zeros(9), np.linspace(0, 4, 9), np.zeros(9)])
    along = np.linspace(0.1, 2.1, count + 1)
    bough = np.column_stack([0 * along, 0 * along + at_m, along])
    points = np.concatenate([stem, bough])
    parent = np.concatenate([np.arange(-1, 8), [6], np.arange(9, len(points) - 1)])
    branch = np.repeat([0, 1], [9, count + 1])
    thick = np.where(branch == 0, 0.25, radius)
    second, none = np.pi / 4 * thick**4, np.zeros(len(points))
    inside, clamped, area = none.astype(bool), none.astype(np.int64), none.copy()
    inside[[0, 9]], clamped[0], area[-1] = True, 1, tip_m2
    rods = Rods(
        parent, points - points[np.maximum(parent, 0)], WEAK.young_longitudinal_pa * second,
        2 * WEAK.shear_longitudinal_pa * second, clamped, none,
    )  # fmt: skip
    tree = WindRods(
        rods, points, thick, branch, inside, area, none, none, area, none + 1, 2.0, WEAK, 0.0, 1.0
    )
    found = critical_wind_of(tree, CriticalOptions(direction_deg=0, sample_count=20, seed=2)).boughs
    assert found is not None and found.section is not None
    arm = 2.0 - 0.05  # from the middle of the first piece to the tip
    force = WEAK.modulus_of_rupture_pa * np.pi / 4 * radius**3 / arm
    assert found.gust_m_s == pytest.approx(np.sqrt(force / (0.6 * tip_m2)), rel=5e-3)
    assert found.section.diameter_cm == pytest.approx(6.0)
    place = found.section.x_m, found.section.height_m, found.section.z_m
    assert place == pytest.approx((0.0, at_m, 0.15), abs=1e-9)
    low, median, high = found.quantiles_m_s or (0, 0, 0)
    assert low < median < high
    # (strength / drag)^½ of each possible tree
    exact = [np.sqrt(one.rupture / one.drag) * found.gust_m_s for one in samples(20, 2)]
    np.testing.assert_allclose(found.samples_m_s, exact, rtol=5e-3)


def test_overturning_is_assessed_where_the_strength_of_the_roots_is_known():
    rods = rods_of("fork")
    options = CriticalOptions(direction_deg=0, sample_count=0, root_strength_knm=0.5)
    speed = critical_wind_of(rods, options).overturning_m_s
    assert speed is not None
    assert strain_in_wind(rods, speed, 0.0)[0].base_moment_nm == pytest.approx(500, rel=5e-3)


def test_possible_trees_spread_around_the_mean_tree():
    rods = replace(rods_of("fork", add_leaves=True), wood=WEAK)
    options = CriticalOptions(direction_deg=0, sample_count=40, seed=5)
    first, again = critical_wind_of(rods, options), critical_wind_of(rods, options)
    assert np.array_equal(first.stem.samples_m_s, again.stem.samples_m_s)
    assert first.quantiles_m_s is not None
    low, median, high = first.quantiles_m_s
    assert low < median < high
    assert figures_are_plain(first.figures())


def figures_are_plain(value) -> bool:
    if isinstance(value, dict):
        return all(isinstance(key, str) and figures_are_plain(one) for key, one in value.items())
    if isinstance(value, list):
        return all(map(figures_are_plain, value))
    return value is None or isinstance(value, int | float | str | bool)


def test_samples_have_the_stated_spread():
    drawn = np.array(samples(4000, 3))
    for name, factors in zip(Sample._fields, drawn.T, strict=True):
        assert np.median(factors) == pytest.approx(1, abs=0.03)
        assert factors.std() / factors.mean() == pytest.approx(VARIATION_COEFFICIENTS[name], rel=0.08)
    assert np.corrcoef(np.log(drawn[:, 0]), np.log(drawn[:, 1]))[0, 1] == pytest.approx(0.7, abs=0.03)


def test_a_wind_of_no_speed_strains_nothing():
    found = galewood.strain(galewood.Tree(tree_of("fork"), b""), wind_m_s=0.0)
    assert found.strain.max() < 1e-9
    with pytest.raises(ValueError, match="wind_m_s"):
        galewood.strain(galewood.Tree(tree_of("fork"), b""), wind_m_s=-1.0)


@pytest.mark.filterwarnings("error")
def test_a_limb_without_thickness_has_no_section():
    rods = rods_of("fork")
    tip = int(np.argmax(rods.section_m[:, 1]))
    radius = rods.radius_m.copy()
    radius[tip] = 0.0
    whole, _ = strain_in_wind(rods, 20.0, 0.0)
    found, _ = strain_in_wind(replace(rods, radius_m=radius), 20.0, 0.0)
    assert len(found.strain) == len(whole.strain) - 1
    assert np.isfinite(found.strain).all()
