"""Well-behaved clients, each from its own address. Whatever they are refused is an error."""

from __future__ import annotations

import asyncio
import json
import random
import time
from collections.abc import Awaitable, Callable
from dataclasses import replace

import numpy as np
from galewood.motion.wind import Wind
from galewood_server.stream import wire

from tests.load.report import FrameTimes, Report
from tests.load.wire_client import (
    Refused,
    Target,
    Watcher,
    aborted,
    ask,
    open_socket,
    read_head,
    request_bytes,
)

UNAVAILABLE = (502, 503, 504)
"""What a proxy answers in the place of a server that has just been killed."""
LOST = (OSError, Refused, asyncio.IncompleteReadError, TimeoutError)
Choose = Callable[[], Target]
"""The server for a client's next connection."""


def address_of(kind: int, number: int) -> str:
    """An address for a client: 10.kind.x.y."""
    return f"10.{kind}.{number // 250}.{number % 250 + 1}"


def answered(here: Target, status: int, *wanted: int) -> bool:
    """Whether a status is a good answer; where servers are killed, also a proxy's that none answers."""
    return status in wanted or (here.may_fail and status in UNAVAILABLE)


def planted(table: str, count: int, seed: int, share: str | None = None) -> wire.Forest:
    """A request for a streamed forest."""
    rng = np.random.default_rng(seed)
    trees = rng.uniform([-120, -120, -np.pi, 0.8], [120, 120, np.pi, 1.25], (count, 4)).astype(np.float32)
    wind = Wind(model="spectral").document()
    return wire.Forest("stream", (wire.Group(table, count),), wind, 0.0, None, trees, share=share)


