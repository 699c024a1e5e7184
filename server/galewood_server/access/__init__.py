"""Access control: keys, origins, rate and connection limits, quotas, limits on mesh import."""

from galewood_server.access.import_limits import LimitedImporter, MeshImporter
from galewood_server.access.keys import READ_ONLY_POSTS, WRITE_METHODS, new_key
from galewood_server.access.middleware import AccessControl
from galewood_server.access.open_connections import OpenConnections, count_open, limited_by_descriptors
from galewood_server.access.origins import is_loopback
from galewood_server.access.quota import check_quota, count_stored, stored_bytes
from galewood_server.access.rates import client_key
from galewood_server.access.request_turns import RequestTurns
from galewood_server.access.turns import FilesOnDemand, Turns

__all__ = [
    "READ_ONLY_POSTS",
    "WRITE_METHODS",
    "AccessControl",
    "FilesOnDemand",
    "LimitedImporter",
    "MeshImporter",
    "OpenConnections",
    "RequestTurns",
    "Turns",
    "check_quota",
    "client_key",
    "count_open",
    "count_stored",
    "is_loopback",
    "limited_by_descriptors",
    "new_key",
    "stored_bytes",
]
