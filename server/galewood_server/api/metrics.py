"""GET /metrics: counters and gauges in Prometheus' text format."""

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
from galewood_server.context import Service, ServiceHere
from galewood_server.ops import Metrics
from galewood_server.storage import Job, Tree

router = APIRouter(tags=["service"])


class ServiceCollector(Collector):
    """What is counted at the moment of asking: rows, sockets, disk."""

    def __init__(self, service: Service) -> None:
        self._service = service

    def describe(self) -> Iterable[GaugeMetricFamily]:
        """Nothing in advance: a registry may not ask the database before it is there."""
        return []

    def collect(self) -> Iterator[GaugeMetricFamily]:
        """Gauges of trees, jobs, sockets and disk."""
        service = self._service
        yield _by_label("galewood_trees", "Trees", "builtin", self._count(Tree.builtin))
        yield _by_label("galewood_jobs", "Jobs", "state", self._count(Job.state))
        yield GaugeMetricFamily("galewood_sockets", "Open WebSockets", service.sockets)
        yield GaugeMetricFamily("galewood_stored_bytes", "Bytes stored", stored_bytes(service.settings))
        free = shutil.disk_usage(service.settings.data_dir).free
        yield GaugeMetricFamily("galewood_disk_free_bytes", "Free on the disk of the data folder", free)

    def _count(self, column: InstrumentedAttribute[Any]) -> dict[str, int]:
        with self._service.sessions() as session:
            rows = session.execute(select(column, func.count()).group_by(column)).tuples()
            return {str(value).lower(): count for value, count in rows}


def _by_label(name: str, what: str, label: str, counts: dict[str, int]) -> GaugeMetricFamily:
    family = GaugeMetricFamily(name, what, labels=[label])
    for value, count in sorted(counts.items()):
        family.add_metric([value], count)
    return family


@router.get("/metrics", response_class=Response)
def metrics(request: Request, service: ServiceHere) -> Response:
    """Figures in Prometheus' text format. Not for the open web: the proxy keeps it to itself."""
    found: Metrics = request.app.state.metrics
    return Response(found.text(), media_type=CONTENT_TYPE_LATEST)
