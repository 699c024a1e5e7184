"""The drift-free method: a few oscillators of the tree's own, stepped exactly, bent by a small force.

State of a tree: d modal coordinates e (m·√kg) about its gravity rest pose and their velocities v. A step is
the finite elements' own linear step, diagonal in e, under the wind's load and a force that is polynomial in
the two sway coordinates (docs/design/0005-drift-free-motion.md). The shown pose q is linear in e and the
pressure, plus a polynomial for what bending draws along. web/src/tangent.ts is the same arithmetic, operation
for operation.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]

MAX_STEPS_PER_ADVANCE = 8
"""After a long pause a tree resumes instead of catching up."""
MAX_COUPLED = 4
"""Modes beside the two sway coordinates whose products with these are kept."""
REACH = 1.25
"""The polynomials are held where they are beyond this multiple of the sampled range: their force stays
bounded, and the linear step that it drives is contracting, so any bounded wind gives a bounded motion."""
REST = 1e-7
"""In still air a motion below this share of the sampled range ends, exactly."""


@dataclass(frozen=True)
class Tangent:
    """Tensors of the method: d dynamic coordinates, c coupled ones, r shown modes, F = 26 + 2c terms.

    A step of an oscillator under a force f is e' = r00 e + r01 v + s0 f, v' = r10 e + r11 v + s1 f.
    """

    step: Singles  # (d, 6) r00 − 1, r01, r10, r11 − 1, s0, s1
    load: Singles  # (d, 2) modal force per Pa of pressure along x and z
    sway: Singles  # (2, d) the two sway coordinates, 1 at the edge of the sampled range
    force: Singles  # (F, d)
    pose: Singles  # (d + 2 + 7 + 2c, r) m of q per unit
    limits: Singles  # (3 + c,) sampled range: sway, sway's speed 1/s, pressure Pa, coupled coordinates

    @property
    def coupled(self) -> int:
        return len(self.limits) - 3


def coupled_modes(dynamic: int) -> int:
    """c: the coupled coordinates are those numbered 2 to 2 + c."""
    return min(MAX_COUPLED, dynamic - 2)


def shape_terms(coupled: int) -> int:
    return 7 + 2 * coupled


def force_terms(coupled: int) -> int:
    return shape_terms(coupled) + 19


@numba.njit(cache=True, nogil=True)
def write_shape(x, y, e, limits, out):  # pragma: no cover  (compiled)
    """Terms in the pose alone: sway of degree 2 and 3, then each coupled coordinate times the sway."""
    out[0], out[1], out[2] = x * x, x * y, y * y
    out[3], out[4], out[5], out[6] = out[0] * x, out[0] * y, x * out[2], out[2] * y
    for j in range(len(limits) - 3):
        far = REACH * limits[3 + j]
        z = min(max(e[2 + j], -far), far)
        out[7 + 2 * j] = z * x
        out[8 + 2 * j] = z * y


@numba.njit(cache=True, nogil=True)
def write_motion(x, y, vx, vy, px, pz, at, out):  # pragma: no cover  (compiled)
    """Terms with the sway's speed (centrifugal) and with the pressure (a bent tree is pushed otherwise)."""
    a, b, c = vx * vx, vx * vy, vy * vy
    out[at], out[at + 1], out[at + 2] = a, b, c
    out[at + 3], out[at + 4], out[at + 5] = a * x, a * y, b * x
    out[at + 6], out[at + 7], out[at + 8] = b * y, c * x, c * y
    out[at + 9], out[at + 10], out[at + 11], out[at + 12] = px * x, px * y, pz * x, pz * y
    out[at + 13], out[at + 14], out[at + 15] = px * out[0], px * out[1], px * out[2]
    out[at + 16], out[at + 17], out[at + 18] = pz * out[0], pz * out[1], pz * out[2]


@numba.njit(cache=True, nogil=True)
def held(x, y, far):  # pragma: no cover  (compiled)
    """(x, y) drawn back to length ``far`` if it is longer."""
    size = np.sqrt(x * x + y * y)
    if size > far:
        return x * (far / size), y * (far / size)
    return x, y


