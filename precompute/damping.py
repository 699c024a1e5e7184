"""What damping a tree shows: Rayleigh's two coefficients and what the time step adds."""

import numpy as np

from precompute.model import FemSettings


def rayleigh(ratio: float, first_hz: float, first_elastic: float, frequency_ratio: float) -> tuple[float, float]:
    """α (1/s) and β (s) that give the damping ratio at the first frequency and at a multiple of it.

    `first_elastic` (1/s²) is the first mode's quotient with the elements' tangent: β acts on that, and it is more than
    ω² where the weight softens the sway.
    """
    first = 2 * np.pi * first_hz
    second = frequency_ratio * first
    beta = 2 * ratio * (second - first) / max(second**2 - first_elastic, 1e-3 * second**2)
    beta = min(beta, 2 * ratio * first / first_elastic)
    return 2 * ratio * first - beta * first_elastic, beta


def rayleigh_ratio(alpha: float, beta: float, omega: float, elastic: float | None = None) -> float:
    """Damping ratio of a mode of angular frequency omega, 1/s; `elastic` as above (omega² if not given)."""
    return (alpha + beta * (omega**2 if elastic is None else elastic)) / (2 * omega)


def shown_ratio(settings: FemSettings, omega: float, ratio: float) -> float:
    """Damping ratio that the time-stepping scheme shows for a linear mode of this ratio and angular frequency, 1/s."""
    z = settings.dt_s / settings.substeps * omega * complex(-ratio, np.sqrt(1 - ratio**2))
    if settings.scheme == "backward-euler":
        growth = 1 / (1 - z)
    else:
        d = 1 - np.sqrt(0.5)
        growth = (1 + (1 - 2 * d) * z) / (1 - d * z) ** 2
    exponent = np.log(growth)
    return float(-exponent.real / abs(exponent))


def damping_report(
    settings: FemSettings, alpha: float, beta: float, first_hz: float, first_elastic: float, target: float
) -> dict[str, float]:
    """Damping ratio of the first mode: as given, by Rayleigh, by the time step, and as shown (both together)."""
    omega = 2 * np.pi * first_hz
    by_rayleigh = rayleigh_ratio(alpha, beta, omega, first_elastic)
    return {
        "target": target,
        "rayleigh": by_rayleigh,
        "numerical": shown_ratio(settings, omega, 0.0),
        "shown": shown_ratio(settings, omega, by_rayleigh),
    }
