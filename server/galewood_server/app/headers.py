"""Security headers: content security policy and cross-origin isolation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

# The page needs its own module scripts, a worker, textures from blobs and WebAssembly decoders. The panel
# library and the page itself set inline styles.
PAGE_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self' 'wasm-unsafe-eval'",
        "worker-src 'self' blob:",
        "connect-src 'self' data: blob:",
        "img-src 'self' data: blob:",
        "style-src 'self' 'unsafe-inline'",
        "font-src 'self' data:",
        "media-src 'self'",
        "manifest-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
    )
)
DATA_POLICY = "default-src 'none'; frame-ancestors 'none'; sandbox"
# Swagger UI (docs_page.py) has icons in its style sheet and styles in its script
DOCS_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data:",
        "connect-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
COMMON_HEADERS: Mapping[str, str] = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=(), payment=(), usb=()",
}


def page_policy(frame_ancestors: Sequence[str] = ()) -> str:
    """The Content-Security-Policy of the page, which these origins may show in a frame."""
    return "; ".join((PAGE_POLICY, " ".join(("frame-ancestors 'self'", *frame_ancestors))))


def policy_of(path: str, frame_ancestors: Sequence[str] = ()) -> str:
    """The Content-Security-Policy of a path."""
    if path == "/docs" or path.startswith("/docs/"):
        return DOCS_POLICY
    data = path.startswith(("/api/", "/metrics", "/healthz", "/openapi.json"))
    return DATA_POLICY if data else page_policy(frame_ancestors)


class SecurityHeaders:
    """ASGI middleware that adds the security headers to every response unless the route has set them.

    With `varies_by_origin`, caches learn that responses differ by origin, also those to requests without one.
    """

    def __init__(
        self, app: ASGIApp, frame_ancestors: Sequence[str] = (), varies_by_origin: bool = False
    ) -> None:
        self._app = app
        self._frame_ancestors = frame_ancestors
        self._varies_by_origin = varies_by_origin

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request and add the headers to its response."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_response(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in COMMON_HEADERS.items():
                    headers.setdefault(name, value)
                headers.setdefault("Content-Security-Policy", policy_of(scope["path"], self._frame_ancestors))
                if self._varies_by_origin:
                    headers.add_vary_header("Origin")
                if scope["path"].startswith("/api/"):
                    headers.setdefault("Cache-Control", "no-store")
            await send(message)

        await self._app(scope, receive, send_response)
