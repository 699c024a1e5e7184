"""Galewood's winds perlin and navier-stokes in plain Python: a reader of spec/formats/wind.md."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from reference_wind import Velocity, hash32, travelling, weights

N = 128


def perlin(wind: dict[str, Any]) -> Velocity:
    """Velocity (x, z) at (x, z, t) of a perlin document."""
    order = list(range(256))
    for i in range(255, 0, -1):
        j = hash32(int(wind["seed"]), i) % (i + 1)
        order[i], order[j] = order[j], order[i]
    order, variance = order * 2, 35054270 / 480729249

    def slope(h: int, x: float, y: float, z: float) -> float:
        h &= 15
        u, v = x if h < 8 else y, y if h < 4 else x if h in (12, 14) else z
        return (-u if h & 1 else u) + (-v if h & 2 else v)

    def noise(*at: float) -> float:
        cell = [math.floor(value) for value in at]
        part = [value - floor for value, floor in zip(at, cell, strict=True)]
        fade, total = [p**3 * (p * (p * 6 - 15) + 10) for p in part], 0.0
        for corner in np.ndindex(2, 2, 2):
            hashed = 0
            for c, side in zip(cell, corner, strict=True):
                hashed = order[(hashed + c % 256 + side) % 512]
            share = math.prod(f if side else 1 - f for f, side in zip(fade, corner, strict=True))
            total += share * slope(hashed, *(p - side for p, side in zip(part, corner, strict=True)))
        return total

    def gusts(xi: float, eta: float, travel: float) -> tuple[float, float]:
        p, q, z = xi / 2, (eta + 0.17 * xi) / 2, 0.1 * travel
        a = sum(
            0.6**o * noise(2**o * p + 17.31 * o, 2**o * q + 9.67 * o, z + 31.5 * o) for o in range(3)
        ) / math.sqrt(variance * sum(0.36**o for o in range(3)))
        return a, noise(p + 101.4, q + 57.8, z + 0.5) / math.sqrt(variance)

    return travelling(wind, gusts, 0.5)


class Eddies:
    """One run of the solver: `z` holds u + iv at [y, x] after `steps` steps."""

    def __init__(self, seed: int) -> None:
        count = np.arange(N)
        k, turn = np.where(count < N // 2, count, count - N), 2 * np.pi * count / N
        self.seed, self.steps, self.square = seed, 0, (k[:, None] ** 2 + k**2).astype(float)
        row, column = count[:, None], count[None, :]
        self.half = (row < N // 2) & (column != N // 2) & ((row > 0) | (k > 0))
        self.s = np.sin(turn) + 0 * row, np.sin(turn)[:, None] + 0 * column
        self.smooth = (2 + np.cos(turn)) * (2 + np.cos(turn))[:, None] / 9
        i = (row * N + column).astype(np.uint64)
        start = np.where(self.square >= 9, np.maximum(self.square, 1) ** -1.5, 0)
        self.z = self.projected(start * self.random(seed, 2 * i), 0.0, 0)

    def random(self, seed: int, k: Any) -> Any:
        return hash32(seed, k) / 2**31 - 1 + 1j * (hash32(seed, k + 1) / 2**31 - 1)

    def projected(self, z: Any, kick: float, seed: int) -> Any:
        """The velocity of the spectrum z: without divergence, damped, forced, of unit variance."""
        z[0, 0] = 0
        z[N // 2], z[:, N // 2] = 0, 0
        opposite, (sx, sy) = (-np.arange(N)[:, None] % N, -np.arange(N) % N), self.s
        size2, k2 = (np.where(self.half, value, 1) for value in (sx * sx + sy * sy, self.square))
        u, v = (z + z[opposite].conj()) / 2, (z - z[opposite].conj()) / 2j
        p = (sy * u - sx * v) / size2 / (1 + 0.01 + 0.5 / k2)
        band = self.half & (self.square >= 16) & (self.square < 49)
        impulse = self.random(seed, 2 * np.arange(band.sum(), dtype=np.uint64))
        p[band] += kick * N * N / (8 * np.sqrt(size2[band])) * impulse
        u, v = np.where(self.half, sy * p, 0), np.where(self.half, -sx * p, 0)
        energy = (self.smooth**2 * (abs(u) ** 2 + abs(v) ** 2)).sum()
        z = u + 1j * v + (u.conj() + 1j * v.conj())[opposite]
        return np.fft.ifft2(z / math.sqrt(energy)) * N * N

    def step(self) -> None:
        self.steps += 1
        at = np.arange(N) - 0.5 * self.z.real, np.arange(N)[:, None] - 0.5 * self.z.imag
        (x, y), moved = (np.floor(a).astype(int) for a in at), 0
        for right in (0, 1):
            for up in (0, 1):
                tx, ty = at[0] - x, at[1] - y
                share = (tx if right else 1 - tx) * (ty if up else 1 - ty)
                moved = moved + share * self.z[(y + up) % N, (x + right) % N]
        self.z = self.projected(np.fft.fft2(moved), 0.06, hash32(self.seed, 7919 + self.steps))


def navier_stokes(wind: dict[str, Any]) -> Velocity:
    """Velocity (x, z) at (x, z, t ≥ 0) of a navier-stokes document; keeps all steps that were needed."""
    runs: dict[int, tuple[Eddies, list[Any]]] = {}

    def field(epoch: int, moment: float) -> Any:
        eddies, kept = runs.setdefault(epoch, (Eddies(hash32(int(wind["seed"]), epoch)), []))
        own = moment - 128 * epoch
        n = math.floor(own)
        while len(kept) < n + 2:
            kept.append(eddies.z)
            eddies.step()
        return (1 - (own - n)) * kept[n] + (own - n) * kept[n + 1]

    def gusts(xi: float, eta: float, travel: float) -> tuple[float, float]:
        epoch = math.floor(travel / 2) // 128
        fade, z = (travel / 2 - 128 * epoch) / 32, field(epoch, travel / 2)
        if epoch > 0 and fade < 1:
            z = math.sqrt(1 - fade) * field(epoch - 1, travel / 2) + math.sqrt(fade) * z
        column, row = math.floor(5 * xi), math.floor(5 * eta)
        near = np.ix_(np.arange(row - 1, row + 3) % N, np.arange(column - 1, column + 3) % N)
        sample = weights(5 * eta - row) @ z[near] @ weights(5 * xi - column)
        return sample.real, sample.imag

    return travelling(wind, gusts, 1.0)