@numba.njit(cache=True, nogil=True)
def swayed(sway, e):  # pragma: no cover  (compiled)
    x, y = 0.0, 0.0
    for k in range(len(e)):
        x += sway[0, k] * e[k]
        y += sway[1, k] * e[k]
    return x, y


@numba.njit(cache=True, nogil=True)
def write_force_terms(sway, limits, half_s, e, v, px, pz, ahead, out):  # pragma: no cover  (compiled)
    """All terms of the force at the middle of the coming step, as far as the state now tells."""
    for k in range(len(e)):
        ahead[k] = e[k] + half_s * v[k]
    x, y = swayed(sway, ahead)
    x, y = held(x, y, REACH * limits[0])
    vx, vy = swayed(sway, v)
    vx, vy = held(vx, vy, REACH * limits[1])
    px, pz = held(px, pz, REACH * limits[2])
    write_shape(x, y, ahead, limits, out)
    write_motion(x, y, vx, vy, px, pz, 7 + 2 * (len(limits) - 3), out)


@numba.njit(cache=True, nogil=True)
def write_pose_terms(sway, limits, e, px, pz, out):  # pragma: no cover  (compiled)
    """e, the pressure, and the terms in the pose."""
    d = len(e)
    out[:d] = e
    out[d], out[d + 1] = px, pz
    x, y = swayed(sway, e)
    x, y = held(x, y, REACH * limits[0])
    write_shape(x, y, e, limits, out[d + 2 :])


@numba.njit(cache=True, nogil=True)
def _step(tensors, half_s, px, pz, e, v, work):  # pragma: no cover  (compiled)
    """Advance one tree by the table's step."""
    step, load, sway, force, _, limits = tensors
    d = len(e)
    ahead, terms, total = work[0, :d], work[1], work[2]
    write_force_terms(sway, limits, half_s, e, v, px, pz, ahead, terms)
    for k in range(d):
        total[k] = load[k, 0] * px + load[k, 1] * pz
    for f in range(len(force)):
        for k in range(d):
            total[k] += force[f, k] * terms[f]
    for k in range(d):
        a, b = e[k], v[k]
        e[k] = a + (step[k, 0] * a + step[k, 1] * b + step[k, 4] * total[k])
        v[k] = b + (step[k, 2] * a + step[k, 3] * b + step[k, 5] * total[k])


@numba.njit(cache=True, nogil=True)
def _settled(sway, limits, e, v, px, pz):  # pragma: no cover  (compiled)
    """Whether the air is still and the tree moves too little to matter; then it rests."""
    if px != 0.0 or pz != 0.0:
        return False
    x, y = swayed(sway, e)
    vx, vy = swayed(sway, v)
    small = REST * limits[0]
    if max(abs(x), abs(y)) > small or max(abs(vx), abs(vy)) > REST * limits[1]:
        return False
    largest = 0.0
    for k in range(len(e)):
        largest = max(largest, abs(e[k]))
    return largest * max(abs(sway[0, 0]), abs(sway[1, 0])) < small


@numba.njit(cache=True, nogil=True)
def _show(tensors, px, pz, e, work, before, now):  # pragma: no cover  (compiled)
    """The pose of the state now, the one before kept."""
    sway, pose, limits = tensors[2], tensors[4], tensors[5]
    terms = work[1]
    write_pose_terms(sway, limits, e, px, pz, terms)
    for k in range(len(now)):
        before[k] = now[k]
        now[k] = 0.0
    for f in range(len(pose)):
        for k in range(len(now)):
            now[k] += pose[f, k] * terms[f]


