"""Clients that mean harm, all of one kind from one address. They are to be refused; nothing may fail."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Coroutine
from typing import Any

from galewood_server.cli.bench_client import masked

from tests.load.report import Report
from tests.load.visitors import LOST, Choose, planted, post_mesh
from tests.load.wire_client import Refused, aborted, ask, open_socket, read_head, request_bytes
from tests.server.support.sample_meshes import pole_obj

FACES = b"v 0 0 0\n" + b"f \n" * ((64 * 1024 * 1024 - 200) // 3)
"""An OBJ file as large as an upload may be."""
PINGS = masked(b"", 9) * 2000
LARGEST = 20_000


def refused_well(status: int) -> bool:
    """Whether a status is a sensible answer to an attack: no server error but "too busy"."""
    return status < 500 or status in (503, 507)


async def flood_requests(target: Choose, report: Report) -> None:
    """Requests without pause, also with invented methods."""
    number = 0
    while True:
        method, path = (f"M{number}", "/") if number % 5 == 0 else ("GET", f"/api/trees?limit={number % 7}")
        try:
            status, _ = await ask(target(), method, path, "10.90.0.1")
            report.note("flood of requests", status, expected=refused_well(status))
        except LOST as error:
            report.note("flood of requests", repr(error)[:40])
        number += 1
        await asyncio.sleep(0.005)


async def flood_pings(target: Choose, report: Report) -> None:
    """WebSocket pings as fast as the server reads them."""
    while True:
        try:
            watcher = await open_socket(target(), "10.90.0.2")
            with aborted(watcher.writer):
                async with asyncio.TaskGroup() as tasks:
                    following = tasks.create_task(watcher.follow())
                    while not following.done():
                        watcher.writer.write(PINGS)
                        await watcher.writer.drain()
                        await asyncio.sleep(0.01)
        except* LOST as group:
            report.note("flood of pings", _outcome(group))
        await asyncio.sleep(1)


async def flood_forests(target: Choose, report: Report, number: int) -> None:
    """The largest forest, again and again."""
    plans = [planted(target().table, LARGEST, seed) for seed in (number, number + 100)]
    while True:
        try:
            watcher = await open_socket(target(), "10.90.0.3")
            with aborted(watcher.writer):
                async with asyncio.TaskGroup() as tasks:
                    following = tasks.create_task(watcher.follow())
                    count = 0
                    while not following.done():
                        watcher.send(plans[count % 2])
                        await watcher.writer.drain()
                        count += 1
                        await asyncio.sleep(0.2)
        except* LOST as group:
            report.note("flood of forests", _outcome(group))
        await asyncio.sleep(1)


async def listen_too_often(target: Choose, report: Report, number: int) -> None:
    """One of many event streams of one address."""
    await asyncio.sleep(number % 100 / 10)
    while True:
        try:
            reader, writer = await target().connect()
            with aborted(writer):
                writer.write(request_bytes("GET", "/api/events", "10.90.0.4"))
                status, _ = await read_head(reader)
                report.note("too many event streams", status, expected=refused_well(status))
                if status == 200:
                    await asyncio.sleep(30)
        except LOST as error:
            report.note("too many event streams", repr(error)[:40])
        await asyncio.sleep(20 + number % 20)


async def never_read(target: Choose, report: Report) -> None:
    """A download of which nothing is read."""
    while True:
        try:
            here = target()
            _, writer = await here.connect(limit=1024)
            with aborted(writer):
                writer.transport.pause_reading()  # type: ignore[attr-defined]
                writer.write(request_bytes("GET", f"/api/meshes/{here.mesh}", "10.90.0.5"))
                await asyncio.sleep(90)
            report.note("unread download", "held for 90 s")
        except LOST as error:
            report.note("unread download", repr(error)[:40])
        await asyncio.sleep(1)


async def watch_without_reading(target: Choose, report: Report, number: int) -> None:
    """A stream of which nothing is read."""
    while True:
        try:
            share = f"unread-{number % 4}"
            watcher = await open_socket(target(), "10.90.0.6", share=share)
            with aborted(watcher.writer):
                watcher.writer.transport.pause_reading()  # type: ignore[attr-defined]
                watcher.send(planted(target().table, 500, number, share))
                await asyncio.sleep(30)
            report.note("unread stream", "held for 30 s")
        except LOST as error:
            report.note("unread stream", repr(error)[:40])
        await asyncio.sleep(2)


async def read_structures(target: Choose, report: Report, number: int, uploaded: dict[int, str]) -> None:
    """The structure of an upload that is not built, again and again; reading it needs no key.

    The first attacker uploads a tree to each server, and `uploaded` tells the others: its ids by their ports.
    """
    while True:
        here, address = target(), f"10.90.1.{number % 250}"
        try:
            if here.port not in uploaded and number == 0:
                status, answer = await post_mesh(here, "/api/trees", address, pole_obj(9.0))
                report.note("upload to be read", status, expected=refused_well(status))
                if status in (200, 201):
                    uploaded[here.port] = json.loads(answer)["id"]
            elif here.port in uploaded:
                status, _ = await ask(here, "GET", f"/api/trees/{uploaded[here.port]}/structure", address)
                report.note("structure", status, expected=refused_well(status))
        except LOST as error:
            report.note("structure", repr(error)[:40])
        await asyncio.sleep(0.01)


async def upload_faces(target: Choose, report: Report) -> None:
    """The largest upload that is allowed, with a key: nothing but lines of faces."""
    while True:
        try:
            status, _ = await post_mesh(target(), "/api/trees", "10.90.0.7", FACES)
            report.note("upload of faces", status, expected=refused_well(status))
        except LOST as error:
            report.note("upload of faces", repr(error)[:40])
        await asyncio.sleep(1)


def _outcome(group: BaseExceptionGroup[BaseException]) -> str:
    refused = [error for error in group.exceptions if isinstance(error, Refused)]
    return str(refused[0]) if refused else "cut"


Start = Callable[[], Coroutine[Any, Any, None]]


def all_attacks(target: Choose, report: Report) -> dict[str, list[Start]]:
    """Every attack by its name, as functions that start its clients."""
    uploaded: dict[int, str] = {}
    return {
        "flood of requests": [lambda: flood_requests(target, report)] * 2,
        "flood of pings": [lambda: flood_pings(target, report)],
        "flood of forests": [lambda n=n: flood_forests(target, report, n) for n in range(4)],
        "event streams": [lambda n=n: listen_too_often(target, report, n) for n in range(1000)],
        "unread downloads": [lambda: never_read(target, report)] * 130,
        "structures": [lambda n=n: read_structures(target, report, n, uploaded) for n in range(10)],
        "uploads of faces": [lambda: upload_faces(target, report)],
        "unread streams": [lambda n=n: watch_without_reading(target, report, n) for n in range(8)],
    }
