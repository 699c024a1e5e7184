"""Finds the server of a shared forest, and keeps the leases of the forests that this server holds."""

from __future__ import annotations

import asyncio
import logging
import time
from collections import Counter
from collections.abc import AsyncGenerator, Callable, Collection
from contextlib import asynccontextmanager
from weakref import WeakValueDictionary

from sqlalchemy.exc import SQLAlchemyError

from galewood_server.peers.forest_leases import Lease, claim_forest, release_forest, renew_forest
from galewood_server.peers.socket_relay import PeerLostError, open_peer
from galewood_server.storage import Sessions, new_id
from galewood_server.stream import TRY_AGAIN_LATER, SessionError

log = logging.getLogger("galewood.stream")
RENEWALS_PER_LEASE = 5
REMEMBERED_S = 0.5
"""For how long the lease of another server is not looked up again: clients come together when one dies."""


class ForestOwners:
    """Runs in the event loop, except for the database. Without `server_url` this server has no peers."""

    def __init__(
        self,
        sessions: Sessions,
        server_url: str | None,
        lease_s: float,
        running: Callable[[], Collection[str]],
        end: Callable[[str], None],
    ) -> None:
        """`running` names the shared forests of this server; `end` ends one that another server has taken."""
        self._sessions, self._url, self._lease_s = sessions, server_url, lease_s
        self._running, self._end = running, end
        self._held: dict[str, str] = {}
        """Tokens by forest."""
        self._wanted: Counter[str] = Counter()
        """Clients that are about to join, or have joined, by forest."""
        self._others: dict[str, tuple[Lease, float]] = {}
        """Leases of other servers by forest, and when they were looked up."""
        self._locks = WeakValueDictionary[str, asyncio.Lock]()
        """By forest: of several clients that come at once, one claims it."""

    @asynccontextmanager
    async def wanted(self, share: str | None) -> AsyncGenerator[None]:
        """Keep the lease of a forest while the block runs, if this server has it."""
        if share is None or self._url is None:
            yield
            return
        self._wanted[share] += 1
        try:
            yield
        finally:
            self._wanted[share] -= 1
            if not self._wanted[share]:
                del self._wanted[share]

    async def elsewhere(self, share: str | None, lost: str | None = None) -> Lease | None:
        """The lease of another server that holds a forest; None if this one does, or has just claimed it.

        `lost` is the token of a lease whose server does not answer. Call it within `wanted`.
        SessionError if the database does not answer.
        """
        if share is None or self._url is None or share in self._held:
            return None
        lock = self._locks.setdefault(share, asyncio.Lock())
        async with lock:
            if share in self._held:
                return None
            remembered = self._remembered(share)
            if remembered and remembered.token != lost:
                return remembered
            try:
                lease = await asyncio.to_thread(self._claim, share, self._url, lost)
            except (SQLAlchemyError, RuntimeError) as error:
                log.warning("the server of the shared forest %s was not found: %s", share, error)
                raise SessionError(
                    "no-owner",
                    "The server of this shared forest was not found",
                    "Try again.",
                    TRY_AGAIN_LATER,
                ) from None
            if not lease.mine:
                self._others[share] = (lease, time.monotonic())
                return lease
            self._held[share] = lease.token
            return None

    async def warm_up(self) -> None:
        """Do what a client will wait for, once: connections and modules are then ready."""
        if self._url is None:
            return
        share = f"warm-up-{new_id()}"
        try:
            async with self.wanted(share):
                await self.elsewhere(share)
            self._release({share: self._held.pop(share)})
            await open_peer(self._url, share, "")  # nobody listens yet
        except (SessionError, PeerLostError):
            pass

    async def run(self) -> None:
        """Renew the leases in use and release the others, until cancelled; then release all."""
        if self._url is None:
            return
        try:
            while True:
                await asyncio.sleep(self._lease_s / RENEWALS_PER_LEASE)
                try:
                    await self._renew()
                except SQLAlchemyError as error:
                    log.warning("leases of shared forests were not renewed: %s", error)
        finally:
            held, self._held = self._held, {}
            self._release(held)

    def _remembered(self, share: str) -> Lease | None:
        """The lease of another server, if it was looked up a moment ago."""
        now_s = time.monotonic()
        self._others = {
            name: known for name, known in self._others.items() if now_s - known[1] < REMEMBERED_S
        }
        return self._others[share][0] if share in self._others else None

    async def _renew(self) -> None:
        unused = {
            share: self._held.pop(share)
            for share in set(self._held) - set(self._running()) - set(self._wanted)
        }
        if unused:
            await asyncio.to_thread(self._release, unused)
        for share in await asyncio.to_thread(self._lost, dict(self._held)):
            if self._held.pop(share, None):
                log.warning("another server has taken the shared forest %s", share)
                self._end(share)

    # ---- in a thread ---------------------------------------------------------------------------------

    def _claim(self, share: str, server_url: str, lost: str | None) -> Lease:
        with self._sessions() as session:
            return claim_forest(session, share, server_url, self._lease_s, lost)

    def _lost(self, held: dict[str, str]) -> list[str]:
        with self._sessions() as session:
            return [
                share
                for share, token in held.items()
                if not renew_forest(session, share, token, self._lease_s)
            ]

    def _release(self, held: dict[str, str]) -> None:
        with self._sessions() as session:
            for share, token in held.items():
                release_forest(session, share, token)
