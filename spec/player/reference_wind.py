"""Galewood winds in plain Python: an independent reader of spec/formats/wind.md, short rather than fast.

Steady documents of the models cosine, spectral and recorded, pressure, and gusts within a crown;
reference_noise.py has the other two models.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Callable
from typing import Any

import numpy as np

Velocity = Callable[[float, float, float], Any]
"""Velocity (x, z), m/s, at x, z (m) and t (s), at the reference height."""


def hash32(seed: Any, k: Any) -> Any:
    """Random integers 0 … 2³²−1; k may be an array of uint64."""
    h = (seed + 0x9E3779B9 * (k + 1)) & 0xFFFFFFFF
    for _ in range(2):
        h = ((h ^ (h >> 16)) * 0x045D9F3B) & 0xFFFFFFFF
    return h ^ (h >> 16)


def cosine(wind: dict[str, Any]) -> Velocity:
    """Velocity (x, z) at (x, z, t) of a cosine document."""
    table = [(0.05, 0.262, 0.6), (0.087, 0.218, -0.45), (0.152, 0.181, 0.75)]
    table += [(0.264, 0.15, -0.6), (0.46, 0.105, 0.5), (0.8, 0.084, -0.7)]
    phase = [hash32(int(wind["seed"]), k) / 2**32 for k in range(16)]
    waves = [(*wave, phase[k]) for k, wave in enumerate(table)]
    if "waves" in wind:
        waves = [
            (w["frequency_hz"], w["share"], w.get("across", 0.0), w.get("phase_turns", phase[k]))
            for k, w in enumerate(wind["waves"])
        ]
    c, g, theta = wind["convection_speed_m_s"], wind["gustiness"], math.radians(wind["direction_deg"])
    swing = math.radians(wind.get("heading_swing_deg", 12.0))

    def velocity(x: float, z: float, t: float) -> Any:
        tau = t - (x * math.cos(theta) + z * math.sin(theta)) / c
        y = (z * math.cos(theta) - x * math.sin(theta)) / c
        gusts = sum(a * math.cos(2 * math.pi * (f * (tau + b * y) + p)) for f, a, b, p in waves)
        speed = wind["mean_speed_m_s"] * max(0.0, 1 + g * gusts)
        heading = theta + g * swing * math.cos(2 * math.pi * (0.03 * (tau + y / 2) + phase[6]))
        return speed * np.array([math.cos(heading), math.sin(heading)])

    return velocity


def spectral(wind: dict[str, Any]) -> Velocity:
    """Velocity (x, z) at (x, z, t) of a spectral document."""
    kx, ky = np.arange(1024), np.arange(128)[:, None]
    n = np.where(kx <= 512, kx, 1024 - kx) * 16 / 1024
    m = np.where(ky <= 64, ky, 128 - ky) * 4 / 128
    psi = 1 / ((7 / (2 * np.pi)) ** 2 * (n * n + 0.15**2) + m * m)
    power = np.where(n > 0, (1 + 70.8 * n * n) ** (-0.5 * wind.get("beta", 5 / 3)), 0.0)
    angle = hash32(int(wind["seed"]), (ky * 1024 + kx).astype(np.uint64)) * (2 * np.pi / 2**32)
    spectrum = np.sqrt(power * psi / psi.sum(0)) * np.exp(1j * angle)
    lift = 9 / ((2 + np.cos(2 * np.pi * kx / 1024)) * (2 + np.cos(2 * np.pi * ky / 128)))
    sampled, field = np.fft.ifft2(spectrum), np.fft.ifft2(spectrum * lift)
    textures = field.real / sampled.real.std(), field.imag / sampled.imag.std()

    def gusts(xi: float, eta: float, travel: float) -> tuple[float, float]:
        along, across = 16 * xi, 4 * (eta + 0.0955 * xi)
        column, row = math.floor(along), math.floor(across)
        near = np.ix_(np.arange(row - 1, row + 3) % 128, np.arange(column - 1, column + 3) % 1024)
        a, b = (weights(across - row) @ part[near] @ weights(along - column) for part in textures)
        return a, b

    return travelling(wind, gusts, 0.5)


def recorded(wind: dict[str, Any]) -> Velocity:
    """Velocity (x, z) at (x, z, t) of a recorded document."""
    recording, theta = wind["recording"], math.radians(wind["direction_deg"])
    pairs = np.frombuffer(base64.b64decode(recording["pairs"]), "<i2").reshape(-1, 2) * recording["unit"]
    c, s, mean = math.cos(theta), math.sin(theta), wind["mean_speed_m_s"]

    def velocity(x: float, z: float, t: float) -> Any:
        p = (t - (x * c + z * s) / wind["convection_speed_m_s"]) / recording["interval_s"]
        k = math.floor(p)
        t = p - k
        w = [t * (t * (2 - t) - 1), t * t * (3 * t - 5) + 2, t * (t * (4 - 3 * t) + 1), t * t * (t - 1)]
        a, b = 0.5 * np.array(w) @ pairs[np.arange(k - 1, k + 3) % len(pairs)]
        sigma = 0.308 * wind["gustiness"] * mean
        return (mean + sigma * a) * np.array([c, s]) + sigma * b * np.array([-s, c])

    return velocity


def weights(t: float) -> Any:
    """Weights of the four cells about a position that is t behind the second, of cubic B-splines."""
    return np.array([(1 - t) ** 3, 4 - 6 * t * t + 3 * t**3, 1 + 3 * t + 3 * t * t - 3 * t**3, t**3]) / 6


def travelling(wind: dict[str, Any], gusts: Callable[[float, float, float], Any], lateral: float) -> Velocity:
    """The velocity of gusts (a, b) at (ξ, η, S); `lateral`: r."""
    theta, length = math.radians(wind["direction_deg"]), wind["length_scale_m"]
    c, s, mean = math.cos(theta), math.sin(theta), wind["mean_speed_m_s"]

    def velocity(x: float, z: float, t: float) -> Any:
        travel = wind["convection_speed_m_s"] / length * t
        a, b = gusts((x * c + z * s) / length - travel, (z * c - x * s) / length, travel)
        sigma = 0.308 * wind["gustiness"] * mean
        return (mean + sigma * a) * np.array([c, s]) + lateral * sigma * b * np.array([-s, c])

    return velocity


def pressure(speed: Any, exponent: float) -> Any:
    """Pressure, Pa, of a speed, m/s."""
    return np.where(speed <= 5, 0.6 * speed * speed, 15 * (np.maximum(speed, 5) / 5) ** exponent)


def speed_of(pa: Any, exponent: float) -> Any:
    """Speed, m/s, of a pressure, Pa."""
    return np.where(pa <= 15, np.sqrt(pa / 0.6), 5 * (np.maximum(pa, 15) / 15) ** (1 / exponent))


def size(vector: Any) -> float:
    """Length of a vector (x, z)."""
    return math.hypot(*vector)


def compressed(p: Any, strongest_pa: float, most_pa: float) -> Any:
    """The pressure p (x, z) compressed; of the strongest gust; the strongest sampled one, Pa."""

    def law(x: float) -> float:
        return x if x <= 1 else 1 + 0.25 * math.log(1 + 4 * (x - 1))

    gust, x = max(1.0, strongest_pa / most_pa), size(p) / most_pa
    return p * (law(gust) / gust if x <= gust else law(gust) * law(x / gust) / x)


def crown_field(seed: int) -> Any:
    """(64, 64, 2): the fields A and B at [row, column]."""
    row, column = np.arange(64)[:, None], np.arange(64)
    field = np.zeros((64, 64, 2))
    for k in range(48):
        turn, count = hash32(seed, 3 * k) * 2 * math.pi / 2**32, 4 * 4 ** ((k + 0.5) / 48)
        m, n = math.floor(count * math.cos(turn) + 0.5), math.floor(count * math.sin(turn) + 0.5)
        phase, s = hash32(seed, 3 * k + 1) * 2 * math.pi / 2**32, math.hypot(m, n)
        wave = s ** (-1 / 3) * np.cos(2 * np.pi * (n * row + m * column) / 64 + phase)
        field += wave[..., None] * np.array([-n, m]) / s
    return field / np.sqrt(np.mean(field**2, axis=(0, 1)))


def crown_gusts(wind: dict[str, Any], field: Any, places: Any, p: Any, t: float, exponent: float) -> Any:
    """(G, 2): a and b at places (G, 3) of the world, m, where the pressure at the tree is p (x, z), Pa."""
    theta, travelled = math.radians(wind["direction_deg"]), wind["convection_speed_m_s"] * t
    c, s, (x, y, z) = math.cos(theta), math.sin(theta), np.transpose(places)
    if wind["model"] == "cosine":
        return np.zeros((len(places), 2))
    xi = (x * c + z * s - travelled - 0.6 * y) / 0.75
    eta = (z * c - x * s + 0.8 * y) / 0.75 + 0.191 * xi
    column, row = np.floor(xi).astype(int), np.floor(eta).astype(int)
    right, far = (xi - column)[:, None], (eta - row)[:, None]
    near = (1 - right) * field[row % 64, column % 64] + right * field[row % 64, (column + 1) % 64]
    back = (1 - right) * field[(row + 1) % 64, column % 64]
    back = back + right * field[(row + 1) % 64, (column + 1) % 64]
    gusts = np.clip(0.6 * wind["gustiness"] * ((1 - far) * near + far * back), -0.9, 0.9)
    return gusts * np.array([2.0 if size(p) <= 15 else exponent, 1.0])
