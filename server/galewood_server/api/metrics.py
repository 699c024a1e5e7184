"""GET /metrics: counters and gauges in the Prometheus text format."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator
from typing import Any

from fastapi import APIRouter, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.registry import Collector
from sqlalchemy import func, select
from sqlalchemy.orm import InstrumentedAttribute

from galewood_server.access import stored_bytes
from galewood_server.context import Service, ServiceDep
from galewood_server.http import contents
from galewood_server.ops import Metrics
from galewood_server.storage import Job, Tree

router = APIRouter(tags=["service"])


class ServiceCollector(Collector):
    """Gauges measured at each scrape: database rows, open sockets and disk usage."""

    def __init__(self, service: Service) -> None:
        self._service = service

    def describe(self) -> Iterable[GaugeMetricFamily]:
        """No descriptions: the registry must not query the database at registration."""
        return []

    def collect(self) -> Iterator[GaugeMetricFamily]:
        """Gauges of trees, jobs, sockets and disk usage."""
        service = self._service
        yield _labelled_gauge("galewood_trees", "Number of trees", "builtin", self._count(Tree.builtin))
        yield _labelled_gauge("galewood_jobs", "Number of jobs", "state", self._count(Job.state))
        yield GaugeMetricFamily("galewood_sockets", "Number of open WebSockets", service.sockets)
        yield GaugeMetricFamily(
            "galewood_event_streams", "Number of open event streams", service.event_streams
        )
        yield GaugeMetricFamily(
            "galewood_stored_bytes", "Bytes in the data folder", stored_bytes(service.settings)
        )
        free = shutil.disk_usage(service.settings.data_dir).free
        yield GaugeMetricFamily("galewood_disk_free_bytes", "Free bytes on the disk of the data folder", free)

    def _count(self, column: InstrumentedAttribute[Any]) -> dict[str, int]:
        with self._service.sessions() as session:
            rows = session.execute(select(column, func.count()).group_by(column)).tuples()
            return {str(value).lower(): count for value, count in rows}


def _labelled_gauge(name: str, help_text: str, label: str, counts: dict[str, int]) -> GaugeMetricFamily:
    family = GaugeMetricFamily(name, help_text, labels=[label])
    for value, count in sorted(counts.items()):
        family.add_metric([value], count)
    return family


@router.get("/metrics", response_class=Response, responses=contents("The metrics.", "text/plain"))
def metrics(request: Request, service: ServiceDep) -> Response:
    """Metrics in the Prometheus text format. A public proxy must not forward this path."""
    found: Metrics = request.app.state.metrics
    return Response(found.text(), media_type=CONTENT_TYPE_LATEST)
