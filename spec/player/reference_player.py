"""Plays Galewood tables in plain Python, from spec/formats/table.md alone; short rather than fast."""

from __future__ import annotations

import itertools
import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
from reference_joints import drawn
from reference_wind import Velocity, compressed, crown_field, crown_gusts, pressure, size, speed_of

TYPES = {"F32": "<f4", "U16": "<u2", "I16": "<i2", "U32": "<u4"}
CLAMP, STEPS, REST = 1.25, 8, 1e-7


def read(path: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Metadata and tensors of a table or records file."""
    data = Path(path).read_bytes()
    start = 8 + struct.unpack_from("<Q", data)[0]
    header = json.loads(data[8:start])
    metadata, tensors = json.loads(header.pop("__metadata__")["galewood"]), {}
    for name, about in header.items():
        first, last = (start + at for at in about["data_offsets"])
        flat = np.frombuffer(data[first:last], TYPES[about["dtype"]])
        tensors[name] = flat.reshape(about["shape"]).astype(float if about["dtype"] == "F32" else int)
    return metadata, tensors


def held(pair: Any, limit: float) -> Any:
    """A pair, shortened to at most 1.25 of the limit."""
    return pair * min(1.0, CLAMP * limit / max(size(pair), 1e-300))


def one_less_exp(x: Any) -> Any:
    """1 − exp(−x) by sums and products in a fixed order."""
    t, p = np.minimum(x, 50.0) / 256, -1 / math.factorial(11)
    for n in range(10, -1, -1):
        p = p * t + (-1.0) ** n / math.factorial(n)
    for _ in range(8):
        p = p * p
    return 1.0 - p


class Tree:
    """One tree at rest. `path`: table; `records`: records file of the paper's method (or in the table)."""

    def __init__(self, path: str, yaw: float = 0.0, scale: float = 1.0, records: str = "") -> None:
        self.metadata, self.t = read(path)
        if records:
            about, more = read(records)
            self.metadata["paper"], self.t = about["paper"], self.t | more
        self.c, self.s, self.scale, self.dt = math.cos(yaw), math.sin(yaw), scale, self.metadata["dt_s"]
        self.exponent = self.metadata["streamlined_exponent"]
        self.d = len(self.t["modal.step"])
        self.e, self.v = np.zeros((2, self.d))
        self.now, self.before = np.zeros((2, self.metadata["modes"]))
        self.phase, self.record, self.weight = 0.0, -1, 0.0
        self.easing = self.metadata["paper"]["pose_easing"] if "paper" in self.metadata else 0.0

    def advance(self, dt_s: float, p: Any, gusts: Any = (), paper: bool = False) -> Any:
        """Advance under a pressure p (x, z of the world, Pa), gusts (G, 2): a and b; return q (r,), m."""
        p = np.array([self.c * p[0] - self.s * p[1], self.s * p[0] + self.c * p[1]])
        self.phase += dt_s / self.dt / self.scale
        for _ in range(min(int(self.phase), STEPS)):
            last, self.before = self.now - self.before, self.now.copy()
            if paper:
                self.search_step(p, last)
            else:
                self.modal_step(p, np.reshape(gusts, (-1, 2)))
        self.phase %= 1.0
        q = self.before + (self.now - self.before) * self.phase
        return q * self.t["modes.scale"] if paper else q

    def modal_step(self, p: Any, gusts: Any) -> None:
        t, e, v = self.t, self.e, self.v
        r00, r01, r10, r11, s0, s1 = t["modal.step"].T  # r00 and r11 less 1
        local = np.zeros((len(t["modal.place"]), 2))
        if len(gusts):
            local = np.outer(gusts[:, 0], p) + np.outer(gusts[:, 1], [-p[1], p[0]])
        air = p + t["modal.drag_place"] @ local
        sheltered = t["modal.drag_point"].prod(1)
        felt = p + sheltered @ (air - p) / max(sheltered.sum(), 1e-30)
        f = t["modal.load"] @ p + np.einsum("kxg,gx->k", t["modal.place_load"], local)
        f = f + self.force_terms(felt) @ t["modal.force"]
        f = f + self.drag((r00 * e + r01 * v + s0 * f) / self.dt, air)
        self.e, self.v = e + r00 * e + r01 * v + s0 * f, v + r10 * e + r11 * v + s1 * f
        sway, limits = t["modal.sway"], t["modal.limits"]
        slow = abs(sway @ self.e).max() <= REST * limits[0] and abs(sway @ self.v).max() <= REST * limits[1]
        if slow and not p.any() and abs(self.e).max() * abs(sway[:, 0]).max() < REST * limits[0]:
            self.e, self.v = np.zeros((2, self.d))
        pair = held(sway @ self.e, limits[0])
        terms = np.concatenate([self.e, felt, self.shape_terms(pair, self.e)])
        self.now = np.concatenate([t["modal.shown"] * self.e, terms @ t["modal.pose"]])

    def shape_terms(self, pair: Any, e: Any) -> Any:
        (x, y), far = pair, CLAMP * self.t["modal.limits"]
        c = (len(far) - 3) // 2
        z = np.clip(e[2 : 2 + c], -far[3 : 3 + c], far[3 : 3 + c])
        powers = [x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3]
        return np.concatenate([powers, np.outer(z, pair).ravel()])

    def force_terms(self, p: Any) -> Any:
        sway, limits = self.t["modal.sway"], self.t["modal.limits"]
        ahead, c = self.e + 0.5 * self.dt * self.v, (len(limits) - 3) // 2
        pair, (u, w), p = held(sway @ ahead, limits[0]), held(sway @ self.v, limits[1]), held(p, limits[2])
        shape = self.shape_terms(pair, ahead)
        speeds, first = np.array([u * u, u * w, w * w]), np.concatenate([pair, shape[:7]])
        far = CLAMP * limits[3:].reshape(2, c)
        z, zv = np.clip([ahead[2 : 2 + c], self.v[2 : 2 + c]], -far, far)
        coupled = np.hstack([np.outer(zv, pair), np.outer(z, p)]).ravel()
        motion = [speeds, np.outer(speeds, pair).ravel(), u * first[:5], w * first[:5]]
        return np.concatenate([shape, *motion, p[0] * first, p[1] * first, coupled])

    def drag(self, w: Any, wind: Any) -> Any:
        """Force of the drag at speeds w; `wind` (m, 2): the pressure at each point."""
        (area, share), shape = self.t["modal.drag_point"].T, self.t["modal.drag_shape"]
        if not len(area):
            return 0.0
        inputs = min(self.d, max(8, self.d // 2))
        steady = np.stack([wind[:, 0], 0.0 * area, wind[:, 1]]) * share
        strength = np.linalg.norm(steady, axis=0)
        air = steady * speed_of(strength, self.exponent) / np.maximum(strength, 1e-30)
        relative = air - shape[:, :, :inputs] @ w[:inputs]
        speed = np.maximum(np.linalg.norm(relative, axis=0), 1e-30)
        kappa = pressure(speed, self.exponent) / speed
        force = np.einsum("ijk,ij->k", shape, area * (kappa * relative - steady))
        return force - 4 / 3 * self.t["modal.drag_rest"] * (area @ kappa / area.sum()) * w

    def search_step(self, p: Any, last: Any) -> None:
        rule, t = self.metadata["paper"]["weight"], self.t
        still = ~t["samples.pressure_pa"].any(1)
        m = self.found(p, still, still == (not p.any()))
        m = self.found(p, still, np.ones(len(still), bool)) if m < 0 else m
        follows = self.record >= 0 and m == self.record + 1
        self.weight = min(rule["maximum"], self.weight + rule["growth"]) if follows else rule["initial"]
        self.record, self.now = m, self.eased(m, last)

    def found(self, p: Any, still: Any, allowed: Any) -> int:
        """The record of the next step among those allowed; −1: none."""
        t, paper, state = self.t, self.metadata["paper"], self.record + 1
        square = ((p - t["samples.pressure_pa"]) ** 2).sum(1)
        if state == 0 or (p.any() and still[state] and not allowed.all()):
            square[t["samples.trajectory"][1:] - 1] = np.inf
            square[~allowed] = np.inf
            return int(square.argmin()) if np.isfinite(square.min()) else -1
        row = slice(*t["search.offsets"][state : state + 2])
        j, mismatches = t["search.record"][row], np.cumsum(t["search.mismatch_steps"][row])
        j, mismatches = j[allowed[j]], mismatches[allowed[j]]
        if not len(j):
            return -1
        outer = one_less_exp(square[j] * (1 / (2 * paper["sigma_pa"] ** 2)))
        total = (1 - self.weight) * (mismatches / paper["components"]) + self.weight * outer
        best = j[total == total.min()]
        return state if state in best else int(best.min())

    def eased(self, m: int, last: Any) -> Any:
        """The pose after record m; `last` is the tree's last step."""
        dq, start, easing = self.t["samples.dq"], self.t["samples.trajectory"], self.easing
        now, first = self.now, int(start[start <= m].max())
        if easing == 0:
            return now + dq[m]
        pose = dq[first:m].sum(0)
        speed = (1 - easing) ** 2 * (last - (dq[m - 1] if m > first else 0)) - easing**2 * (now - pose)
        offset = now - pose + speed
        settled = (abs(offset) < 0.5).all() and (abs(speed) < 0.5).all()
        return pose + dq[m] + (0.0 if settled else offset)

    def places(self, points: Any, x: float, z: float) -> Any:
        """(n, 3) points of the tree's own frame where it stands in the world, m."""
        px, py, pz = self.scale * np.transpose(points)
        return np.stack([x + self.c * px + self.s * pz, py, z + self.c * pz - self.s * px], 1)

    def vertices(self, rest: Any, q: Any, x: float, z: float) -> Any:
        """(v, 3) vertices in the world; `rest`: POSITION of all primitives of the GLB, in their order."""
        return self.places(drawn(self.t, rest, q), x, z)


def play(tree: Tree, wind: dict[str, Any], velocity: Velocity, x: float, z: float, dt_s: float) -> Any:
    """Yield q at dt_s, 2 dt_s, … of a tree at x, z that the modal model moves in a steady wind."""
    field = crown_field(int(wind["seed"]))
    height = tree.metadata["height_m"] * tree.scale / wind.get("reference_height_m", 12.0)
    faster = height ** wind.get("height_exponent", 0.2)
    gust, exponent = (1 + wind["gustiness"]) * wind["mean_speed_m_s"] * faster, tree.exponent
    strongest = float(pressure(gust, exponent))
    for frame in itertools.count(1):
        w = faster * np.asarray(velocity(x, z, frame * dt_s))
        p = w * pressure(size(w), exponent) / max(size(w), 1e-30)
        p = compressed(p, strongest, tree.t["modal.limits"][2])
        places = tree.places(tree.t["modal.place"], x, z)
        gusts = crown_gusts(wind, field, places, p, frame * dt_s, exponent)
        yield tree.advance(dt_s, p, gusts)
