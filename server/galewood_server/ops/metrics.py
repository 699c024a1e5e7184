"""Figures for Prometheus: what was asked, what waits, what is kept."""

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

SECONDS = (0.005, 0.02, 0.05, 0.1, 0.3, 1, 3, 10, 30, 60)


class Metrics:
    """The figures of one application, in a registry of its own."""

    def __init__(self, version: str) -> None:
        self.registry = CollectorRegistry()
        ProcessCollector(registry=self.registry)
        PlatformCollector(registry=self.registry)
        Info("galewood", "The software", registry=self.registry).info({"version": version})
        self._requests = Counter(
            "galewood_http_requests",
            "Requests answered",
            ["method", "route", "status"],
            registry=self.registry,
        )
        self._seconds = Histogram(
            "galewood_http_request_seconds",
            "Time to answer",
            ["method", "route"],
            buckets=SECONDS,
            registry=self.registry,
        )
        self.refused = Counter(
            "galewood_refused", "Requests turned away at the door", ["reason"], registry=self.registry
        )
        self.uploaded = Counter("galewood_uploaded_bytes", "Bytes of meshes taken in", registry=self.registry)

    def request(self, method: str, route: str, status: int, seconds: float) -> None:
        """Count a request."""
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(method, route).observe(seconds)

    def text(self) -> bytes:
        """Everything, in the exposition format."""
        return generate_latest(self.registry)
