"""The oscillators of the drift-free method: what a tree does in a light wind, in few coordinates.

Natural modes of the finite-element model are many and close together; the wind pushes only along two given
fields. So the responses of many natural modes to the sampled winds are reduced by proper orthogonal
decomposition, and the model projected on the result and made diagonal again (Ritz).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from galewood.fem import FemModel, FemSettings, natural_modes
from galewood.util import Floats

NATURAL_MODES = 120
TRAPEZIUM = 1 - np.sqrt(0.5)
"""TR-BDF2's implicit coefficient."""


@dataclass(frozen=True)
class Oscillators:
    """Mass-normalised modes of a body about rest: ë + C ė + ω² e = load p, u = Σ e_k shape_k."""

    omega: Floats  # (k,) 1/s
    damping: Floats  # (k, k) 1/s
    shapes: Floats  # (k, 3n) 1/√kg
    load: Floats  # (k, 2) modal force per Pa


def oscillators_of(model: FemModel, count: int = NATURAL_MODES) -> Oscillators:
    """The first natural modes of a finite-element model, damped by α and by β on the elements' tangent."""
    free = 3 * (len(model.nodes_m) - len(model.fixed))
    modes = natural_modes(model, min(count, free // 2))
    shapes = modes.shapes
    damping = model.alpha * np.eye(len(shapes)) + model.beta * _elastic(model, shapes)
    load = np.einsum("kni,n->ki", shapes[:, :, [0, 2]], model.drag_area_m2)
    seen = shapes[:, : model.vertex_count].reshape(len(shapes), -1)
    return Oscillators(2 * np.pi * modes.frequencies_hz, damping, seen, load)


def first_of(body: Oscillators, count: int) -> Oscillators:
    """The same with its first ``count`` modes alone."""
    return Oscillators(
        body.omega[:count], body.damping[:count, :count], body.shapes[:count], body.load[:count]
    )


def _elastic(model: FemModel, shapes: Floats) -> Floats:
    """(k,k) elements' tangent at rest between shapes (k,N,3), as β sees it: without the weight's share."""
    system = model.system()
    u, nothing = model.u_rest[system.order], np.zeros(len(model.nodes_m))
    still = np.zeros_like(u)
    system.assemble(u, still, 1.0, nothing, np.zeros_like(u))
    inner = shapes[:, system.order[: system.free]].reshape(len(shapes), -1)
    return np.asarray(inner @ (system.solver.to_scipy(system.values) @ inner.T))


def propagators(omega: Floats, damping: Floats, settings: FemSettings) -> Floats:
    """(k,6) one step of the finite elements' scheme for each oscillator: r00, r01, r10, r11, s0, s1."""
    h, eye = settings.dt_s / settings.substeps, np.eye(2)
    rows = np.empty((len(omega), 6))
    for k, (w, c) in enumerate(zip(omega, damping, strict=True)):
        rate = np.array([[0.0, 1.0], [-w * w, -c]])
        if settings.scheme == "backward-euler":
            once = np.linalg.inv(eye - h * rate)
        else:
            stage = np.linalg.inv(eye - TRAPEZIUM * h * rate)
            once = stage @ stage @ (eye + (1 - 2 * TRAPEZIUM) * h * rate)
        step = np.linalg.matrix_power(once, settings.substeps)
        rows[k] = *step.ravel(), *((step - eye) @ np.linalg.inv(rate) @ np.array([0.0, 1.0]))
    return rows


def response(step: Floats, force: Floats) -> Floats:
    """(T + 1, m) motion from rest of one oscillator (6,) under forces (T, m), each held through its step."""
    r00, r01, r10, r11, s0, s1 = step
    poles = [1.0, -(r00 + r11), r00 * r11 - r01 * r10]
    moved = lfilter([s0, r01 * s1 - r11 * s0], poles, force, axis=0)
    return np.concatenate([np.zeros((1, force.shape[1])), moved])


def reduced(body: Oscillators, winds: Sequence[Floats], settings: FemSettings, dynamic: int) -> Oscillators:
    """The ``dynamic`` Ritz oscillators that follow the body best, in metres, under the winds (T, 2).

    Those that move the tree most stand first.
    """
    dynamic = min(dynamic, len(body.omega))
    step = propagators(body.omega, np.diag(body.damping), settings)
    motion = np.concatenate([_light_motion(body, step, wind) for wind in winds])
    root = np.linalg.cholesky(body.shapes @ body.shapes.T)
    _, vectors = np.linalg.eigh(root.T @ (motion.T @ motion) @ root)
    kept, _ = np.linalg.qr(np.linalg.solve(root.T, vectors[:, ::-1][:, :dynamic]))
    squared, turn = np.linalg.eigh(kept.T @ (body.omega[:, None] ** 2 * kept))
    mix = (kept @ turn).T
    far = np.sqrt(((mix @ body.shapes).reshape(dynamic, -1, 3) ** 2).sum(axis=2).max(axis=1))
    order = np.argsort(-far * np.sqrt(((motion @ mix.T) ** 2).mean(axis=0)), kind="stable")
    squared, mix = squared[order], mix[order]
    mix *= np.sign(mix[np.arange(dynamic), np.argmax(np.abs(mix), axis=1)])[:, None]
    return Oscillators(np.sqrt(squared), mix @ body.damping @ mix.T, mix @ body.shapes, mix @ body.load)


def _light_motion(body: Oscillators, step: Floats, wind: Floats) -> Floats:
    """(T / 3, k) every third frame of the oscillators' motion under a wind (T, 2)."""
    moved = [response(step[k], (wind @ body.load[k])[:, None])[::3] for k in range(len(body.omega))]
    return np.concatenate(moved, axis=1)
