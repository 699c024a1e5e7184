"""How often one address may ask: a sliding window a minute long, in the memory of this process."""

from __future__ import annotations

import ipaddress
import time

from limits import RateLimitItemPerMinute
from limits.aio.storage import MemoryStorage
from limits.aio.strategies import SlidingWindowCounterRateLimiter

from galewood_server.http import ProblemError
from galewood_server.settings import Settings

WRONG_KEYS_PER_MINUTE = 20


class Rates:
    """Counts reads, writes and wrong keys by address."""

    def __init__(self, settings: Settings) -> None:
        self._limiter = SlidingWindowCounterRateLimiter(MemoryStorage())
        per_minute = {
            "read": settings.reads_per_minute,
            "write": settings.writes_per_minute,
            "wrong-key": WRONG_KEYS_PER_MINUTE,
        }
        self._items = {kind: RateLimitItemPerMinute(count) for kind, count in per_minute.items() if count}

    async def count(self, kind: str, address: str) -> None:
        """Count one more; ProblemError 429 with Retry-After if there were too many."""
        item = self._items.get(kind)
        if item and not await self._limiter.hit(item, kind, neighbourhood(address)):
            await self._refuse(kind, address)

    async def check(self, kind: str, address: str) -> None:
        """As `count`, without counting."""
        item = self._items.get(kind)
        if item and not await self._limiter.test(item, kind, neighbourhood(address)):
            await self._refuse(kind, address)

    async def _refuse(self, kind: str, address: str) -> None:
        item = self._items[kind]
        window = await self._limiter.get_window_stats(item, kind, neighbourhood(address))
        wait_s = max(1, round(window.reset_time - time.time()))
        raise ProblemError(
            429,
            "too-many-requests",
            "Too many requests from this address",
            detail=f"{item.amount} a minute are allowed ({kind}).",
            hint=f"Try again in {wait_s} s.",
            headers={"Retry-After": str(wait_s)},
        )


def neighbourhood(address: str) -> str:
    """An IPv4 address, or the /64 that an IPv6 customer has to itself."""
    try:
        parsed = ipaddress.ip_address(address)
    except ValueError:
        return address
    if parsed.version == 4:
        return address
    return str(ipaddress.ip_network((parsed, 64), strict=False))
