"""Origin check for requests from browsers."""

from __future__ import annotations

from urllib.parse import urlsplit


def origin_allowed(origin: str | None, host: str | None, allowed: list[str]) -> bool:
    """Whether an Origin header is this server or listed in `allowed`; non-browser clients send none."""
    if origin is None or origin in allowed:
        return True
    try:
        return bool(host) and urlsplit(origin).netloc.lower() == str(host).lower()
    except ValueError:  # not a URL, e.g. an unclosed bracket of an IPv6 address
        return False
