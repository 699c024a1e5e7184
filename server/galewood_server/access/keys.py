"""Who may write: holders of a key, or, where no keys are set, programs and pages of this very machine."""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
import secrets

from starlette.datastructures import Headers
from starlette.types import Scope

from galewood_server.access.origins import origin_allowed
from galewood_server.http import ProblemError
from galewood_server.settings import Settings

UNSAFE = frozenset({"POST", "PUT", "PATCH", "DELETE"})
HARMLESS = frozenset({"/api/winds/validate"})  # asked by POST, for the body's sake, but changes nothing
FORWARDED = ("forwarded", "x-forwarded-for", "x-forwarded-host", "x-real-ip", "via")


def new_key() -> tuple[str, str]:
    """A fresh key and its SHA-256 for GALEWOOD_API_KEYS."""
    key = f"gw_{secrets.token_urlsafe(32)}"
    return key, key_hash(key)


def key_hash(key: str) -> str:
    """What the settings hold of a key. Keys are long and random, so a plain hash cannot be turned back."""
    return hashlib.sha256(key.encode()).hexdigest()


def is_write(scope: Scope) -> bool:
    """Whether a request changes something."""
    path = scope["path"]
    return scope["method"] in UNSAFE and path.startswith("/api/") and path not in HARMLESS


def check_writer(scope: Scope, settings: Settings) -> None:
    """ProblemError 401 or 403 unless the request may write."""
    headers = Headers(scope=scope)
    if not origin_allowed(headers.get("origin"), headers.get("host"), settings.allowed_origins):
        raise ProblemError(
            403,
            "foreign-origin",
            "Pages of other sites may not change anything here",
            detail="The Origin header names another site.",
            hint="Add the origin to GALEWOOD_ALLOWED_ORIGINS.",
        )
    if settings.api_keys:
        _check_key(headers, settings.api_keys)
    elif not _is_this_machine(scope, headers):
        raise ProblemError(
            403,
            "local-only",
            "Only programs on the server's own machine may change anything",
            hint="The operator can set GALEWOOD_API_KEYS, so that holders of a key may.",
        )


def _check_key(headers: Headers, hashes: list[str]) -> None:
    scheme, _, key = headers.get("authorization", "").partition(" ")
    given = key_hash(key.strip()) if scheme.lower() == "bearer" else ""
    # every hash is compared, in the same time whatever was given
    if sum(hmac.compare_digest(given, one) for one in hashes) == 0:
        raise ProblemError(
            401,
            "key-needed",
            "This needs a key",
            detail="The Authorization header holds no key that is known here.",
            hint="Send 'Authorization: Bearer KEY'; the operator hands out keys.",
            headers={"WWW-Authenticate": 'Bearer realm="galewood"'},
        )


def _is_this_machine(scope: Scope, headers: Headers) -> bool:
    """A direct connection over the loopback, to a name of it: what a proxy passes on comes from elsewhere,
    and a foreign name that leads here is a page that tricks the browser (DNS rebinding)."""
    client = scope.get("client")
    if client is None or not _is_loopback(client[0]) or any(name in headers for name in FORWARDED):
        return False
    return _is_loopback(_host_name(headers.get("host", "")))


def _host_name(host: str) -> str:
    return host[1 : host.find("]")] if host.startswith("[") else host.rsplit(":", 1)[0]


def _is_loopback(name: str) -> bool:
    if name == "localhost" or name.endswith(".localhost"):
        return True
    try:
        address = ipaddress.ip_address(name)
    except ValueError:
        return False
    mapped = getattr(address, "ipv4_mapped", None)
    return (mapped or address).is_loopback
