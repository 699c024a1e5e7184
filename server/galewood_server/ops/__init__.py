"""Logs, metrics and request tracing."""

from galewood_server.ops.logs import configure_logging
from galewood_server.ops.metrics import Metrics
from galewood_server.ops.throttle import Throttle
from galewood_server.ops.tracing import Tracing

__all__ = ["Metrics", "Throttle", "Tracing", "configure_logging"]
