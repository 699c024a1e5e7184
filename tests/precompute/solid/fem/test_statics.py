"""Static equilibrium: exact solutions, residual forces, loads beyond buckling."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.check.verify.bars import Bar, polygon_bar
from galewood.check.verify.beam_checks import ELASTICA_LIMITS, POLE_WOOD, bent_far, weightless
from galewood.check.verify.beams import Section, elastica_tip, tip_deflection
from galewood.check.verify.element_checks import element_system, shaken_box
from galewood.solid.fem import PAIRS, Element, ElementSystem, FemModel, solve_static
from galewood.solid.fem.elements.tangent import add_stress_terms, shape_gradients, stress_terms
from scipy.special import ellipeinc, ellipkinc

LENGTH_M = 5.0


def pole(element: Element = "fitted", layers: int = 60) -> tuple[Bar, FemModel]:
    bar = polygon_bar(sides=6, radius_m=0.06, length_m=LENGTH_M, layers=layers)
    return bar, weightless(bar, element)


def residual(system: ElementSystem, u, load) -> float:
    """Largest unbalanced force on a free node over the largest load, in mesh order."""
    inner = np.ascontiguousarray(u[system.order])
    force = np.zeros_like(inner)
    system.force(inner, np.zeros_like(inner), force)
    off = (force - load[system.order])[: system.free]
    return float(np.abs(off).max() / np.abs(load).max())


def test_the_elastica_of_an_unstretchable_beam_agrees_with_elliptic_integrals():
    # Bisshopp and Drucker 1945: with the tip turned by φ, p² = (1 + sin φ) / 2 and sin θ₁ = 1 / (p √2),
    # the force is √(P L² / EI) = F(π/2, p) − F(θ₁, p), and the height L − 2 (E(π/2) − E(θ₁)) / k below.
    modulus = (1 + np.sin(np.radians(35.0))) / 2
    begin = np.arcsin(1 / np.sqrt(2 * modulus))
    root = ellipkinc(np.pi / 2, modulus) - ellipkinc(begin, modulus)
    sway = 1 - 2 * (ellipeinc(np.pi / 2, modulus) - ellipeinc(begin, modulus)) / root
    height = np.sqrt(2 * np.sin(np.radians(35.0))) / root
    found = elastica_tip(root**2, 1.0, Section(1.0, 1e12, 1e12))
    assert found == pytest.approx((sway, height), rel=1e-8)


@pytest.mark.parametrize("sway", ELASTICA_LIMITS)
def test_a_pole_bends_like_the_elastica(sway):
    check = bent_far(sway, ELASTICA_LIMITS[sway])
    assert check.passed, check.line()


@pytest.mark.parametrize("element", ["fitted", "quadratic"])
@pytest.mark.parametrize("share", [0.1, 1.5])
def test_forces_balance_at_the_solution(element, share):
    bar, model = pole(element)
    load = np.zeros_like(model.nodes_m)
    stiffness = POLE_WOOD.young_longitudinal_pa * bar.second_moment_m4
    load[bar.tip] = np.array([0.8, -0.5, 0.3]) * share * stiffness / LENGTH_M**2 / len(bar.tip)
    system = model.system()
    u, _, converged = solve_static(system, load)
    assert converged
    # The tolerance of the steps, 1e-9, is amplified by the ratio of axial to bending stiffness, about 1e4.
    assert residual(system, u, load) < 1e-3


def test_a_small_load_gives_the_linear_solution():
    bar, model = pole("quadratic")
    load = np.zeros_like(model.nodes_m)
    load[bar.tip, 0] = 1e-3 / len(bar.tip)
    u, solutions, converged = solve_static(model.system(), load)
    stiffness = POLE_WOOD.young_longitudinal_pa
    assert converged and solutions <= 6
    exact = tip_deflection(1e-3, LENGTH_M, stiffness, bar.second_moment_m4)
    assert u[bar.tip, 0].mean() == pytest.approx(exact, rel=0.003)


def test_the_prestress_of_the_system_does_not_change_the_solution_and_is_kept():
    bar, model = pole("fitted", 20)
    load = np.zeros_like(model.nodes_m)
    load[bar.tip, 0] = 100.0 / len(bar.tip)
    plain, _, _ = solve_static(model.system(), load)
    system = model.system()
    some = np.random.default_rng(3).normal(size=system.prestress.shape)
    system.set_prestress(some)
    again, _, converged = solve_static(system, load)
    assert converged
    np.testing.assert_allclose(again, plain, rtol=0, atol=1e-9 * np.abs(plain).max())
    np.testing.assert_array_equal(system.prestress, some)


def test_a_compressed_pole_stands_below_the_buckling_load_and_falls_far_above_it():
    bar, model = pole("fitted")
    stiffness = POLE_WOOD.young_longitudinal_pa * bar.second_moment_m4
    euler = np.pi**2 * stiffness / (4 * LENGTH_M**2)
    sways = []
    for share in (0.0, 0.5, 0.8):
        load = np.zeros_like(model.nodes_m)
        load[bar.tip] = np.array([0.001, -share, 0.0]) * euler / len(bar.tip)
        u, _, converged = solve_static(model.system(), load)
        assert converged
        sways.append(u[bar.tip, 0].mean())
    # Sway grows as 1 / (1 − P / P_c), to about 2 % (the shape changes a little; the fast elements' E I).
    np.testing.assert_allclose(np.array(sways[1:]) / sways[0], [2.0, 5.0], rtol=0.1)


@pytest.mark.parametrize("element", ["linear", "quadratic"])
def test_stress_terms_are_those_of_a_uniform_stress(element):
    """∫ ∇N_a · σ ∇N_b dV by brute force: second derivative of the work of a dead stress."""
    bar = shaken_box()
    system = element_system(replace(bar, tets=bar.tets[:30]), element)
    gradient = 1e-3 * np.random.default_rng(5).normal(size=(3, 3))
    field = system.rest @ gradient.T
    terms = stress_terms(system, np.zeros_like(field), field)
    width = system.elements.shape[1]
    c, pairs = shape_gradients(width), [(a, b) for a in range(width) for b in range(a, width)]
    for e in (0, 11, 29):
        corners = system.elements[e, :4]
        force = np.zeros((4, 3))
        for p, (a, b) in enumerate(PAIRS):
            block = system.blocks[e, p].reshape(3, 3)
            force[a] += block @ field[corners[b]]
            if a != b:
                force[b] += block.T @ field[corners[a]]
        # A uniform stress: V σ ∇λ_j = force_j, and Σ_j x_j ⊗ force_j = V σ.
        stress = sum(np.outer(force[j], system.rest[corners[j]]) for j in range(4))
        slopes = np.einsum("pai,ik->pak", c, system.grad[e])
        for (a, b), found in zip(pairs, terms[e], strict=True):
            expected = np.mean([slope[a] @ stress @ slope[b] for slope in slopes])
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(stress).max())


def test_stress_terms_turn_the_force_of_a_turned_element():
    """Where an element turns, its forces turn with it: Σ_b K_σ,ab (ω × x_b) = ω × f_a for its mean stress."""
    system = element_system(shaken_box(), "linear")
    field = system.rest @ (1e-3 * np.random.default_rng(6).normal(size=(3, 3))).T
    still, force = np.zeros_like(field), np.zeros_like(field)
    system.force(still, field, force)
    system.values[:] = 0
    add_stress_terms(system, stress_terms(system, still, field))
    matrix = system.solver.to_scipy(system.values)
    turn = np.array([0.3, -0.2, 0.5])
    # The only fixed node is the centre of the rotation, because the matrix has no column for it.
    spun = np.cross(turn, system.rest - system.rest[system.free])[: system.free]
    expected = np.cross(turn, force)[: system.free]
    np.testing.assert_allclose(
        (matrix @ spun.ravel()).reshape(-1, 3), expected, atol=1e-9 * np.abs(force).max()
    )
