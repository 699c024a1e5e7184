"""Checks of the motion: ring-down frequency and damping, energy in still air."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from galewood.check.verify.bars import polygon_bar
from galewood.check.verify.checks import Check, absolute, relative
from galewood.motion.wind import dynamic_pressure
from galewood.solid.fem import (
    FemModel,
    FemSettings,
    Scheme,
    Simulator,
    effective_damping_ratio,
    natural_modes,
)
from galewood.solid.model import build_model
from galewood.util import Floats
from galewood.wood import wood_of_species

PLATE_WOOD = wood_of_species("poplar")
SCHEMES: tuple[tuple[Scheme, str], ...] = (("tr-bdf2", "TR-BDF2"), ("backward-euler", "backward Euler"))

POLE_LENGTH_M, POLE_RADIUS_M, POLE_TIP_RADIUS_M = 8.0, 0.09, 0.03
CROWN_FROM_M, CROWN_MASS_KG = 4.0, 25.0
"""Of the laden pole: the crown hangs evenly above a height."""
PLATE_M2, PLATE_MODES, PLATE_S = 20.0, 24, 6.0
PLATE_START_M, PLATE_WIND_M_S = 0.03, 0.2
FREQUENCY_LIMITS: dict[Scheme, float] = {"tr-bdf2": 0.003, "backward-euler": 0.02}
"""Backward Euler lowers the frequency of a mode by about (ω Δt)²/4, here 1 %."""


def checks() -> Iterator[Check]:
    """All checks of this module."""
    model = loaded_pole()
    yield from ring_downs(model)
    yield absolute(
        "energy in still air: largest rise in a step over the first", energy_rise(model, 120), 1e-6
    )
    crown = with_crown_area(model)
    yield absolute(
        "energy in still air, with drag: largest rise in a step over the first", energy_rise(crown, 120), 1e-6
    )
    found, exact = plate_on_a_spring(dt_s=1 / 240)
    worst = float(np.abs(found - exact).max() / np.abs(exact).max())
    yield absolute("plate on a spring in wind, drag from relative velocity: largest error", worst, 1e-3)
    peak = sixth_peak(model)
    yield relative("free decay from 20 % sway: sixth peak over that of converged steps", 1.0, peak, "–", 0.01)


def ring_downs(model: FemModel) -> Iterator[Check]:
    """Frequency and damping of a pole's free vibration by each scheme, against eigenvalue and wood."""
    frequency = float(model.report["frequencies_hz"][0])
    for scheme, label in SCHEMES:
        settings = replace(model.settings, scheme=scheme)
        found_hz, ratio = ring_down(replace(model, settings=settings), 0)
        yield relative(f"ring-down frequency, {label}", frequency, found_hz, "Hz", FREQUENCY_LIMITS[scheme])
        expected = effective_damping_ratio(settings, 2 * np.pi * frequency, PLATE_WOOD.damping_ratio)
        if scheme == "tr-bdf2":
            yield relative(
                f"ring-down damping against the wood's, {label}", PLATE_WOOD.damping_ratio, ratio, "–", 0.005
            )
        else:
            note = f"of it {PLATE_WOOD.damping_ratio:g} the wood's"
            yield relative(f"ring-down damping against theory, {label}", expected, ratio, "–", 0.0005, note)


def loaded_pole() -> FemModel:
    """A tapered pole of fast elements under gravity, with the mass of a crown on its upper half."""
    bar = polygon_bar(
        sides=6, radius_m=POLE_RADIUS_M, length_m=POLE_LENGTH_M, layers=50, tip_radius_m=POLE_TIP_RADIUS_M
    )
    crown = bar.vertices_m[:, 1] > CROWN_FROM_M
    laden = replace(bar, mass_kg=np.where(crown, CROWN_MASS_KG / crown.sum(), 0.0))
    return build_model(laden, laden, PLATE_WOOD, laden, FemSettings())


