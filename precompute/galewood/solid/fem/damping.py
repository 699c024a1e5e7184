"""Rayleigh damping coefficients, and the numerical damping added by time integration."""

import numpy as np

from galewood.solid.fem.model import FemSettings


def rayleigh(ratio: float, first_hz: float, frequency_ratio: float) -> tuple[float, float]:
    """α (1/s) and β (s) that give the damping ratio at the first frequency (Hz) and at a multiple of it."""
    first = 2 * np.pi * first_hz
    second = frequency_ratio * first
    return 2 * ratio * first * second / (first + second), 2 * ratio / (first + second)


def rayleigh_ratio(alpha: float, beta: float, omega: float) -> float:
    """Damping ratio of a mode of angular frequency omega, 1/s."""
    return alpha / (2 * omega) + beta * omega / 2


def effective_damping_ratio(settings: FemSettings, omega: float, ratio: float) -> float:
    """Effective damping ratio, including the time-stepping scheme, of a linear mode.

    `omega` is its angular frequency, 1/s, and `ratio` its physical damping ratio.
    """
    z = settings.dt_s / max(settings.substeps, 1) * omega * complex(-ratio, np.sqrt(1 - ratio**2))
    if settings.scheme == "backward-euler":
        growth = 1 / (1 - z)
    else:
        d = 1 - np.sqrt(0.5)
        growth = (1 + (1 - 2 * d) * z) / (1 - d * z) ** 2
    exponent = np.log(growth)
    return float(-exponent.real / abs(exponent))


def damping_report(
    settings: FemSettings, alpha: float, beta: float, first_hz: float, target: float
) -> dict[str, float]:
    """Damping ratio of the first mode: specified, by Rayleigh, by time integration, and effective."""
    omega = 2 * np.pi * first_hz
    by_rayleigh = rayleigh_ratio(alpha, beta, omega)
    return {
        "target": target,
        "rayleigh": by_rayleigh,
        "numerical": effective_damping_ratio(settings, omega, 0.0),
        "shown": effective_damping_ratio(settings, omega, by_rayleigh),
    }
