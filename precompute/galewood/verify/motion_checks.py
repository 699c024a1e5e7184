"""Checks of the motion: ring-down frequency and damping, energy in still air."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from galewood.fem import FemModel, FemSettings, Scheme, Simulator, natural_modes, shown_ratio
from galewood.model import build_model
from galewood.util import Floats
from galewood.verify.bars import polygon_bar
from galewood.verify.checks import Check, absolute, relative
from galewood.wood import wood_of_species

WOOD = wood_of_species("poplar")
SCHEMES: tuple[tuple[Scheme, str], ...] = (("tr-bdf2", "TR-BDF2"), ("backward-euler", "backward Euler"))

FREQUENCY_LIMITS: dict[Scheme, float] = {"tr-bdf2": 0.003, "backward-euler": 0.02}
"""Backward Euler lowers the frequency of a mode by about (ω Δt)²/4, here 1 %."""


def checks() -> Iterator[Check]:
    """All checks of this module."""
    model = laden_pole()
    frequency = float(model.report["frequencies_hz"][0])
    for scheme, label in SCHEMES:
        settings = replace(model.settings, scheme=scheme)
        found_hz, ratio = ring_down(replace(model, settings=settings), 0)
        yield relative(f"ring-down frequency, {label}", frequency, found_hz, "Hz", FREQUENCY_LIMITS[scheme])
        expected = shown_ratio(settings, 2 * np.pi * frequency, WOOD.damping_ratio)
        if scheme == "tr-bdf2":
            yield relative(
                f"ring-down damping against the wood's, {label}", WOOD.damping_ratio, ratio, "–", 0.005
            )
        else:
            note = f"of it {WOOD.damping_ratio:g} the wood's"
            yield relative(f"ring-down damping against theory, {label}", expected, ratio, "–", 0.0005, note)
    yield absolute(
        "energy in still air: largest rise in a step over the first", energy_rise(model, 120), 1e-6
    )


def laden_pole() -> FemModel:
    """A tapered pole of fast elements under gravity, with the mass of a crown on its upper half."""
    bar = polygon_bar(sides=6, radius_m=0.09, length_m=8.0, layers=50, tip_radius_m=0.03)
    crown = bar.vertices_m[:, 1] > 4.0
    laden = replace(bar, mass_kg=np.where(crown, 25.0 / crown.sum(), 0.0))
    return build_model(laden, laden, WOOD, laden, FemSettings())


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
    total = model.u_rest + u
    local = total[model.elements]
    gradient = np.eye(3) + np.einsum("eai,eaj->eij", local, model.grad)
    left, _, right = np.linalg.svd(gradient)
    rotation = left @ right
    rest = model.nodes_m[model.elements]
    away = np.einsum("eji,eaj->eai", rotation, rest + local) - rest
    away -= away[:, :1]
    energy = 0.0
    pair = 0
    for a in range(4):
        for b in range(a, 4):
            term = np.einsum("ei,eij,ej->", away[:, a], model.blocks[:, pair], away[:, b])
            energy += float(term) / (2 if a == b else 1)
            pair += 1
    return energy - float(np.vdot(model.gravity_n, total))