def with_crown_area(model: FemModel) -> FemModel:
    """The pole with 2 m² of drag area on its crown, and six times as much exposed to the air inside it."""
    crown = model.nodes_m[:, 1] > CROWN_FROM_M
    area = np.where(crown, 2.0 / crown.sum(), 0.0)
    return replace(model, drag_area_m2=area, exposed_area_m2=6 * area)


def plate_on_a_spring(dt_s: float) -> tuple[Floats, Floats]:
    """Displacement (T,) m of a plate at the top of a pole, by the simulator and exactly.

    The pole is released from its first mode, in a light wind that stops after half of the time. It moves so
    little that it is linear: ë + α ė + ω² e = φ A p(U − φ ė) in its natural modes, which an adaptive
    Runge–Kutta method of eighth order solves. The plate is as fast as the wind.
    """
    pole = loaded_pole()
    top = int(pole.nodes_m[:, 1].argmax())
    area = np.where(np.arange(len(pole.nodes_m)) == top, PLATE_M2, 0.0)
    settings = replace(pole.settings, dt_s=dt_s, substeps=1)
    model = replace(pole, drag_area_m2=area, alpha=0.05, beta=0.0, settings=settings)
    modes = natural_modes(model, PLATE_MODES)
    start_m = modes.shapes[0] * PLATE_START_M / modes.shapes[0, top, 0]
    winds_m_s = np.where(np.arange(round(PLATE_S / dt_s)) * dt_s < PLATE_S / 2, PLATE_WIND_M_S, 0.0)
    simulator = Simulator(model)
    simulator.displace(start_m)
    found = np.empty(len(winds_m_s))
    for k, wind in enumerate(winds_m_s):
        simulator.step(np.array([dynamic_pressure(wind, model.streamlined_exponent), 0.0]))
        found[k] = simulator.u[top, 0]
    shape = modes.shapes[:, top]
    first = np.zeros(PLATE_MODES)
    first[0] = PLATE_START_M / shape[0, 0]
    return found, _plate_exactly(2 * np.pi * modes.frequencies_hz, shape, first, model.alpha, winds_m_s, dt_s)


def _plate_exactly(
    omega: Floats, shape: Floats, first: Floats, alpha: float, winds_m_s: Floats, dt_s: float
) -> Floats:
    """(T,) displacement of the plate, whose shape (k, 3) in the modes starts with their coordinates (k,)."""
    count = len(omega)

    def rate(_: float, state: Floats, wind_m_s: float) -> Floats:
        relative = np.array([wind_m_s, 0.0, 0.0]) - state[count:] @ shape
        force = shape @ (PLATE_M2 * 0.6 * np.linalg.norm(relative) * relative)
        return np.concatenate([state[count:], force - alpha * state[count:] - omega**2 * state[:count]])

    state, place = np.concatenate([first, np.zeros(count)]), np.empty(len(winds_m_s))
    half = len(winds_m_s) // 2
    for part, wind_m_s in ((slice(0, half), winds_m_s[0]), (slice(half, None), winds_m_s[-1])):
        times = dt_s * np.arange(1, len(place[part]) + 1)
        solved = solve_ivp(
            rate, (0.0, times[-1]), state, "DOP853", times, args=(wind_m_s,), rtol=1e-10, atol=1e-12
        )
        place[part], state = solved.y[:count].T @ shape[:, 0], solved.y[:, -1]
    return place


def sixth_peak(model: FemModel, sway_share: float = 0.2) -> float:
    """Sixth peak of a free decay from a steady wind's sway, over that of steps a sixteenth as long."""
    start_m = _pulled(with_crown_area(model), sway_share)
    fine = replace(model, settings=replace(model.settings, substeps=16 * max(model.settings.substeps, 1)))
    return _sixth_peak_m(model, start_m) / _sixth_peak_m(fine, start_m)


