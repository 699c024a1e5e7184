"""The embedded cluster, as a child process of the server (see dask_cluster.py)."""

from __future__ import annotations

import asyncio
import json
import time

from galewood_server.jobs.processes import start_module, stop
from galewood_server.settings import Settings

START_S = 90.0
CLOSE_S = 3.0


class ClusterError(Exception):
    """The cluster could not be started."""


class Cluster:
    """An embedded cluster, started on demand and closed when idle, or an external one by its URL."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._process: asyncio.subprocess.Process | None = None
        self._address = ""
        self._starting = asyncio.Lock()
        self._used_s = time.monotonic()

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
        assert process.stdout
        try:
            async with asyncio.timeout(START_S):
                line = await process.stdout.readline()
            self._address = str(json.loads(line)["address"])
        except (TimeoutError, ValueError, KeyError) as error:
            await stop(process)
            raise ClusterError("the simulation workers could not be started") from error
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
            await stop(self._process, CLOSE_S)
            self._process = None
