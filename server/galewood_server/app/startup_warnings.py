"""Warnings about the configuration, logged at startup."""

from __future__ import annotations

import ipaddress
import logging

from galewood_server.settings import Settings

log = logging.getLogger("galewood")


def log_startup_warnings(settings: Settings) -> None:
    """Log missing API keys and sandbox features that this machine does not support."""
    from galewood.sandbox import missing_here

    if not settings.api_keys and not _loopback(settings.host):
        log.warning("GALEWOOD_API_KEYS is not set: remote clients have read access only")
    for line in missing_here():
        log.warning("meshes are imported with reduced sandboxing: %s", line)


def _loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