def _pulled(model: FemModel, sway_share: float) -> Floats:
    """(N, 3) m: the pose in a steady wind that bends the tree by this share of its height."""
    simulator = Simulator(replace(model, alpha=8.0))
    height_m, pressure_pa = float(np.ptp(model.nodes_m[:, 1])), 5.0
    for _ in range(12):
        simulator.reset()
        for k in range(150):
            simulator.step(np.array([pressure_pa, 0.0]) * min(1.0, k / 60))
        share = float(np.abs(simulator.u).max()) / height_m
        if abs(share / sway_share - 1) < 0.02:
            break
        pressure_pa *= sway_share / share
    return simulator.u


def _sixth_peak_m(model: FemModel, start_m: Floats) -> float:
    still = Simulator(replace(model, drag_area_m2=np.zeros(len(model.nodes_m)), exposed_area_m2=None))
    still.displace(start_m)
    top = int(np.abs(start_m[:, 0]).argmax())
    period_s = 1 / float(model.report["frequencies_hz"][0])
    path = np.empty(round(6.6 * period_s / model.settings.dt_s))
    for k in range(len(path)):
        path[k] = still.u[top, 0]
        still.step(np.zeros(2))
    return float(np.abs(path[round(5.5 * period_s / model.settings.dt_s) :]).max())


def ring_down(model: FemModel, mode: int, amplitude_m: float = 0.02) -> tuple[float, float]:
    """Frequency (Hz) and damping ratio of the free vibration that starts in the shape of a mode.

    The modal coordinate of about eight periods is fitted by q(k+2) = a q(k+1) + b q(k); a and b (least
    squares) give the pair of poles.
    """
    modes = natural_modes(model, mode + 1)
    shape = modes.shapes[mode]
    simulator = Simulator(model)
    simulator.displace(shape * amplitude_m / float(np.abs(shape).max()))
    weighted = model.mass_kg[: model.vertex_count, None] * shape[: model.vertex_count]
    frames = round(8 / float(modes.frequencies_hz[mode]) / model.settings.dt_s)
    q = np.empty(frames)
    for k in range(frames):
        q[k] = np.vdot(weighted, simulator.u)
        simulator.step(np.zeros(2))
    history = np.column_stack([q[1:-1], q[:-2]])
    (a, b), *_ = np.linalg.lstsq(history, q[2:])
    pole = np.log(np.roots([1.0, -a, -b])[0].astype(complex)) / model.settings.dt_s
    return float(abs(pole) / (2 * np.pi)), float(-pole.real / abs(pole))


def energy_rise(model: FemModel, frames: int) -> float:
    """Largest rise of the mechanical energy between frames in still air, over the initial energy."""
    simulator = Simulator(model)
    shape = natural_modes(model, 1).shapes[0]
    simulator.displace(shape * 0.2 / float(np.abs(shape).max()))
    rest = _potential(model, np.zeros_like(model.nodes_m))
    energy = np.empty(frames)
    for k in range(frames):
        moving = 0.5 * float(np.einsum("n,ni->", model.mass_kg, simulator.v**2))
        energy[k] = _potential(model, simulator.u) - rest + moving
        simulator.step(np.zeros(2))
    return float(max(np.diff(energy).max(), 0.0) / energy[0])


def _potential(model: FemModel, u: Floats) -> float:
    """Elastic and gravitational energy of linear elements, J; rotations by singular value decomposition."""
    local = u[model.elements]
    gradient = np.eye(3) + np.einsum("eai,eaj->eij", local, model.grad)
    left, _, right = np.linalg.svd(gradient)
    rotation = left @ right
    rest = model.nodes_m[model.elements]
    away = np.einsum("eji,eaj->eai", rotation, rest + local) - rest
    away -= away[:, :1]
    away += 0.0 if model.strain_m is None else model.strain_m
    energy = 0.0
    pair = 0
    for a in range(4):
        for b in range(a, 4):
            term = np.einsum("ei,eij,ej->", away[:, a], model.blocks[:, pair], away[:, b])
            energy += float(term) / (2 if a == b else 1)
            pair += 1
    return energy - float(np.vdot(model.gravity_n, u))
