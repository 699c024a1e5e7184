"""Rate limits per client address: a sliding window of one minute, kept in this process's memory."""

from __future__ import annotations

import ipaddress
import logging
import re
import time

from limits import RateLimitItemPerMinute
from limits.aio.storage import MemoryStorage
from limits.aio.strategies import SlidingWindowCounterRateLimiter
from starlette.types import Scope

from galewood_server.http import ProblemError
from galewood_server.settings import Settings

log = logging.getLogger("galewood.access")
WRONG_KEYS_PER_MINUTE, HEALTH_CHECKS_PER_MINUTE = 20, 600
UNKNOWN_ADDRESS = "unknown"
_WITH_PORT = re.compile(r"([0-9.]+):[0-9]{1,5}|\[([^\]]+)\](?::[0-9]{1,5})?")


class RateLimits:
    """Limits reads, health checks, writes and attempts with invalid keys per address."""

    def __init__(self, settings: Settings) -> None:
        self._limiter = SlidingWindowCounterRateLimiter(MemoryStorage())
        per_minute = {
            "read": settings.reads_per_minute,
            "health": HEALTH_CHECKS_PER_MINUTE if settings.reads_per_minute else 0,
            "write": settings.writes_per_minute,
            "wrong-key": WRONG_KEYS_PER_MINUTE,
        }
        self._items = {kind: RateLimitItemPerMinute(count) for kind, count in per_minute.items() if count}

    async def count(self, kind: str, address: str) -> None:
        """Count a request. ProblemError 429 with Retry-After if the limit is exceeded."""
        item = self._items.get(kind)
        if item and not await self._limiter.hit(item, kind, rate_limit_key(address)):
            await self._raise_limited(kind, address)

    async def _raise_limited(self, kind: str, address: str) -> None:
        item = self._items[kind]
        window = await self._limiter.get_window_stats(item, kind, rate_limit_key(address))
        wait_s = max(1, round(window.reset_time - time.time()))
        log.warning("refused requests of %s: more than %d per minute (%s)", address, item.amount, kind)
        raise ProblemError(
            429,
            "too-many-requests",
            "Too many requests from this address",
            detail=f"The limit is {item.amount} per minute ({kind}).",
            hint=f"Try again in {wait_s} s.",
            headers={"Retry-After": str(wait_s)},
        )


def client_address(scope: Scope) -> str:
    """The client's address; empty if it is unknown."""
    return str((scope.get("client") or ("",))[0])


def client_key(scope: Scope) -> str:
    """The `rate_limit_key` of the client of a request or WebSocket."""
    return rate_limit_key(client_address(scope))


def rate_limit_key(address: str) -> str:
    """The IPv4 address, or the /64 network of an IPv6 address, which usually belongs to one customer.

    Whatever else a proxy passes on as X-Forwarded-For has one limit together: new junk in every request would
    otherwise be a new client each time.
    """
    parsed = _parsed(address)
    if parsed is None:
        return UNKNOWN_ADDRESS
    if isinstance(parsed, ipaddress.IPv4Address):
        return str(parsed)
    if parsed.ipv4_mapped:
        return str(parsed.ipv4_mapped)
    return str(ipaddress.ip_network((int(parsed), 64), strict=False))


def _parsed(address: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """An address, which some proxies send with a port; None if it is none."""
    bare = _WITH_PORT.fullmatch(address)
    try:
        return ipaddress.ip_address((bare[1] or bare[2]) if bare else address)
    except ValueError:
        return None
