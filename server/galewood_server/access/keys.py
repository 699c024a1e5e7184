"""Write access: clients with an API key or, if none is configured, clients on the server's own machine."""

from __future__ import annotations

import hashlib
import hmac
import secrets

from starlette.datastructures import Headers
from starlette.types import Scope

from galewood_server.access.origins import check_origin, host_name, is_loopback
from galewood_server.http import ProblemError
from galewood_server.settings import Settings

WRITE_METHODS = frozenset({"POST", "PUT", "PATCH", "DELETE"})
READ_ONLY_POSTS = frozenset(
    {"/api/winds/validate", "/api/convert", "/api/stand-risk", "/api/individuals/find"}
)
"""POST only because of their bodies."""
FORWARDED_HEADERS = frozenset(
    {
        "forwarded", "via", "x-real-ip", "x-client-ip", "x-cluster-client-ip", "x-original-host",
        "true-client-ip", "cf-connecting-ip", "fastly-client-ip", "fly-client-ip",
    }
)  # fmt: skip
"""Headers that proxies add, besides X-Forwarded-…."""


def new_key() -> tuple[str, str]:
    """A new random key and its SHA-256 hash for GALEWOOD_API_KEYS."""
    key = f"gw_{secrets.token_urlsafe(32)}"
    return key, key_hash(key)


def key_hash(key: str) -> str:
    """SHA-256 of a key, as stored in the settings. Keys have 256 random bits, so no salt is needed."""
    return hashlib.sha256(key.encode()).hexdigest()


def is_write(scope: Scope) -> bool:
    """Whether a request needs write access."""
    path = scope["path"]
    return scope.get("method") in WRITE_METHODS and path.startswith("/api/") and path not in READ_ONLY_POSTS


def check_writer(scope: Scope, settings: Settings) -> None:
    """Raise ProblemError 401 or 403 unless the request has write access."""
    headers = Headers(scope=scope)
    check_origin(headers, settings)
    if settings.api_keys:
        _check_key(headers, settings.api_keys)
    elif not settings.local_writes or not _is_local(scope, headers):
        raise ProblemError(
            403,
            "local-only",
            "Write access is limited to the server's own machine",
            hint="To allow remote clients, the operator must configure GALEWOOD_API_KEYS.",
        )


def _check_key(headers: Headers, hashes: list[str]) -> None:
    scheme, _, key = headers.get("authorization", "").partition(" ")
    given = key_hash(key.strip()) if scheme.lower() == "bearer" else ""
    # compare with every hash in constant time
    if sum(hmac.compare_digest(given, one) for one in hashes) == 0:
        raise ProblemError(
            401,
            "key-needed",
            "An API key is required",
            detail="The Authorization header is missing or its key is not valid.",
            hint="Send 'Authorization: Bearer KEY' with a key from the operator.",
            headers={"WWW-Authenticate": 'Bearer realm="galewood"'},
        )


def _is_local(scope: Scope, headers: Headers) -> bool:
    """Whether the client connected directly over the loopback interface, using a loopback host name.

    Requests forwarded by a proxy count as remote. The host name is checked against DNS rebinding. A proxy on
    this machine may hide behind both: nginx by default rewrites Host and adds no header, but then it speaks
    HTTP/1.0, which no browser does.
    """
    client = scope.get("client")
    if client is None or not is_loopback(client[0]) or scope.get("http_version") == "1.0":
        return False
    if any(name in FORWARDED_HEADERS or name.startswith("x-forwarded-") for name in headers):
        return False
    return is_loopback(host_name(headers.get("host", "")) or "")