async def watch(target: Choose, report: Report, number: int, trees: int, interval_s: float) -> None:
    """Follow a shared forest, of which ten watchers share one, and connect again if the socket is lost."""
    share, lost_s, times = f"load-{number // 10}", None, FrameTimes()
    report.frame_times.append(times)
    while True:
        here, watcher = target(), None
        try:
            watcher = await open_socket(here, address_of(1, number), share=share)
            watcher.on_frame = times.frame
            watcher.send(replace(planted(here.table, trees, number // 10), share=share))
            with aborted(watcher.writer):
                async with asyncio.TaskGroup() as tasks:
                    tasks.create_task(watcher.follow())
                    tasks.create_task(_count(watcher, report, interval_s, lost_s))
        except* LOST as group:
            report.note("watcher", f"lost, {group.exceptions[0]!r:.60}", expected=here.may_fail)
        if watcher and watcher.frames:
            lost_s = None
        lost_s = lost_s or time.monotonic()
        await asyncio.sleep(0.2)


async def _count(watcher: Watcher, report: Report, interval_s: float, lost_s: float | None) -> None:
    while not watcher.frames:
        await asyncio.sleep(0.05)
    if lost_s is not None:
        report.waits_s.append(time.monotonic() - lost_s)
    while True:
        before, began_s = watcher.frames, time.monotonic()
        await asyncio.sleep(interval_s)
        report.rates_hz.append((watcher.frames - before) / (time.monotonic() - began_s))


async def probe(target: Choose, report: Report) -> None:
    """Ask for the health twice a second and note how long it takes."""
    while True:
        began_s, here = time.monotonic(), target()
        try:
            status, _ = await ask(here, "GET", "/api/health", address_of(2, 1))
            report.note("health", status, expected=answered(here, status, 200))
        except LOST as error:
            report.note("health", repr(error)[:60], expected=here.may_fail)
        report.health_ms.append(1e3 * (time.monotonic() - began_s))
        await asyncio.sleep(0.5)


async def repeatedly(work: Callable[[int], Awaitable[None]], every_s: float) -> None:
    """Do something again and again, at random times."""
    dice, number = random.Random(1), 0
    while True:
        await work(number)
        number += 1
        await asyncio.sleep(every_s * dice.uniform(0.5, 1.5))


def downloads(target: Choose, report: Report) -> Callable[[int], Awaitable[None]]:
    """Download the page, a mesh and a table, each visit from another address."""

    async def visit(number: int) -> None:
        here = target()
        for path in ("/", f"/api/meshes/{here.mesh}", f"/api/tables/{here.table}", "/api/trees"):
            try:
                status, _ = await ask(here, "GET", path, address_of(3, number % 5000))
                kind = path.split("/")[2] if path.count("/") > 1 else path
                report.note("download", f"{kind} {status}", expected=answered(here, status, 200))
            except LOST as error:
                report.note("download", repr(error)[:60], expected=here.may_fail)

    return visit


def uploads(target: Choose, report: Report, mesh: Callable[[int], bytes]) -> Callable[[int], Awaitable[None]]:
    """Upload a mesh, look at it and delete it again."""

    async def upload(number: int) -> None:
        here, where = target(), address_of(4, number % 5000)
        try:
            status, answer = await post_mesh(here, "/api/trees", where, mesh(number))
            report.note("upload", status, expected=answered(here, status, 200, 201))
            if status == 201:
                tree, key = json.loads(answer)["id"], {"Authorization": f"Bearer {here.key}"}
                status, _ = await ask(here, "DELETE", f"/api/trees/{tree}", where, key)
                report.note("delete", status, expected=status == 204)
        except LOST as error:
            report.note("upload", repr(error)[:60], expected=here.may_fail)

    return upload


def builds(target: Choose, report: Report, mesh: Callable[[int], bytes]) -> Callable[[int], Awaitable[None]]:
    """Upload a mesh whose table is computed, and wait until it is."""

    async def build(number: int) -> None:
        here = target()
        try:
            where = address_of(4, number % 5000)
            status, _ = await post_mesh(here, "/api/trees?build=true", where, mesh(number))
            report.note("upload to build", status, expected=answered(here, status, 200, 201))
        except LOST as error:
            report.note("upload to build", repr(error)[:60], expected=here.may_fail)
        while await _building(target()):
            await asyncio.sleep(5)

    return build


async def _building(here: Target) -> bool:
    """Whether a build waits or runs, or a server does not say."""
    try:
        status, answer = await ask(here, "GET", "/api/jobs?limit=500", address_of(6, 2))
    except LOST:
        return True
    return status != 200 or any(job["state"] in ("queued", "running") for job in json.loads(answer)["jobs"])


async def note_jobs(target: Choose, report: Report) -> None:
    """Note the states of all builds: killed processes are no reason for one to fail."""
    status, answer = await ask(target(), "GET", "/api/jobs?limit=500", address_of(6, 1))
    report.note("jobs", status, expected=status == 200)
    for job in json.loads(answer)["jobs"] if status == 200 else []:
        report.note("job", job["state"], expected=job["state"] != "failed")


async def post_mesh(here: Target, path: str, address: str, mesh: bytes) -> tuple[int, bytes]:
    """Upload a mesh with the key: status and body."""
    headers = {
        "Authorization": f"Bearer {here.key}",
        "Content-Type": "multipart/form-data; boundary=x",
    }
    body = b'--x\r\nContent-Disposition: form-data; name="file"; filename="load.obj"\r\n\r\n'
    return await ask(here, "POST", path, address, headers, body + mesh + b"\r\n--x--\r\n")


async def listen(target: Choose, report: Report, number: int) -> None:
    """Listen to the events of all trees."""
    while True:
        here = target()
        try:
            reader, writer = await here.connect()
            with aborted(writer):
                writer.write(request_bytes("GET", "/api/events", address_of(5, number)))
                status, _ = await read_head(reader)
                report.note("event stream", status, expected=answered(here, status, 200))
                while await reader.read(1 << 16):
                    pass
        except LOST as error:
            report.note("event stream", repr(error)[:60], expected=here.may_fail)
        await asyncio.sleep(1)
