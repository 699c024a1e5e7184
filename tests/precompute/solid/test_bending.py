"""Bent rods against beam theory, the linear frame, buckling loads and quadratic elements."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.check.verify.bars import box_bar
from galewood.check.verify.beams import Section, elastica_tip, laden_pole
from galewood.solid.beams import Frame, Rods, bent, frame_matrices, rod_buckling
from galewood.solid.fem import LARGEST_LOSS, FemSettings, remaining_share, solve_static
from galewood.solid.model import GRAVITY_M_S2, unloaded_model
from galewood.solid.strain.standing import standing_rods
from galewood.wood import wood_of_species
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

WOOD = wood_of_species("maple")
LENGTH_M, FOOT_M, TIP_M = 10.0, 0.15, 0.03


def rods_through(points, parent, radius, weight_n=None) -> Rods:
    points, parent = np.asarray(points, float), np.asarray(parent, np.int64)
    moment = np.pi / 4 * np.asarray(radius, float) ** 4
    clamped = np.zeros(len(parent), np.int64)
    clamped[0] = 1
    return Rods(
        parent,
        points - points[np.maximum(parent, 0)],
        WOOD.young_longitudinal_pa * moment,
        2 * WOOD.shear_longitudinal_pa * moment,
        clamped,
        np.zeros(len(parent)) if weight_n is None else weight_n,
    )


def radius_at(height_m):
    return FOOT_M + (TIP_M - FOOT_M) * height_m / LENGTH_M


def tapered_pole(count: int) -> tuple[Rods, np.ndarray, np.ndarray]:
    """The pole under its weight, the heights of its points, and the radii of its rods."""
    height = np.linspace(0, LENGTH_M, count + 1)
    radius = np.concatenate([[FOOT_M], radius_at((height[1:] + height[:-1]) / 2)])
    half = GRAVITY_M_S2 * WOOD.density_kg_m3 * np.pi * radius[1:] ** 2 * LENGTH_M / count / 2
    weight = np.zeros(count + 1)
    weight[1:] += half
    weight[:-1] += half
    points = np.column_stack([0 * height, height, 0 * height])
    return rods_through(points, np.arange(-1, count), radius, weight), height, radius


def exact_moments(force_n, at_m):
    """Of the pole under a force at its tip and its weight: E I θ' = M, M' = −(F cos θ + W sin θ)."""
    per_m3 = GRAVITY_M_S2 * WOOD.density_kg_m3 * np.pi * LENGTH_M / (3 * (FOOT_M - TIP_M))

    def slopes(s, y):
        weight = per_m3 * (radius_at(s) ** 3 - TIP_M**3)
        bending = WOOD.young_longitudinal_pa * np.pi / 4 * radius_at(s) ** 4
        return [y[1] / bending, -(force_n * np.cos(y[0]) + weight * np.sin(y[0]))]

    def solved(foot_nm):
        return solve_ivp(slopes, (0, LENGTH_M), [0, foot_nm], rtol=1e-9, atol=1e-9, dense_output=True)

    foot = brentq(lambda m: solved(m).y[1, -1], 0, 3 * force_n * LENGTH_M)
    return solved(foot).sol(at_m)[1]


@pytest.mark.parametrize("force_n", [100.0, 1000.0, 3000.0])
def test_strain_of_a_tapered_pole_is_that_of_beam_theory(force_n):
    rods, height, radius = tapered_pole(40)
    load = np.zeros((len(height), 3))
    load[-1, 0] = force_n
    pose = bent(rods, load)
    middle = (height[1:] + height[:-1]) / 2
    strain = np.linalg.norm(pose.moment_nm[1:], axis=1) * radius[1:] / rods.bending_n_m2[1:]
    exact = exact_moments(force_n, middle) * radius[1:] / rods.bending_n_m2[1:]
    # the moment vanishes at the tip
    assert strain[:-2] == pytest.approx(exact[:-2], rel=2e-3)


def test_a_pole_bends_as_far_as_the_elastica():
    count = 60
    rods = rods_through(
        np.column_stack([np.zeros(count + 1), np.linspace(0, 5, count + 1), np.zeros(count + 1)]),
        np.arange(-1, count),
        np.full(count + 1, 0.05),
    )
    for share in (0.5, 3.0, 12.0):
        force = share * rods.bending_n_m2[0] / 25
        load = np.zeros((count + 1, 3))
        load[-1] = force * np.array([0.6, 0, 0.8])
        sway, height = elastica_tip(force, 5.0, Section(rods.bending_n_m2[0], 1e15, 1e15))
        moved = bent(rods, load).displacement_m[-1]
        assert np.hypot(moved[0], moved[2]) == pytest.approx(sway, rel=1e-3)
        assert 5 + moved[1] == pytest.approx(height, rel=1e-3)


def random_tree(seed: int, count: int = 40):
    random = np.random.default_rng(seed)
    points, parent = [np.zeros(3), np.array([0.0, 0.5, 0.0])], [-1, 0]
    for _ in range(count):
        parent.append(int(random.integers(max(1, len(points) - 8), len(points))))
        points.append(points[parent[-1]] + random.normal([0, 0.25, 0], 0.2))
    return np.array(points), np.array(parent), random


def test_small_loads_bend_a_tree_as_the_linear_frame():
    seed = 7
    print("seed", seed)
    points, parent, random = random_tree(seed)
    radius = random.uniform(0.02, 0.05, len(points))
    links = np.column_stack([parent[1:], np.arange(1, len(points))])
    frame = Frame(points, links, radius[1:], np.zeros(len(links), bool))
    load = random.normal(0, 0.01, (len(points), 3))
    stiffness = frame_matrices(frame, WOOD)[0].toarray()
    force = np.concatenate([load, np.zeros_like(load)], axis=1).ravel()
    linear = np.linalg.solve(stiffness[6:, 6:], force[6:]).reshape(-1, 6)
    pose = bent(rods_through(points, parent, radius), load)
    assert np.abs(pose.displacement_m[1:] - linear[:, :3]).max() < 0.01 * np.abs(linear[:, :3]).max()


def test_a_tree_at_rest_bears_its_weight_without_moving():
    points, parent, random = random_tree(11)
    rods = rods_through(points, parent, np.full(len(points), 0.04), random.uniform(0, 20, len(points)))
    pose = bent(rods, np.zeros_like(points))
    assert np.abs(pose.displacement_m).max() < 1e-9
    assert np.abs(pose.moment_nm).max() < 1e-6


@pytest.mark.parametrize("top_kg", [0.0, 20.0])
def test_load_factor_is_that_of_the_laden_pole(top_kg):
    count, radius, length_m = 60, 0.03, 5.0
    per_m = WOOD.density_kg_m3 * np.pi * radius**2
    weight = np.full(count + 1, per_m * length_m / count)
    weight[[0, -1]] /= 2
    weight[-1] += top_kg
    points = np.column_stack([np.zeros(count + 1), np.linspace(0, length_m, count + 1), np.zeros(count + 1)])
    rods = rods_through(points, np.arange(-1, count), np.full(count + 1, radius), GRAVITY_M_S2 * weight)
    exact = laden_pole(length_m, rods.bending_n_m2[0], per_m, top_kg).load_factor
    assert rod_buckling(rods, 4).load_factor[0] == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("load_factor", [0.2, 0.7, 1.0, 1.5])
def test_a_heavy_pole_bends_as_far_as_the_rule_of_the_weight_says(load_factor):
    """A pole of load factor ν bends 1 / (1 − ν) times as far as one without weight: here 1 / r(ν)."""
    count, radius, length_m = 40, 0.03, 5.0
    points = np.column_stack([np.zeros(count + 1), np.linspace(0, length_m, count + 1), np.zeros(count + 1)])
    weight = np.zeros(count + 1)
    weight[-1] = load_factor * np.pi**2 / 4 * WOOD.young_longitudinal_pa * np.pi / 4 * radius**4 / length_m**2
    rods = rods_through(points, np.arange(-1, count), np.full(count + 1, radius), weight)
    standing = standing_rods(rods, np.zeros(count + 1, np.int64))
    assert standing.load_factor == pytest.approx(load_factor, rel=5e-3)
    push = np.zeros_like(points)
    push[-1, 0] = 0.1
    light = replace(rods, weight_n=np.zeros(count + 1))
    farther = bent(standing.rods, push).displacement_m[-1, 0] / bent(light, push).displacement_m[-1, 0]
    # a force at the tip, P at the tip: 3 (tan u − u) / u³, u = π/2 √ν (Timoshenko and Gere, section 1.3)
    u = np.pi / 2 * np.sqrt(1 - remaining_share(load_factor))
    assert farther == pytest.approx(3 * (np.tan(u) - u) / u**3, rel=0.01)
    assert farther == pytest.approx(1 / remaining_share(load_factor), rel=0.02)


def test_a_limb_that_gives_way_alone_is_stiffened_and_the_stem_is_not():
    height = np.linspace(0, 4, 21)
    stem = np.column_stack([0 * height, height, 0 * height])
    twig = np.column_stack([0.1 * np.ones(10), 2 + np.linspace(0.1, 2, 10), np.zeros(10)])
    parent = np.concatenate([np.arange(-1, 20), [10], np.arange(21, 30)])
    radius = np.concatenate([np.full(21, 0.05), np.full(10, 0.004)])
    weight = np.zeros(31)
    weight[-1] = 5.0
    rods = rods_through(np.concatenate([stem, twig]), parent, radius, weight)
    given = float(rod_buckling(rods, 4).load_factor[0])
    assert given > 1
    standing = standing_rods(rods, np.repeat([0, 1], [21, 10]))
    raised = standing.rods.bending_n_m2 / rods.bending_n_m2
    assert np.allclose(raised[:21], 1)
    assert np.ptp(raised[21:]) < 1e-9 and raised[21] == pytest.approx(given / LARGEST_LOSS, rel=0.02)
    assert standing.load_factor <= 1.02 * LARGEST_LOSS


CELL_M, WIDTH_M, STEM_M, ARM_M, FORK_M = 0.04, 0.08, 1.2, 0.56, 0.84
"""A stem of square section with an arm of the same section, whose axis leaves it at FORK_M."""


def solid_fork():
    """Structured tetrahedra of the fork, in place of a bar."""
    wide = WIDTH_M + ARM_M
    bar = box_bar(size_m=(wide, STEM_M, WIDTH_M), cells=(16, 30, 2))
    vertices = bar.vertices_m + np.array([(wide - WIDTH_M) / 2, 0, 0])
    centre = vertices[bar.tets].mean(axis=1)
    in_stem = centre[:, 0] < WIDTH_M / 2
    kept = in_stem | (np.abs(centre[:, 1] - FORK_M) < WIDTH_M / 2)
    used, tets = np.unique(bar.tets[kept], return_inverse=True)
    vertices, tets = vertices[used], tets.reshape(-1, 4).astype(np.int32)
    return replace(
        bar,
        vertices_m=vertices,
        tets=tets,
        radius_ratio=np.ones(len(tets)),
        tet_fibre=np.where(in_stem[kept][:, None], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
        mass_kg=np.zeros(len(vertices)),
        drag_area_m2=np.zeros(len(vertices)),
        fixed=np.flatnonzero(vertices[:, 1] < 1e-9).astype(np.int32),
        tip=np.flatnonzero(vertices[:, 0] > vertices[:, 0].max() - 1e-9).astype(np.int32),
    )


def rods_of_fork():
    """The same as rods, which are bent in their plane; its points, and how many are in the stem."""
    stem = np.arange(0, STEM_M + CELL_M / 2, CELL_M)
    along = WIDTH_M / 2 + np.arange(0, ARM_M + CELL_M / 2, CELL_M)
    fork = round(FORK_M / CELL_M)
    points = np.concatenate(
        [np.column_stack([0 * stem, stem, 0 * stem]), np.column_stack([along, 0 * along + FORK_M, 0 * along])]
    )
    parent = np.arange(-1, len(points) - 1)
    parent[len(stem)] = fork
    rods = rods_through(points, parent, np.ones(len(points)))
    bending = np.full(len(points), WOOD.young_longitudinal_pa * WIDTH_M**4 / 12)
    bending[len(stem)] *= 100  # inside the stem
    return replace(rods, bending_n_m2=bending, twisting_n_m2=bending), points, len(stem)


def turn_of(rest, moved):
    """Rotation (3, 3) of a section."""
    u, _, v = np.linalg.svd((moved - moved.mean(axis=0)).T @ (rest - rest.mean(axis=0)))
    return u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v


def angle_between(first, second):
    turned = first.T @ second
    return float(np.arccos(np.clip((np.trace(turned) - 1) / 2, -1, 1)))


def test_strain_of_a_fork_is_that_of_quadratic_elements():
    solid = solid_fork()
    model = unloaded_model(solid, solid, WOOD, solid, FemSettings(element="quadratic", gravity=False)).model
    top = np.flatnonzero(solid.vertices_m[:, 1] > STEM_M - 1e-9)
    at_tip, at_top = np.array([0.0, -2500.0, 0.0]), np.array([1500.0, 0.0, 0.0])
    load = np.zeros_like(model.nodes_m)
    load[solid.tip] = at_tip / len(solid.tip)
    load[top] += at_top / len(top)
    moved, _, converged = solve_static(model.system(), load)
    assert converged
    place = model.nodes_m + moved

    rods, points, arm = rods_of_fork()
    on_rods = np.zeros_like(points)
    on_rods[-1], on_rods[arm - 1] = at_tip, at_top
    pose = bent(rods, on_rods)

    def between(axis, low, high, near):
        """Angle between two sections, which is the strain between them over half the width."""
        turns = []
        for at in (low, high):
            own = (np.abs(model.nodes_m[:, axis] - at) < 1e-9) & near(model.nodes_m)
            turns.append(turn_of(model.nodes_m[own], place[own]))
        found = [int(np.argmin(np.abs(points - at).sum(axis=1))) for at in ends(axis, low, high)]
        return angle_between(*turns), angle_between(pose.turns[found[0]], pose.turns[found[1]])

    def ends(axis, low, high):
        return ([0, low, 0], [0, high, 0]) if axis == 1 else ([low, FORK_M, 0], [high, FORK_M, 0])

    stem = between(1, 0.2, 0.6, lambda nodes: nodes[:, 0] < WIDTH_M / 2 + 1e-9)
    branch = between(0, 0.16, 0.48, lambda nodes: np.abs(nodes[:, 1] - FORK_M) < WIDTH_M / 2 + 1e-9)
    for solid_angle, rod_angle in (stem, branch):
        assert solid_angle > 0.005
        assert rod_angle == pytest.approx(solid_angle, rel=0.03)
