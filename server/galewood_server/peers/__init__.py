"""Several servers with one database: which of them holds a shared forest, and how its clients get there."""

from galewood_server.peers.forest_owners import ForestOwners
from galewood_server.peers.peer_search import peer_of
from galewood_server.peers.socket_relay import RELAYED_HEADER, SERVICE_RESTART, PeerLostError, relay

__all__ = ["RELAYED_HEADER", "SERVICE_RESTART", "ForestOwners", "PeerLostError", "peer_of", "relay"]
