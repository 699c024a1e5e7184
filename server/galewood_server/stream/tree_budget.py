"""What clients may ask of the simulation: trees stepped at once, and work per second, by address.

The cost of a forest grows with its trees, so requests are weighed in trees and not only counted.
"""

from __future__ import annotations

import asyncio
import time

from galewood_server.stream.session_error import TRY_AGAIN_LATER, SessionError
from galewood_server.stream.wire import Forest

GROUP_WORK, TABLE_WORK, WIND_WORK, EDDIES_WORK = 100, 500, 2_000, 20_000
"""What else a request costs, in trees: a group, a table that is sent, other gusts, other eddies.

Measured: 20,000 trees take 70 ms of CPU until their first frame, to read a table 10 ms, spectral gusts with
those in the crowns 22 ms, Navier–Stokes eddies 85 to 220 ms.
"""
BURST_S = 4.0
"""Work of this time may be asked for at once."""
LONGEST_WAIT_S = 3.0
"""A page takes a server that answers nothing for 5 s for dead."""
MOST_ADDRESSES = 10_000


def work_of(plan: Forest) -> int:
    """The work to answer a forest request, in trees."""
    groups = GROUP_WORK * (1 + len(plan.groups))
    tables = TABLE_WORK * len({group.table for group in plan.groups}) if plan.mode == "table" else 0
    return len(plan.trees) + groups + tables


class TreeBudget:
    """The trees that running forests step, in total and by the address that asked for them."""

    def __init__(self, total: int, per_address: int) -> None:
        self._total, self._per_address = total, per_address
        self._held: dict[object, tuple[str, int]] = {}

    @property
    def count(self) -> int:
        """Number of trees of all forests, also of those that are being created."""
        return sum(trees for _, trees in self._held.values())

    def reserve(self, forest: object, address: str, trees: int) -> None:
        """Reserve the trees of a forest, in place of those it has. SessionError if there are too many."""
        others = [held for key, held in self._held.items() if key is not forest]
        if trees and sum(count for _, count in others) + trees > self._total:
            raise SessionError(
                "server-full", "This server has reached its tree limit", "Try again later.", TRY_AGAIN_LATER
            )
        if trees and sum(count for held, count in others if held == address) + trees > self._per_address:
            raise SessionError(
                "address-full",
                f"One address may have up to {self._per_address} streamed trees",
                "Close other forests, stream fewer trees, or play the tables in the browser.",
                TRY_AGAIN_LATER,
            )
        self._held[forest] = (address, trees)

    def held(self, forest: object) -> tuple[str, int] | None:
        """Address and number of trees of a forest."""
        return self._held.get(forest)

    def restore(self, forest: object, held: tuple[str, int] | None) -> None:
        """Set what `held` returned before: None releases the forest's trees."""
        if held is None:
            self._held.pop(forest, None)
        else:
            self._held[forest] = held


class WorkRates:
    """Work per second by address, in trees: a request beyond the rate waits, or is refused."""

    def __init__(self, trees_per_s: float) -> None:
        self._rate = trees_per_s
        self._left: dict[str, tuple[float, float]] = {}
        """By address: work left, negative if it was used in advance, and when that was."""

    async def take(self, address: str, work: int) -> None:
        """Wait until the address may have this work done. SessionError if that takes too long.

        One request alone is never refused, however large: it only delays the next.
        """
        wait_s = self._use(address, work, time.monotonic())
        if wait_s > 0:
            await asyncio.sleep(wait_s)

    def _use(self, address: str, work: int, now_s: float) -> float:
        """Take work from what is left and return for how long to wait before, s. SessionError."""
        burst = BURST_S * self._rate
        left, then_s = self._left.get(address, (burst, now_s))
        left = min(burst, left + (now_s - then_s) * self._rate)
        wait_s = max(0.0, -left / self._rate)
        if wait_s > LONGEST_WAIT_S:
            raise SessionError(
                "too-much-work",
                f"This address requests more than {self._rate:g} trees per second",
                "Wait a few seconds, then connect again.",
            )
        self._forget(now_s)
        self._left[address] = (left - work, now_s)
        return wait_s

    def _forget(self, now_s: float) -> None:
        """Forget addresses that have used nothing for so long that all is left to them again."""
        if len(self._left) < MOST_ADDRESSES:
            return
        full = BURST_S * self._rate
        self._left = {
            address: (left, then_s)
            for address, (left, then_s) in self._left.items()
            if left + (now_s - then_s) * self._rate < full
        }
