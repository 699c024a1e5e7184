"""Finds the way to the server that holds a shared forest."""

from __future__ import annotations

import logging

from websockets.asyncio.client import ClientConnection

from galewood_server.peers.forest_owners import ForestOwners
from galewood_server.peers.socket_relay import PeerLostError, open_peer

log = logging.getLogger("galewood.stream")
TAKEN_FOR_DEAD = 2
"""How many servers one after the other, before the client has to try again."""


async def peer_of(
    owners: ForestOwners, share: str | None, address: str, relayed: bool
) -> ClientConnection | None:
    """A socket to the server that holds a forest; None if it is this one. PeerLostError, SessionError.

    If that server does not answer, this one takes the forest. Call it within `owners.wanted`.
    """
    lease, attempts = await owners.elsewhere(share), 0
    while lease is not None and share is not None:
        if relayed or attempts == TAKEN_FOR_DEAD:
            raise PeerLostError(f"the shared forest {share} has moved to {lease.server_url}")
        try:
            return await open_peer(lease.server_url, share, address)
        except PeerLostError as error:
            log.warning(
                "%s does not respond (%s): taking over the shared forest %s", lease.server_url, error, share
            )
        lease, attempts = await owners.elsewhere(share, lost=lease.token), attempts + 1
    return None
