"""Compiles the numeric kernels when a server starts for the first time. Its first visitors need none."""

from __future__ import annotations

import asyncio
import logging

from galewood.util import kernels_compiled

from galewood_server.jobs import start_module
from galewood_server.settings import Settings

log = logging.getLogger("galewood")


async def compile_kernels(settings: Settings) -> None:
    """Compile the kernels in a child process, unless they are compiled. A build that starts then waits."""
    if not settings.prepare or await asyncio.to_thread(kernels_compiled):
        return
    log.info("compiling the numeric kernels, once on this machine; builds wait for them")
    process = await start_module(
        "galewood.pipeline.stages.kernel_compilation", environment=settings.environment()
    )
    try:
        await process.wait()
    finally:
        await process.stop()
    if process.returncode == 0:
        log.info("the numeric kernels are compiled")
    else:
        log.warning("the numeric kernels could not be compiled: the first build compiles them")
