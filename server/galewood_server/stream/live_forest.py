"""A running forest: one clock, one simulation and any number of clients."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from galewood.constants import TICK_HZ

from galewood_server.stream.client_buffer import ClientBuffer
from galewood_server.stream.forest_hands import ZERO_FORCE, ForestHands
from galewood_server.stream.frames import FrameHistory
from galewood_server.stream.latest_values import LatestValues
from galewood_server.stream.wire import (
    Clock,
    Forest,
    Presence,
    Pull,
    Pulling,
    Pulls,
    Shared,
    Trees,
    WindState,
)

if TYPE_CHECKING:
    from galewood.motion.wind import Wind
    from galewood.table import Compliance, Table

    from galewood_server.stream.forest import ForestClock, ForestStepper

log = logging.getLogger("galewood.stream")
CLOCK_EVERY_TICKS = TICK_HZ
"""Interval of clock messages to the clients of a shared forest."""


class LiveForest:
    """`compute` runs in a worker thread, everything else in the event loop, never concurrently on poses."""

    def __init__(self, plan: Forest, clock: ForestClock, now_s: float) -> None:
        self.share = plan.share
        self.clients: set[ClientBuffer] = set()
        self.plan = plan
        self._clock = clock
        self._latest = LatestValues()
        self._stepper: ForestStepper | None = None
        self._history: FrameHistory | None = None
        self._made_s = now_s
        self._sent_wind = clock.wind
        self._told_clients = 0
        self._failed = False
        self._hands = ForestHands()
        self._pulls: tuple[Pulling, ...] = ()
        """The pulls of the last tick."""
        self._sent_pulls: tuple[Pulling, ...] = ()
        self.empty_since_s = now_s
        if self.share is not None:
            self._post_shared()
            self._latest.post(WindState(clock.wind.document()))
            self._send_clock()

    @property
    def tree_count(self) -> int:
        """Number of simulated trees."""
        return len(self.plan.trees) if self._stepper else 0

    @property
    def needs_stepper(self) -> bool:
        """Whether the trees are not simulated yet."""
        return self._stepper is None

    @property
    def streamed(self) -> bool:
        """Whether any client receives poses."""
        return any(client.streams for client in self.clients)

    # ---- in the event loop -------------------------------------------------------------------------

    def set_stepper(self, stepper: ForestStepper) -> None:
        """Start the simulation from rest."""
        history = FrameHistory(stepper.shapes)
        history.add(self._clock.ticks, self._clock.time_s, self._made_s, stepper.write_poses)
        self._stepper, self._history = stepper, history
        for client in self.clients:
            client.resync()

    def replant(self, plan: Forest, stepper: ForestStepper | None) -> None:
        """Replace the trees for all clients; clock and wind continue."""
        self.plan = plan
        self._stepper, self._history = None, None
        if stepper is not None:
            self.set_stepper(stepper)
        self._post_shared()

    def make_stepper(
        self, tables: Sequence[Table], plan: Forest, compliances: Sequence[Compliance | None] = ()
    ) -> ForestStepper:
        """Create a simulation of trees under this forest's clock. Slow: call it in a thread."""
        from galewood_server.stream.forest import ForestStepper

        return ForestStepper(tables, plan, self._clock, compliances)

    def simulate(self, trees: Trees, stepper: ForestStepper) -> None:
        """Start the simulation of the present trees, whose places a client may have brought."""
        if not len(self.plan.trees):
            self.plan = replace(self.plan, trees=trees)
            self._post_shared()
        self.set_stepper(stepper)

    def is_described_by(self, plan: Forest) -> bool:
        """Whether a request describes the current trees, of which it may know the places."""
        return (self.plan.groups, self.plan.about) == (plan.groups, plan.about)

    def same_trees(self, plan: Forest) -> bool:
        """Whether a request asks for the current trees, moved as they are now."""
        mine = self.plan
        if (mine.groups, mine.method, mine.pose_easing) != (plan.groups, plan.method, plan.pose_easing):
            return False
        placed = len(mine.trees) > 0 and len(plan.trees) > 0
        return np.array_equal(mine.trees, plan.trees) if placed else self.is_described_by(plan)

    def add(self, client: ClientBuffer, now_s: float) -> None:
        """Add a client and send it the current state."""
        self.clients.add(client)
        current = self._history if self._history and self._history.tick == self._clock.ticks else None
        client.deliver(self._latest, current, now_s)

    def change_wind(self, wind: Wind) -> None:
        """Start a transition to another wind at the next tick; all clients are notified."""
        self._clock.change_wind(wind)

    def lacks(self, wind: Wind) -> bool:
        """Whether this forest is simulated and the gusts of a wind must be prepared before it applies."""
        return self._stepper is not None and self._clock.lacks(wind)

    def prepare_wind(self, wind: Wind) -> None:
        """Prepare to change to a wind. Slow: call it in a thread."""
        self._clock.prepare(wind)

    def send_front(self, x_m: float, z_m: float) -> None:
        """Start a gust front at the next tick; all clients are notified."""
        self._clock.send_front(x_m, z_m)

    def pull(self, client: ClientBuffer, pull: Pull) -> bool:
        """Begin or continue a client's pull; whether the forest has room for it."""
        return self._hands.pull(client, pull)

    def release(self, client: ClientBuffer) -> None:
        """End a client's pull, if it has one."""
        self._hands.release(client)

    def pause(self, paused: bool) -> None:
        """Pause or resume the clock; all clients are notified."""
        self._clock.paused = paused
        self._send_clock()

    def deliver(self, now_s: float) -> None:
        """Send new values and frames to all clients."""
        if self._failed:
            self.disconnect_clients()
            return
        if self._clock.wind is not self._sent_wind:
            self._sent_wind = self._clock.wind
            self._latest.post(WindState(self._sent_wind.document()))
        self._send_pulls()
        if self.share is not None:
            if self._clock.ticks % CLOCK_EVERY_TICKS == 0:
                self._send_clock()
            # at most once per tick, because a client that replaces its request joins before it leaves
            if len(self.clients) != self._told_clients:
                self._told_clients = len(self.clients)
                self._latest.post(Presence(self._told_clients))
        for client in self.clients:
            client.deliver(self._latest, self._history, now_s)

    def disconnect_clients(self, *, streaming: bool = False) -> None:
        """Abort the connections of all clients, or of those who stream."""
        for client in self.clients:
            if client.streams or not streaming:
                client.disconnect()

    def _send_pulls(self) -> None:
        if self._pulls != self._sent_pulls:
            self._sent_pulls = self._pulls
            self._latest.post(Pulls(self._clock.time_s, self._sent_pulls))

    def _post_shared(self) -> None:
        plan = self.plan
        if plan.share is not None:
            self._latest.post(
                Shared(plan.share, plan.groups, plan.pose_easing, plan.method, plan.about, plan.trees)
            )

    def _send_clock(self) -> None:
        self._latest.post(Clock(self._clock.time_s, self._made_s, self._clock.paused))

    # ---- in a worker thread -------------------------------------------------------------------------

    def compute(self, made_s: float) -> None:
        """Compute one tick. If it fails, only this forest ends."""
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
        stepper, history, pulls = self._stepper, self._history, self._hands.pulls
        if stepper is not None and history is not None and self.streamed:
            stepper.step(pulls)
            history.add(self._clock.ticks, self._clock.time_s, made_s, stepper.write_poses)
            self._pulls = stepper.pullings(pulls)
        else:
            self._pulls = tuple(Pulling(pull, ZERO_FORCE) for pull in pulls)
