"""Prometheus metrics of HTTP requests and uploads."""

from __future__ import annotations

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Histogram,
    Info,
    PlatformCollector,
    ProcessCollector,
    generate_latest,
)

DURATION_BUCKETS_S = (0.005, 0.02, 0.05, 0.1, 0.3, 1, 3, 10, 30, 60)


class Metrics:
    """The metrics of one application, in a separate registry."""

    def __init__(self, version: str) -> None:
        self.registry = CollectorRegistry()
        ProcessCollector(registry=self.registry)
        PlatformCollector(registry=self.registry)
        Info("galewood", "Software version", registry=self.registry).info({"version": version})
        self._requests = Counter(
            "galewood_http_requests",
            "HTTP requests by method, route and status",
            ["method", "route", "status"],
            registry=self.registry,
        )
        self._seconds = Histogram(
            "galewood_http_request_seconds",
            "HTTP request duration in seconds",
            ["method", "route"],
            buckets=DURATION_BUCKETS_S,
            registry=self.registry,
        )
        self.refused = Counter(
            "galewood_refused", "Requests refused by access control", ["reason"], registry=self.registry
        )
        self.uploaded = Counter("galewood_uploaded_bytes", "Bytes of uploaded meshes", registry=self.registry)

    def request(self, method: str, route: str, status: int, seconds: float) -> None:
        """Count a request and its duration."""
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(method, route).observe(seconds)

    def text(self) -> bytes:
        """All metrics in the Prometheus text format."""
        return generate_latest(self.registry)