@numba.njit(cache=True, nogil=True)
def _advance(
    tensors, half_s, rate, turn, pressure_x, pressure_z, e, v, phase, now, before, q, coverage, work
):  # pragma: no cover  (compiled)
    sway, limits = tensors[2], tensors[5]
    for i in range(len(phase)):
        px = turn[i, 0] * pressure_x[i] - turn[i, 1] * pressure_z[i]
        pz = turn[i, 1] * pressure_x[i] + turn[i, 0] * pressure_z[i]
        phase[i] += rate[i]
        steps = 0
        while phase[i] >= 1.0 and steps < MAX_STEPS_PER_ADVANCE:
            _step(tensors, half_s, px, pz, e[i], v[i], work)
            if _settled(sway, limits, e[i], v[i], px, pz):
                e[i] = 0.0
                v[i] = 0.0
            _show(tensors, px, pz, e[i], work, before[i], now[i])
            x, y = swayed(sway, e[i])
            coverage[i] = max(np.sqrt(x * x + y * y) / limits[0], np.sqrt(px * px + pz * pz) / limits[2])
            phase[i] -= 1.0
            steps += 1
        phase[i] -= np.floor(phase[i])
        for k in range(q.shape[1]):
            q[i, k] = before[i, k] + (now[i, k] - before[i, k]) * phase[i]


def widened(tangent: Tangent) -> tuple[Floats, ...]:
    """The tensors in the type that steps are computed in."""
    names = ("step", "load", "sway", "force", "pose", "limits")
    return tuple(np.ascontiguousarray(getattr(tangent, name), np.float64) for name in names)


class TangentForest:
    """Trees of one table, each with its own state, in its own frame and at its own pace."""

    def __init__(self, tangent: Tangent, dt_s: float, mode_scale: Singles, count: int) -> None:
        """``count`` trees at rest; dt_s is the table's step, mode_scale (r,) the stream's unit of q."""
        self._tensors = widened(tangent)
        self._dt_s, self._scale = dt_s, mode_scale.astype(np.float64)
        d, r = len(tangent.step), tangent.pose.shape[1]
        self._e, self._v = np.zeros((count, d)), np.zeros((count, d))
        self._now, self._before = np.zeros((count, r)), np.zeros((count, r))
        self._phase, self._rate, self._size = np.zeros(count), np.zeros(count), np.ones(count)
        self._turn = np.tile(np.array([1.0, 0.0]), (count, 1))
        self._work = np.zeros((3, max(len(tangent.force), len(tangent.pose), d)))
        self.x_m, self.z_m = np.zeros(count, np.float32), np.zeros(count, np.float32)
        self.coverage = np.zeros(count, np.float32)
        """(count,) how far into the sampled range of sway and pressure a tree is: above 1 it is beyond it."""
        self.q = np.zeros((count, r), np.float32)
        """(count, r) shown pose, between the last two steps."""

    def set_trees(
        self, x_m: npt.ArrayLike, z_m: npt.ArrayLike, yaw_rad: npt.ArrayLike, scale: npt.ArrayLike
    ) -> None:
        """Place, turn and size of each tree (count,); their state goes on."""
        self.x_m[:], self.z_m[:] = x_m, z_m
        yaw = np.asarray(yaw_rad, np.float32).astype(np.float64)
        # Rounded: the last bit of a cosine is nobody's promise.
        self._turn[:, 0] = np.cos(yaw).astype(np.float32)
        self._turn[:, 1] = np.sin(yaw).astype(np.float32)
        self._size[:] = np.asarray(scale, np.float32)

    def advance(self, dt_s: float, pressure_x: npt.ArrayLike, pressure_z: npt.ArrayLike) -> None:
        """Let dt_s seconds pass under world pressures (count,) in Pa; large trees sway slower."""
        np.divide(dt_s / self._dt_s, self._size, out=self._rate)
        px, pz = np.asarray(pressure_x, np.float64), np.asarray(pressure_z, np.float64)
        _advance(
            self._tensors, self._dt_s / 2, self._rate, self._turn, px, pz, self._e, self._v,
            self._phase, self._now, self._before, self.q, self.coverage, self._work,
        )  # fmt: skip

    def poses(self) -> npt.NDArray[np.int32]:
        """(count, r) shown pose in units of the table's mode scale, as the stream sends it."""
        return np.rint(self.q / self._scale).astype(np.int32)
