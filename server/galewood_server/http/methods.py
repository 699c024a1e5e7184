"""HTTP methods: HEAD wherever GET works, and a complete Allow header."""

from __future__ import annotations

from collections.abc import Sequence

from fastapi import APIRouter
from fastapi.routing import APIRoute
from sse_starlette import EventSourceResponse
from starlette.responses import Response
from starlette.routing import BaseRoute, Match, Route
from starlette.types import Scope

EVENT_STREAM = "text/event-stream"


def with_head_routes(router: APIRouter) -> APIRouter:
    """The router, with a route for HEAD for each for GET that has none.

    The server sends the headers of the response to GET and leaves out its body (RFC 9110, section 9.3.2).
    """
    known = [route for route in router.routes if isinstance(route, APIRoute)]
    paths = {
        method: [route for route in known if method in (route.methods or ())] for method in ("GET", "HEAD")
    }
    has_head = {route.path for route in paths["HEAD"]}
    router.routes += [_head_route(route) for route in paths["GET"] if route.path not in has_head]
    return router


def _head_route(route: APIRoute) -> APIRoute:
    endless = route.response_class is EventSourceResponse
    return APIRoute(
        route.path,
        _no_events if endless else route.endpoint,
        methods=["HEAD"],
        include_in_schema=False,
        response_model=None if endless else route.response_model,
        response_class=route.response_class,
        status_code=route.status_code,
        dependencies=route.dependencies,
    )


def _no_events() -> Response:
    """The headers of an event stream, which would never end."""
    return Response(media_type=EVENT_STREAM, headers={"Cache-Control": "no-store"})


def allowed_methods(routes: Sequence[BaseRoute], scope: Scope) -> str:
    """All methods of the routes that match a path, for the Allow header (RFC 9110, section 10.2.1)."""
    methods: set[str] = set()
    for route in routes:
        if isinstance(route, Route) and route.matches(scope)[0] is not Match.NONE:
            methods |= route.methods or set()
    return ", ".join(sorted(methods or {"GET", "HEAD"}))
