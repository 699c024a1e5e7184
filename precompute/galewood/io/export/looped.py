"""The motion that exports play: a tree's steady state in a wind made periodic, or in the wind as it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from galewood.motion.wind import Wind, WindField
from galewood.player import PERIOD_START_S, WindDrivenTrees, periodic_motion
from galewood.solid.skinning import drawn_positions
from galewood.table import Table
from galewood.util import Floats


@dataclass(frozen=True)
class Loop:
    """A motion of ``frames`` frames; the frame after the last is the first."""

    wind: Wind
    steps: Floats
    """(N, r) poses q at the table's steps."""
    after: Floats
    """(r,) pose of the model after the last step: in a closed loop one period after the first."""
    seconds: float
    frames: int
    closed: bool = True
    """Whether the last frame leads on to the first; otherwise there is a jump between them."""

    @property
    def fps(self) -> float:
        """Frames per second; as asked for, up to the rounding to whole frames."""
        return self.frames / self.seconds

    @property
    def end(self) -> Floats:
        """(r,) the pose at the end: the first one again, if the loop is closed."""
        return self.steps[0] if self.closed else self.after

    def q_at(self, time_s: float) -> Floats:
        """(r,) the pose at a time, interpolated between table steps as everywhere."""
        at = (time_s / self.seconds * len(self.steps)) % len(self.steps)
        k = int(at)
        first, second = self.steps[k], self.steps[k + 1] if k + 1 < len(self.steps) else self.end
        return first + (at - k) * (second - first)

    def q(self) -> Floats:
        """(frames, r) the poses of the frames."""
        return np.stack([self.q_at(frame * self.seconds / self.frames) for frame in range(self.frames)])

    def keys(self) -> Floats:
        """(frames + 1, r) the same, and the pose at the end: what an animation needs."""
        return np.concatenate([self.q(), self.end[None]])

    def key_times_s(self) -> Floats:
        """(frames + 1,) times of the keys."""
        return np.arange(self.frames + 1, dtype=np.float64) * (self.seconds / self.frames)

    def about(self, table: Table) -> dict[str, Any]:
        """What every description of an export says about the motion."""
        return {**self.about_length(table), "wind": self.wind.document()}

    def about_length(self, table: Table) -> dict[str, Any]:
        """The same without the wind."""
        return {
            "frames": self.frames,
            "seconds": self.seconds,
            "fps": self.fps,
            "loop": self.closed,
            "height_m": float(table.metadata["height_m"]),
        }


def looped(table: Table, wind: Wind, seconds: float, fps: float, *, closed: bool = True) -> Loop:
    """A motion that repeats, in the wind made periodic; not ``closed``: in the wind as it is."""
    if closed:
        motion = periodic_motion(table, wind, seconds)
        steps, after = motion.q, motion.after
    else:
        played = _played(table, wind, seconds)
        steps, after = played[:-1], played[-1]
    length_s = len(steps) * float(table.metadata["dt_s"])
    return Loop(wind, steps, after, length_s, max(2, round(length_s * fps)), closed)


def _played(table: Table, wind: Wind, seconds: float) -> Floats:
    """(N + 1, r) poses of one tree at the table's steps, from the time at which a loop begins too."""
    dt_s, field = float(table.metadata["dt_s"]), WindField(wind)
    tree = WindDrivenTrees(table, [[0.0, 0.0, 0.0, 1.0]])
    before, kept = round(PERIOD_START_S / dt_s), max(2, round(seconds / dt_s)) + 1
    track = np.empty((kept, tree.q.shape[1]))
    for k in range(before + kept):
        # a little more than the table's step, so that rounding never skips one
        tree.step(field, dt_s * (k + 1), dt_s * (1 + 1e-12))
        if k >= before:
            track[k - before] = tree.q[0]
    return track


def seam(table: Table, rest_m: Floats, loop: Loop) -> dict[str, float]:
    """Largest distance of a vertex from itself where a loop closes, in % of the tree's height."""
    if not loop.closed:
        return {}
    jump = drawn_positions(table, rest_m, loop.after) - drawn_positions(table, rest_m, loop.steps[0])
    farthest_m = float(np.linalg.norm(jump, axis=1).max())
    return {"seam_percent_of_height": 100 * farthest_m / float(table.metadata["height_m"])}
