"""Strain of swaying rods: steady wind, the exact vibrating beam, and finite elements in the same gusts."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import galewood
import numpy as np
import pytest
from galewood.check.verify.bars import polygon_bar
from galewood.io.cli.commands import app
from galewood.motion.wind import PRESETS, Wind, WindState, dynamic_pressure
from galewood.motion.wind.document import Wave
from galewood.packaged import species_folder
from galewood.pipeline.results import SHIPPED_FOLDER, read_shipped
from galewood.pipeline.stages import builtin_meshes
from galewood.solid.beams import Rods, rod_modes
from galewood.solid.beams.bending import bent
from galewood.solid.fem import FemModel, FemSettings, Place, Simulator, node_pressures, rayleigh, solve_static
from galewood.solid.model import GRAVITY_M_S2, build_model
from galewood.solid.strain import WindRods, strain_in_gusts, strain_in_wind, with_top_speed
from galewood.util import Floats
from galewood.wood import wood_of_species
from typer.testing import CliRunner

from tests.precompute.fixtures.cylinder_models import simpleforest, y_model

WOOD = wood_of_species("ash")
SEED = 3


def pole_rods(height_m: Floats, radius_m: Floats, mass_kg: Floats, area_m2: Any) -> WindRods:
    """A straight pole through points at these heights, with the radius of each rod; areas in any wind."""
    count = len(height_m)
    points = np.column_stack([0 * height_m, height_m, 0 * height_m])
    parent, second = np.arange(-1, count - 1), np.pi / 4 * radius_m**4
    clamped = np.zeros(count, np.int64)
    clamped[0] = 1
    rods = Rods(
        parent, points - points[np.maximum(parent, 0)], WOOD.young_longitudinal_pa * second,
        2 * WOOD.shear_longitudinal_pa * second, clamped, GRAVITY_M_S2 * mass_kg,
    )  # fmt: skip
    inside, none = np.zeros(count, bool), np.zeros(count)
    inside[0] = True
    return WindRods(
        rods, points, radius_m, np.zeros(count, np.int64), inside, area_m2, none, none, area_m2,
        np.ones(count), 2.0, WOOD, 0.0, 1.0,
    )  # fmt: skip


LENGTH_M, RADIUS_M = 6.0, 0.12


def uniform_pole(count: int = 60) -> WindRods:
    """A stout pole whose weight does not matter, with wind on its top."""
    height = np.linspace(0, LENGTH_M, count + 1)
    mass = np.full(count + 1, WOOD.density_kg_m3 * np.pi * RADIUS_M**2 * LENGTH_M / count)
    mass[[0, -1]] /= 2
    area = np.zeros(count + 1)
    area[-1] = 1e-4
    return pole_rods(height, np.full(count + 1, RADIUS_M), mass, area)


def first_hz(rods: WindRods) -> float:
    still = np.zeros_like(rods.points_m)
    mass = rods.rods.weight_n / GRAVITY_M_S2
    return float(rod_modes(rods.rods, still, bent(rods.rods, still), mass, 4).frequencies_hz[0])


def test_modes_of_a_pole_are_those_of_beam_theory() -> None:
    light = uniform_pole()
    still, mass = np.zeros_like(light.points_m), light.rods.weight_n / GRAVITY_M_S2
    rods = replace(light.rods, weight_n=1e-6 * light.rods.weight_n)
    found = rod_modes(rods, still, bent(rods, still), mass, 6)
    np.testing.assert_allclose(found.frequencies_hz[::2], EXACT_HZ, rtol=4e-3)
    np.testing.assert_allclose(found.frequencies_hz[1::2], EXACT_HZ, rtol=4e-3)
    moving = np.einsum("kni,n,lni->kl", found.shapes, mass, found.shapes)
    np.testing.assert_allclose(moving, np.eye(6), atol=1e-4)


SPEED_M2_S = RADIUS_M / 2 * np.sqrt(WOOD.young_longitudinal_pa / WOOD.density_kg_m3)
EXACT_HZ = np.array([1.8751041, 4.6940911, 7.8547574]) ** 2 * SPEED_M2_S / (2 * np.pi * LENGTH_M**2)


def exact_amplification(ratio: float, at_m: float) -> float:
    """Moment at a height under a force at the tip, over the static one: damped Euler–Bernoulli beam.

    ``ratio`` is the frequency of the force over the first one.
    E I (1 + i ω β) w'''' = m ω² (1 − i α / ω) w, clamped at the foot; no moment and a unit force at the tip.
    """
    omega = 2 * np.pi * ratio * EXACT_HZ[0]
    alpha, beta = rayleigh(WOOD.damping_ratio, float(EXACT_HZ[0]), 3.0)
    bending = WOOD.young_longitudinal_pa * np.pi / 4 * RADIUS_M**4 * (1 + 1j * omega * beta)
    per_m = WOOD.density_kg_m3 * np.pi * RADIUS_M**2 * (1 - 1j * alpha / omega)
    k = (per_m * omega**2 / bending) ** 0.25
    powers = k * np.array([1, 1j, -1, -1j])
    rows = [powers**0, powers, powers**2 * np.exp(powers * LENGTH_M), powers**3 * np.exp(powers * LENGTH_M)]
    share = np.linalg.solve(np.array(rows), np.array([0, 0, 0, 1 / bending]))
    # the strain is that of the elastic moment, without the damping of the wood
    curvature = complex((share * powers**2 * np.exp(powers * at_m)).sum())
    return abs(curvature) * bending.real / (LENGTH_M - at_m)


@pytest.mark.parametrize("ratio", [0.3, 0.6, 0.85, 1.2])
def test_a_harmonic_force_strains_a_pole_as_the_exact_vibrating_beam(ratio: float) -> None:
    """The weight lowers the pole's frequency by 0.3 %, so frequencies are relative to the first one."""
    rods = uniform_pole()
    frequency = ratio * first_hz(rods)
    calm: dict[str, Any] = {"direction_deg": 0.0, "heading_swing_deg": 0.0, "height_exponent": 0.0}
    wind = Wind(mean_speed_m_s=10.0, gustiness=0.1, waves=(Wave(frequency, 1.0, 0.0, 0.0),), **calm)
    found = strain_in_gusts(rods, wind, 20.0)
    assert found.breast_height_strain is not None
    turned = 2 * np.pi * frequency * found.time_s
    columns = np.column_stack(
        [np.ones_like(turned), *(f(n * turned) for n in (1, 2) for f in (np.cos, np.sin))]
    )
    fitted = np.linalg.lstsq(columns, found.breast_height_strain)[0]
    force = 0.6 * 10**2 * rods.drag_area_m2[-1] * 2 * 0.1
    still = force * (LENGTH_M - 1.3) * RADIUS_M / rods.rods.bending_n_m2[0]
    amplification = float(np.hypot(*fitted[1:3])) / still
    print(ratio, amplification / exact_amplification(ratio, 1.3))
    assert amplification == pytest.approx(exact_amplification(ratio, 1.3), rel=0.02)


def crown_pole() -> tuple[WindRods, FemModel]:
    """A stem with a crown on its upper half, as rods and as finite elements."""
    bar = polygon_bar(sides=6, radius_m=0.09, length_m=8.0, layers=24, tip_radius_m=0.03)
    crown = bar.vertices_m[:, 1] > 4.0
    share = np.where(crown, 1.0 / crown.sum(), 0.0)
    laden = replace(bar, mass_kg=25.0 * share)
    model = replace(build_model(laden, laden, WOOD, laden, FemSettings()), drag_area_m2=3.0 * share)
    height = np.linspace(0, 8.0, 49)
    middle = np.concatenate([[0.0], (height[1:] + height[:-1]) / 2])
    corner = 0.09 + (0.03 - 0.09) * middle / 8
    area = 1.5 * np.sqrt(3) * corner**2
    # a circle with the second moment of the hexagon
    radius = (5 * np.sqrt(3) / 16 * corner**4 * 4 / np.pi) ** 0.25
    mass = np.zeros(49)
    piece = WOOD.density_kg_m3 * area[1:] * 8 / 48
    mass[1:] += piece / 2
    mass[:-1] += piece / 2
    above = np.bincount(np.rint(bar.vertices_m[:, 1] * 6).astype(int), share, 49)
    return pole_rods(height, radius, mass + 25.0 * above, 3.0 * above), model


def test_constant_wind_gives_the_steady_strain() -> None:
    rods, _ = crown_pole()
    wind = Wind(mean_speed_m_s=9.0, direction_deg=20.0, gustiness=0.0)
    found = strain_in_gusts(rods, wind, 10.0)
    expected = strain_in_wind(rods, found.mean_m_s, 20.0)[0]
    assert found.breast_height_strain is not None
    assert found.breast_height_strain == pytest.approx(expected.breast_height_strain, rel=1e-4)
    np.testing.assert_allclose(found.strain[-1], expected.strain, rtol=1e-4, atol=1e-9)
    assert found.rms.max() < 1e-4 * expected.strain.max()
    peak = found.peak()
    assert peak is not None and peak.over_mean == pytest.approx(1, rel=1e-4)
    assert peak.over_gust == pytest.approx(1, rel=1e-4)


def test_gusts_strain_rods_as_finite_elements() -> None:
    """The turn between two sections of the stem, in the same gusts; a fifth of the height of sway."""
    rods, model = crown_pole()
    wind = replace(
        with_top_speed(PRESETS["autumn-gusts"], 8.0, 6.0), seed=SEED, direction_deg=0.0, gustiness=0.8
    )
    print(f"seed {SEED}")
    found = strain_in_gusts(rods, wind, 40.0)
    assert found.breast_height_strain is not None
    simulator, frames = Simulator(model), 60 * 30
    low, high = (np.flatnonzero(np.abs(model.nodes_m[:, 1] - y) < 1e-6) for y in (1.0, 5.0 / 3))
    curvature = np.empty(frames)
    winds = node_pressures(model, WindState(wind, wind), Place(), frames, height_m=8.0, most_pa=np.inf)
    for k, pressure in enumerate(winds):
        simulator.step(pressure.node_pa)
        angles = [_lean(model.nodes_m[at], model.nodes_m[at] + simulator.u[at]) for at in (low, high)]
        curvature[k] = (angles[1] - angles[0]) / (2 / 3)
    radius = float(np.interp(4 / 3, rods.points_m[:, 1], rods.radius_m))
    elements = np.interp(found.time_s + 20.0, np.arange(1, frames + 1) / 30, radius * curvature)
    own = found.breast_height_strain
    error = own * elements.mean() / own.mean() - elements
    print(own.mean() / elements.mean(), own.std() / elements.std(), own.max() / elements.max())
    assert own.mean() == pytest.approx(elements.mean(), rel=0.05)
    assert own.std() == pytest.approx(elements.std(), rel=0.05)
    assert own.max() == pytest.approx(elements.max(), rel=0.05)
    assert np.sqrt((error**2).mean()) < 0.15 * elements.std()


def test_a_built_in_tree_answers_gusts_as_its_finite_elements(tmp_path: Path) -> None:
    """Maple in a forest, in leaf: the curvature of the stem at 1.3 m, over that in the steady mean wind."""
    mesh = {mesh.name: mesh for mesh in builtin_meshes(species_folder())}["maple-forest"]
    shipped = read_shipped(species_folder() / SHIPPED_FOLDER, mesh.name, mesh.key)
    assert shipped is not None
    shipped.keep_tetrahedra(tmp_path)
    tree = galewood.read(mesh.path, species="maple", accept=True)
    speed = 12.0
    calm = replace(PRESETS["autumn-gusts"], direction_deg=0.0, seed=SEED)
    gusts = with_top_speed(calm, tree.height_m, speed)
    found = galewood.gust_strain(tree, gusts, seconds=40.0)
    rods_still = galewood.strain(tree, wind_m_s=speed).breast_height_strain
    assert found.breast_height_strain is not None and rods_still is not None

    model = galewood.Model(tree, cache_dir=tmp_path).fem
    place = model.nodes_m[: model.vertex_count]
    axis = found.in_mean.place_m[found.in_mean.stem]
    low, high = (_slice_of(place, axis, 0.3, 1.0), _slice_of(place, axis, 1.7, 2.4))

    def curvature(u: Floats) -> float:
        return _lean(place[high], place[high] + u[high]) - _lean(place[low], place[low] + u[low])

    load = model.gravity_n.copy()
    load[:, 0] += float(dynamic_pressure(speed, model.streamlined_exponent)) * model.drag_area_m2
    bent_by_wind, _, converged = solve_static(model.system(), load)
    assert converged
    simulator, frames = Simulator(model), 60 * 30
    winds = node_pressures(
        model, WindState(gusts, gusts), Place(), frames, height_m=tree.height_m, most_pa=np.inf
    )
    elements = np.empty(frames)
    for k, pressure in enumerate(winds):
        simulator.step(pressure.node_pa)
        elements[k] = curvature(simulator.u)
    elements = np.interp(found.time_s + 20.0, np.arange(1, frames + 1) / 30, elements)
    elements /= curvature(bent_by_wind[: model.vertex_count])
    own = found.breast_height_strain / rods_still
    print(own.std() / elements.std(), own.max() / elements.max(), np.corrcoef(own, elements)[0, 1])
    assert own.std() == pytest.approx(elements.std(), rel=0.03)
    assert own.max() == pytest.approx(elements.max(), rel=0.03)
    assert np.corrcoef(own, elements)[0, 1] > 0.99


def _slice_of(place_m: Floats, axis_m: Floats, low_m: float, high_m: float) -> Any:
    """Vertices of the stem between two heights."""
    middle = axis_m[np.argmin(np.abs(axis_m[:, 1] - (low_m + high_m) / 2))]
    near = np.hypot(place_m[:, 0] - middle[0], place_m[:, 2] - middle[2]) < 0.35
    return np.flatnonzero((place_m[:, 1] > low_m) & (place_m[:, 1] < high_m) & near)


def _lean(rest: Floats, moved: Floats) -> float:
    """Angle by which a section leans towards x."""
    u, _, v = np.linalg.svd((moved - moved.mean(axis=0)).T @ (rest - rest.mean(axis=0)))
    turn = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return float(np.arctan2(turn[0, 1] - turn[1, 0], turn[0, 0] + turn[1, 1]))


@pytest.fixture
def fork(tmp_path: Path) -> Path:
    path = tmp_path / "fork.csv"
    path.write_bytes(simpleforest(y_model()))
    return path


def test_the_command_writes_figures_and_a_series(fork: Path) -> None:
    series, figures = fork.with_name("series.csv"), fork.with_name("figures.json")
    command = ["strain", str(fork), "--species", "oak", "--gusts", "--speed", "12", "--seconds", "30"]
    result = CliRunner().invoke(app, [*command, "--series", str(series), "--json", str(figures)])
    assert result.exit_code == 0, result.output
    assert "12." in result.output and "times that in the steady mean wind" in " ".join(result.output.split())
    with series.open() as file:
        rows = list(csv.DictReader(file))
    strain = np.array([float(row["strain"]) for row in rows])
    found = json.loads(figures.read_text())
    assert np.abs(strain).max() == pytest.approx(found["breast_height"]["largest"], rel=1e-4)
    assert found["gust_m_s"] > found["mean_m_s"] and found["peaks"]["stem"]["over_mean"] > 1
    assert len(galewood.read_motion(series).values) == len(rows)


def test_wrong_gusts_are_refused(fork: Path) -> None:
    runner = CliRunner()
    without = runner.invoke(app, ["strain", str(fork), "--series", str(fork.with_name("series.csv"))])
    assert without.exit_code == 2 and "--gusts" in without.output
    unknown = runner.invoke(app, ["strain", str(fork), "--wind", "tornado"])
    assert unknown.exit_code == 1 and "storm-front" in " ".join(unknown.output.split())
    tree = galewood.read(fork, species="oak")
    with pytest.raises(ValueError, match="above 0 m/s"):
        galewood.gust_strain(tree, Wind(mean_speed_m_s=0.0))
    with pytest.raises(ValueError, match="1 to 3600 s"):
        galewood.gust_strain(tree, seconds=0.0)
