"""REST routes, server-sent events and the forest socket."""

from galewood_server.api.events import ChangeFeed
from galewood_server.api.health import VERSION
from galewood_server.api.metrics import ServiceCollector
from galewood_server.api.routes import ROUTERS

__all__ = ["ROUTERS", "VERSION", "ChangeFeed", "ServiceCollector"]
