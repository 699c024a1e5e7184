"""The motion that all looping exports play: one period of a tree's steady state in a wind made periodic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.motion.wind import Wind
from galewood.player import periodic_motion
from galewood.solid.skinning import drawn_positions
from galewood.table import Table
from galewood.util import Floats


@dataclass(frozen=True)
class Loop:
    """A looping motion of ``frames`` frames; the frame after the last is the first."""

    wind: Wind
    steps: Floats
    """(N, r) poses q at the table's steps."""
    after: Floats
    """(r,) pose of the model one period after the first."""
    seconds: float
    frames: int

    @property
    def fps(self) -> float:
        """Frames per second; as asked for, up to the rounding to whole frames."""
        return self.frames / self.seconds

    def q_at(self, time_s: float) -> Floats:
        """(r,) the pose at a time, interpolated between table steps as everywhere."""
        at = (time_s / self.seconds * len(self.steps)) % len(self.steps)
        k = int(at)
        first, second = self.steps[k % len(self.steps)], self.steps[(k + 1) % len(self.steps)]
        return first + (at - k) * (second - first)

    def q(self) -> Floats:
        """(frames, r) the poses of the frames."""
        return np.stack([self.q_at(frame * self.seconds / self.frames) for frame in range(self.frames)])


def looped(table: Table, wind: Wind, loop_s: float, fps: float) -> Loop:
    """One period of the motion in a wind."""
    motion = periodic_motion(table, wind, loop_s)
    seconds = len(motion.q) * motion.dt_s
    return Loop(wind, motion.q, motion.after, seconds, max(2, round(seconds * fps)))


def seam_percent(table: Table, rest_m: Floats, loop: Loop) -> float:
    """Largest distance of a vertex from itself where the loop closes, in % of the tree's height."""
    jump = drawn_positions(table, rest_m, loop.after) - drawn_positions(table, rest_m, loop.steps[0])
    return 100 * float(np.linalg.norm(jump, axis=1).max()) / float(table.metadata["height_m"])
