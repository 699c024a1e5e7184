"""A forest that is being played: one clock, one simulation, and any number of clients that follow it."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from galewood.table import Table
from galewood.wind import Wind

from galewood_server.stream.client_buffer import Mailbox
from galewood_server.stream.frames import FrameHistory
from galewood_server.stream.latest_values import Bulletin
from galewood_server.stream.wire import TICK_HZ, Clock, Forest, Shared, WindState

if TYPE_CHECKING:
    from galewood_server.stream.forest import ForestClock, ForestWalk

log = logging.getLogger("galewood.stream")
CLOCK_EVERY_TICKS = TICK_HZ
"""How often the clients of a shared forest are told the time."""


class LiveForest:
    """`compute` runs in a lane's thread, everything else in the event loop; never both at once for poses."""

    def __init__(self, plan: Forest, clock: ForestClock, now_s: float) -> None:
        self.share = plan.share
        self.members: set[Mailbox] = set()
        self.plan = plan
        self._clock = clock
        self._bulletin = Bulletin()
        self._walk: ForestWalk | None = None
        self._history: FrameHistory | None = None
        self._made_s = now_s
        self._blown = clock.wind
        self._failed = False
        self.empty_since_s = now_s
        if self.share is not None:
            self._announce()
            self._bulletin.post(WindState(clock.wind.document()))
            self._tell_time()

    @property
    def tree_count(self) -> int:
        """Trees that are simulated here."""
        return len(self.plan.trees) if self._walk else 0

    @property
    def needs_walk(self) -> bool:
        """Whether nobody has streamed these trees yet."""
        return self._walk is None

    @property
    def streamed(self) -> bool:
        """Whether somebody wants poses now."""
        return any(member.streams for member in self.members)

    # ---- in the event loop -------------------------------------------------------------------------

    def set_walk(self, walk: ForestWalk) -> None:
        """Begin to simulate, from rest."""
        history = FrameHistory(walk.shapes)
        history.add(self._clock.ticks, self._clock.time_s, self._made_s, walk.write_poses)
        self._walk, self._history = walk, history
        for member in self.members:
            member.resync()

    def replant(self, plan: Forest, walk: ForestWalk | None) -> None:
        """Other trees under the same clock and wind, for all."""
        self.plan = plan
        self._walk, self._history = None, None
        if walk is not None:
            self.set_walk(walk)
        self._announce()

    def make_walk(self, tables: Sequence[Table], plan: Forest) -> ForestWalk:
        """A simulation of these trees under this forest's clock; slow, hence in a thread."""
        from galewood_server.stream.forest import ForestWalk

        return ForestWalk(tables, plan, self._clock)

    def same_trees(self, plan: Forest) -> bool:
        """Whether a plan describes the trees that are here."""
        mine = self.plan
        return (mine.groups, mine.method, mine.pose_easing) == (
            plan.groups,
            plan.method,
            plan.pose_easing,
        ) and np.array_equal(mine.trees, plan.trees)

    def add(self, member: Mailbox, now_s: float) -> None:
        """A client joins, and has at once what there is."""
        self.members.add(member)
        current = self._history if self._history and self._history.tick == self._clock.ticks else None
        member.deliver(self._bulletin, current, now_s)

    def change_wind(self, wind: Wind) -> None:
        """Glide to another wind from the next tick on; all are told then."""
        self._clock.change_wind(wind)

    def pause(self, paused: bool) -> None:
        """Stop the clock or let it run on; all are told."""
        self._clock.paused = paused
        self._tell_time()

    def deliver(self, now_s: float) -> None:
        """Send every member what is new to it."""
        if self._failed:
            for member in self.members:
                member.cut()
            return
        if self._clock.wind is not self._blown:
            self._blown = self._clock.wind
            self._bulletin.post(WindState(self._blown.document()))
        if self.share is not None and self._clock.ticks % CLOCK_EVERY_TICKS == 0:
            self._tell_time()
        for member in self.members:
            member.deliver(self._bulletin, self._history, now_s)

    def _announce(self) -> None:
        plan = self.plan
        if plan.share is not None:
            self._bulletin.post(
                Shared(plan.share, plan.groups, plan.pose_easing, plan.method, plan.about, plan.trees)
            )

    def _tell_time(self) -> None:
        self._bulletin.post(Clock(self._clock.time_s, self._made_s, self._clock.paused))

    # ---- in a lane's thread ------------------------------------------------------------------------

    def compute(self, made_s: float) -> None:
        """One tick. A forest that fails ends alone."""
        try:
            self._tick(made_s)
        except Exception:
            log.exception("a forest failed and was ended")
            self._failed = True

    def _tick(self, made_s: float) -> None:
        self._made_s = made_s
        if self._clock.paused or self._failed:
            return
        self._clock.tick()
        walk, history = self._walk, self._history
        if walk is not None and history is not None and self.streamed:
            walk.step()
            history.add(self._clock.ticks, self._clock.time_s, made_s, walk.write_poses)
