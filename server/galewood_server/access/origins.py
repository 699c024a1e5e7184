"""Names under which this server answers, and sites whose pages may use it."""

from __future__ import annotations

import ipaddress
import re
from urllib.parse import urlsplit

from starlette.datastructures import Headers

from galewood_server.http import ProblemError
from galewood_server.settings import Settings

_NAME = r"(?P<name>[a-z0-9_-]+(?:\.[a-z0-9_-]+)*)\.?"
_HOST = re.compile(rf"(?:\[(?P<ipv6>[0-9a-f:.]+)\]|{_NAME})(?::[0-9]{{0,5}})?")


def host_name(host: str) -> str | None:
    """The name or address in a Host header, in lower case, without port, brackets and final dot.

    None if it is malformed.
    """
    found = _HOST.fullmatch(host.lower())
    return (found["ipv6"] or found["name"]) if found else None


def is_loopback(name: str) -> bool:
    """Whether a host name or address is that of the loopback interface."""
    if name == "localhost" or name.endswith(".localhost"):
        return True
    try:
        address = ipaddress.ip_address(name)
    except ValueError:
        return False
    mapped = getattr(address, "ipv4_mapped", None)
    return (mapped or address).is_loopback


def check_host(headers: Headers, settings: Settings) -> None:
    """Raise ProblemError 421 if a server without API keys is addressed by a name that is not its own.

    The page of another site whose name resolves to this server (DNS rebinding) sends requests with that name.
    An address cannot be rebound, and browsers always send a Host header; monitoring with HTTP/1.0 does not.
    """
    given = headers.getlist("host")
    if settings.api_keys or not given:
        return
    name = host_name(given[0]) if len(given) == 1 else None
    if name is None or not (_is_address(name) or is_loopback(name) or name in _own_names(settings)):
        raise ProblemError(
            421,
            "unknown-host",
            "This server does not serve this host name",
            detail=f"The request was sent to {', '.join(given)[:80]!r}.",
            hint="Use localhost or an IP address, or add the origin, e.g. https://trees.example.org, to"
            " GALEWOOD_ALLOWED_ORIGINS.",
        )


def check_origin(headers: Headers, settings: Settings) -> None:
    """Raise ProblemError 403 unless the request is from a page of this server or of a listed origin.

    Clients other than browsers send no Origin header.
    """
    origin = headers.get("origin")
    if origin is None or origin in settings.allowed_origins or _is_same(origin, headers.get("host")):
        return
    raise ProblemError(
        403,
        "foreign-origin",
        "Access from other websites is not allowed",
        detail="The Origin header does not match this server.",
        hint="Add the origin to GALEWOOD_ALLOWED_ORIGINS.",
    )


def _is_same(origin: str, host: str | None) -> bool:
    try:
        return bool(host) and urlsplit(origin).netloc.lower() == str(host).lower()
    except ValueError:  # not a URL, e.g. an unclosed bracket of an IPv6 address
        return False


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _own_names(settings: Settings) -> set[str | None]:
    """Names that the settings give this server: where it listens, its own and trusted origins."""
    urls = [*settings.allowed_origins, settings.peer_url or ""]
    return {settings.host.lower(), *(urlsplit(url).hostname for url in urls)}
