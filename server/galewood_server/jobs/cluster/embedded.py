"""The embedded cluster, as a child process of the server (see dask_cluster.py)."""

from __future__ import annotations

import asyncio
import json
import time

from galewood_server.jobs.processes import ChildProcess, start_module
from galewood_server.settings import Settings

START_S = 90.0


class ClusterError(Exception):
    """The cluster could not be started."""


class Cluster:
    """An embedded cluster, started on demand and closed when idle, or an external one by its URL."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._process: ChildProcess | None = None
        self._address = ""
        self._starting = asyncio.Lock()
        self._used_s = time.monotonic()

    @property
    def external(self) -> bool:
        """Whether the cluster is operated by someone else."""
        return self._settings.scheduler_url is not None

    async def address(self) -> str:
        """The scheduler's address. Starts or restarts the embedded cluster if necessary. ClusterError."""
        if self._settings.scheduler_url:
            return self._settings.scheduler_url
        async with self._starting:
            if self._process is None or self._process.returncode is not None:
                await self._start()
        self._used_s = time.monotonic()
        return self._address

    async def _start(self) -> None:
        arguments = (
            "--workers",
            str(self._settings.workers),
            "--folder",
            str(self._settings.cache_dir / "dask"),
        )
        environment = self._settings.environment()
        process = await start_module(
            "galewood_server.jobs.cluster.dask_cluster", *arguments, environment=environment, listen=True
        )
        try:
            async with asyncio.timeout(START_S):
                line = await process.read_line()
            self._address = str(json.loads(line)["address"])
        except BaseException as error:  # including the end of the server meanwhile
            await process.stop()
            if isinstance(error, (TimeoutError, ValueError, KeyError)):
                raise ClusterError("the simulation workers could not be started") from error
            raise
        self._process = process

    @property
    def lost(self) -> bool:
        """Whether the embedded cluster ended unexpectedly."""
        return self._process is not None and self._process.returncode is not None

    async def close_if_idle(self, busy: bool) -> None:
        """Close the embedded cluster if no job has used it for `cluster_idle_s`."""
        now_s = time.monotonic()
        self._used_s = now_s if busy else self._used_s
        if self._process and now_s - self._used_s > self._settings.cluster_idle_s:
            await self.close()

    async def close(self) -> None:
        """End the embedded cluster."""
        if self._process:
            await self._process.stop()
            self._process = None


class Handover:
    """Starts the cluster for a job process that is already running, and sends it the address."""

    def __init__(self, cluster: Cluster, process: ChildProcess) -> None:
        self._cluster = cluster
        self._process = process
        self._task: asyncio.Task[None] | None = None
        if cluster.external:
            self.start()

    def start(self) -> None:
        """Start the cluster, once."""
        if self._task is None:
            self._task = asyncio.create_task(self._send())

    async def _send(self) -> None:
        self._process.send_line(await self._cluster.address())

    @property
    def lost(self) -> bool:
        """Whether the cluster ended unexpectedly after the job got its address. ClusterError."""
        if self._task is None or not self._task.done():
            return False
        self._task.result()
        return self._cluster.lost

    async def close(self) -> None:
        """Stop waiting for the cluster; one that is starting for this job alone has ended afterwards."""
        if self._task:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
