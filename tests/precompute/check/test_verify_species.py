"""The checks of a whole tree, and the table of checks."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.check.verify.checks import absolute, relative, skipped
from galewood.check.verify.run import MARKERS, insert_table, markdown
from galewood.check.verify.species_checks import (
    against_measured_trees,
    against_reference,
    breast_radius_m,
    of_specimen,
    on_meshes,
    ringing,
    wood_mass,
)
from galewood.check.verify.specimens import TARGETS
from galewood.wood import wood_of_species

from tests.precompute.fixtures.apricot import apricot


def test_all_checks_of_a_whole_tree_pass():
    checks = list(of_specimen(apricot(), frames=45))
    assert len(checks) >= 10
    assert not [check.line() for check in checks if not check.passed]


def test_the_first_frequency_hardly_depends_on_the_mesh():
    checks = list(on_meshes([apricot(target) for target in TARGETS]))
    assert not [check.line() for check in checks if not check.passed]


def test_a_wrong_tree_fails():
    """The checks can fail: without radius correction, without damping, and with linear elements."""
    one = apricot()
    thick = replace(one, mesh=replace(one.mesh, radius_ratio=np.ones(len(one.mesh.tets))))
    assert not wood_mass(thick).passed
    undamped = replace(one.fast, alpha=0.0, beta=0.0)
    other = replace(one)
    other.__dict__["fast"] = undamped
    assert [check.passed for check in ringing(other)] == [True, False]
    linear = replace(one)
    linear.__dict__["fast"] = one.model("linear")
    assert not any(check.passed for check in against_reference(linear, 20))


@pytest.mark.parametrize("factor", [0.69, 1.45])
def test_a_first_frequency_beyond_a_standard_deviation_of_measured_trees_fails(factor: float) -> None:
    one = apricot()
    check = against_measured_trees(one)
    assert check.passed and check.exact is not None
    other = replace(one)
    report = {**one.fast.report, "frequencies_hz": [factor * check.exact]}
    other.__dict__["fast"] = replace(one.fast, report=report)
    assert not against_measured_trees(other).passed


@pytest.mark.parametrize(("factor", "passes"), [(0.76, True), (1.24, True), (0.74, False), (1.26, False)])
def test_a_conifer_is_compared_with_measured_conifers(factor: float, passes: bool) -> None:
    one = apricot()
    girth_cm = 200 * breast_radius_m(one)
    measured = 0.0639 + 3.247 * girth_cm / one.tree.height_m**2
    spruce = replace(one, wood=wood_of_species("spruce"))
    report = {**one.fast.report, "frequencies_hz": [factor * measured]}
    spruce.__dict__["fast"] = replace(one.fast, report=report)
    assert against_measured_trees(spruce).passed is passes


def test_the_table_replaces_the_text_between_its_markers():
    table = markdown([relative("a", 2.0, 2.1, "m", 0.1), absolute("b", 0.5, 0.1), skipped("c", "no reason")])
    assert [line.split(" | ")[-1] for line in table.splitlines()[2:]] == [
        "passed |",
        "FAILED |",
        "skipped; no reason |",
    ]
    page = f"before\n{MARKERS[0]}\nold\n{MARKERS[1]}\nafter\n"
    again = insert_table(insert_table(page, table), table)
    assert again == f"before\n{MARKERS[0]}\n{table}\n{MARKERS[1]}\nafter\n"
    with pytest.raises(ValueError, match="no lines"):
        insert_table("nothing", table)
