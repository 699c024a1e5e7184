"""What an operator should know at the start, said once in the log."""

from __future__ import annotations

import ipaddress
import logging

from galewood_server.settings import Settings

log = logging.getLogger("galewood")


def tell(settings: Settings) -> None:
    """Warn of doors that stand open and of locks that this machine lacks."""
    from galewood.sandbox import missing_here

    if not settings.api_keys and not _loopback(settings.host):
        log.warning("no GALEWOOD_API_KEYS: others can look, but only this machine can change anything")
    for line in missing_here():
        log.warning("uploads are read with less protection: %s", line)


def _loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
