"""Plays GLBs with EXT_modal_dynamics in plain Python, from spec/formats/EXT_modal_dynamics.md alone."""

from __future__ import annotations

import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np

EXTENSION, STEPS = "EXT_modal_dynamics", 8
HALF_DENSITY, STREAMLINED, COMPRESSION = 0.6, 5.0, 0.25


def turned(vector: Any, angle: float) -> Any:
    """(x, z), turned from x towards z."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def wave(about: Any, time_s: float) -> float:
    """A wave with a frequency in Hz, an amplitude and a phase in turns."""
    frequency, amplitude, phase = about
    return amplitude * math.cos(2 * math.pi * (frequency * time_s + phase))


def propagator(oscillator: dict[str, Any], h: float) -> list[float]:
    """r00 − 1, r01, r10, r11 − 1, s0, s1 of an oscillator."""
    if "step" in oscillator:
        return oscillator["step"]
    w, z = oscillator["angularFrequency"], oscillator["dampingRatio"]
    v, decay = w * math.sqrt(1 - z * z), math.exp(-z * w * h)
    c, s = decay * math.cos(v * h), decay * math.sin(v * h) / v
    r00, r11 = c + z * w * s, c - z * w * s
    return [r00 - 1, s, -w * w * s, r11 - 1, (1 - r00) / w**2, s]


def quaternion(vector: Any) -> Any:
    """x, y, z, w of the rotation about a vector by its length."""
    angle = float(np.linalg.norm(vector))
    return np.append(np.asarray(vector) * (0.5 * np.sinc(angle / (2 * math.pi))), math.cos(angle / 2))


def product(a: Any, b: Any) -> Any:
    """Product of two quaternions x, y, z, w: b, then a."""
    xyz = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(xyz, a[3] * b[3] - a[:3] @ b[:3])


class Model:
    """The oscillators of one model, at rest."""

    def __init__(self, about: dict[str, Any]) -> None:
        self.h, oscillators = about["timeStep"], about["oscillators"]
        if any(("step" in one) == ("angularFrequency" in one) for one in oscillators):
            raise ValueError("an oscillator has either a step, or an angular frequency and a damping ratio")
        self.step = np.array([propagator(one, self.h) for one in oscillators])
        r00, r01, r10, r11 = (self.step[:, :4] + [1, 0, 0, 1]).T
        eigenvalues = np.linalg.eigvals(np.stack([r00, r01, r10, r11], axis=1).reshape(-1, 2, 2))
        if abs(eigenvalues).max() > 1 + 1e-9:
            raise ValueError("an oscillator does not contract")
        self.load = np.array([one["load"] for one in oscillators])
        self.drag = np.array([one.get("drag", 0.0) for one in oscillators])
        pressure = about.get("pressure", {})
        self.exponent, self.limit = pressure.get("exponent", 2.0), pressure.get("limit", math.inf)
        self.wind = about.get("wind", {"velocity": [0.0, 0.0]})
        self.e, self.v, self.before = np.zeros((3, len(oscillators)))
        self.phase = self.time_s = 0.0

    def own_wind(self) -> Any:
        """The wind of the file at this time."""
        g = self.wind.get("gustiness", 0.0)
        ripple = sum(wave(one, self.time_s) for one in self.wind.get("waves", []))
        heading = g * wave(self.wind.get("swing", (0, 0, 0)), self.time_s)
        return max(0.0, 1 + g * ripple) * turned(self.wind["velocity"], heading)

    def pressed(self, wind: Any) -> tuple[Any, float]:
        """Pressure along x and z, and pressure over speed."""
        speed = math.hypot(*wind)
        kappa = HALF_DENSITY * min(speed, STREAMLINED) * max(speed / STREAMLINED, 1) ** (self.exponent - 1)
        over = max(kappa * speed / self.limit, 1.0)
        return kappa * np.asarray(wind) * (
            1 + COMPRESSION * math.log1p((over - 1) / COMPRESSION)
        ) / over, kappa

    def advance(self, dt_s: float, wind: Any = None) -> Any:
        """Advance by a frame in a wind (x, z), or in that of the file; the coordinates to show."""
        self.time_s += dt_s
        pressure, kappa = self.pressed(self.own_wind() if wind is None else wind)
        self.phase += dt_s / self.h
        for _ in range(min(int(self.phase), STEPS)):
            r00, r01, r10, r11, s0, s1 = self.step.T  # r00 and r11 less 1
            free = self.load @ pressure
            moved = r00 * self.e + r01 * self.v + s0 * free
            f, e, v = free - kappa * self.drag * moved / self.h, self.e, self.v
            self.before = e
            self.e, self.v = e + r00 * e + r01 * v + s0 * f, v + r10 * e + r11 * v + s1 * f
        self.phase -= math.floor(self.phase)
        return self.shown

    @property
    def shown(self) -> Any:
        """The coordinates to show."""
        return self.before + self.phase * (self.e - self.before)


class Asset:
    """A glTF asset whose nodes are moved by models."""

    def __init__(self, document: dict[str, Any], binary: bytes = b"") -> None:
        self.document, self.binary = document, binary
        self.models = [Model(about) for about in document["extensions"][EXTENSION]["models"]]
        for index in self.moved():
            about, count = self.about(index), len(self.models[self.about(index)["model"]].e)
            lists = [about[key] for key in ("translation", "rotation") if key in about]
            node = document["nodes"][index]
            if not lists:
                lists = [one["targets"] for one in document["meshes"][node["mesh"]]["primitives"]]
            if any(len(one) != count for one in lists):
                raise ValueError(f"node {index} has not one target per oscillator")

    @classmethod
    def read(cls, path: str) -> Asset:
        """Read a GLB."""
        data = Path(path).read_bytes()
        size = struct.unpack_from("<I", data, 12)[0]
        return cls(json.loads(data[20 : 20 + size]), data[28 + size :])

    def about(self, node: int) -> dict[str, Any]:
        """The extension of a node; empty: it has none."""
        return self.document["nodes"][node].get("extensions", {}).get(EXTENSION, {})

    def moved(self) -> list[int]:
        """The nodes that models move."""
        return [k for k in range(len(self.document["nodes"])) if self.about(k)]

    def advance(self, dt_s: float, wind: Any = None) -> None:
        """Advance all models by a frame, in a wind (x, z), m/s, or in those of the file."""
        for model in self.models:
            model.advance(dt_s, wind)

    def weights(self, node: int) -> Any:
        """Weights of the morph targets of a node."""
        of_node = self.document["nodes"][node]
        mesh = self.document["meshes"][of_node["mesh"]]
        shown = self.models[self.about(node)["model"]].shown
        return np.asarray(of_node.get("weights", mesh.get("weights", 0.0))) + shown

    def pose(self, node: int) -> tuple[Any, Any]:
        """Translation (m) and rotation (x, y, z, w) of a node."""
        of_node, about = self.document["nodes"][node], self.about(node)
        shown = self.models[about["model"]].shown
        moved = shown @ np.array(about.get("translation", np.zeros((len(shown), 3))))
        turn = quaternion(shown @ np.array(about.get("rotation", np.zeros((len(shown), 3)))))
        start = np.array(of_node.get("rotation", [0.0, 0.0, 0.0, 1.0]))
        return np.array(of_node.get("translation", [0.0] * 3)) + moved, product(turn, start)

    def rows(self, accessor: int) -> Any:
        """(n, 3) rows of an accessor of floats."""
        about = self.document["accessors"][accessor]
        view = self.document["bufferViews"][about["bufferView"]]
        start = view.get("byteOffset", 0) + about.get("byteOffset", 0)
        return np.frombuffer(self.binary, "<f4", 3 * about["count"], start).reshape(-1, 3).astype(float)

    def vertices(self, node: int) -> Any:
        """(v, 3) vertices of the first primitive of a node, in its own axes, m."""
        mesh = self.document["meshes"][self.document["nodes"][node]["mesh"]]
        primitive = mesh["primitives"][0]
        targets = np.stack([self.rows(target["POSITION"]) for target in primitive["targets"]])
        return self.rows(primitive["attributes"]["POSITION"]) + np.tensordot(self.weights(node), targets, 1)
