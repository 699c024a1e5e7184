"""Warnings about the configuration, logged at startup."""

from __future__ import annotations

import logging

from galewood_server.access import is_loopback
from galewood_server.settings import Settings

log = logging.getLogger("galewood")


def log_startup_warnings(settings: Settings) -> None:
    """Log missing API keys and sandbox features that this machine does not support."""
    from galewood.sandbox import unavailable_restrictions

    if not settings.api_keys and not is_loopback(settings.host):
        log.warning(
            "GALEWOOD_API_KEYS is not set: remote clients may only read, under this server's IP address or"
            " a name in GALEWOOD_ALLOWED_ORIGINS"
        )
    for line in unavailable_restrictions():
        log.warning("meshes are imported with reduced sandboxing: %s", line)
