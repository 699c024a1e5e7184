"""`scripts/load-test`: visitors and attackers on real servers for a while; figures every interval."""

from __future__ import annotations

import argparse
import asyncio
import random
import signal
import sys
from collections.abc import Coroutine
from typing import Any

import psutil

from tests.load import attackers, visitors
from tests.load.report import Report
from tests.load.servers import Fleet, fleet, victims
from tests.load.wire_client import ask
from tests.server.sample_meshes import pole_obj

SETTLE_S = 5.0
DISTRIBUTED = "one PostgreSQL, one S3-compatible store, one Dask cluster; kills processes in each interval"


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="scripts/load-test", description=__doc__)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--interval", type=float, default=60.0, help="seconds between two lines")
    parser.add_argument("--watchers", type=int, default=30, help="clients of shared forests")
    parser.add_argument("--trees", type=int, default=500, help="trees of each shared forest (ten clients)")
    parser.add_argument("--listeners", type=int, default=30, help="event streams, each from its own address")
    parser.add_argument("--no-attacks", action="store_true")
    parser.add_argument("--servers", type=int, default=1)
    parser.add_argument("--distributed", action="store_true", help=DISTRIBUTED)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def actors(fleet: Fleet, report: Report, chosen: argparse.Namespace) -> list[Coroutine[Any, Any, Any]]:
    """All clients."""
    started: list[Any] = [visitors.probe(fleet.next, report)]
    for number in range(chosen.watchers):
        share = f"load-{number // 10}"
        started.append(visitors.watch(lambda share=share: fleet.of(share), report, number, chosen.trees,
                                      chosen.interval))  # fmt: skip
    started += [visitors.listen(fleet.next, report, number) for number in range(chosen.listeners)]
    started.append(visitors.repeatedly(visitors.downloads(fleet.next, report), 1.0))
    started.append(
        visitors.repeatedly(visitors.uploads(fleet.next, report, lambda k: pole_obj(2.0 + k / 1000)), 15.0)
    )
    if not chosen.no_attacks:
        started += [attack() for attack in attackers.all_attacks(fleet.next, report)]
    return started


async def notice_failures(fleet: Fleet) -> None:
    """What a proxy does: ask every server for its health, and send nobody to one that does not answer."""
    while True:
        for node in fleet.nodes:
            target = fleet.target(node)
            try:
                async with asyncio.timeout(2):
                    status, _ = await ask(target, "GET", "/api/health", "10.99.0.1")
            except visitors.LOST:
                status = 0
            (fleet.down.discard if status == 200 else fleet.down.add)(node.port)
        await asyncio.sleep(0.3)


async def kill_some(fleet: Fleet, report: Report, every_s: float, dice: random.Random) -> None:
    """Kill a process of each kind in turn, and start servers again."""
    while True:
        await asyncio.sleep(every_s)
        for kind, victim in victims(fleet, dice):
            try:
                victim.send_signal(signal.SIGKILL)
                report.note("killed", kind)
            except psutil.NoSuchProcess:
                continue
        for node in fleet.nodes:
            if node.process and await asyncio.to_thread(node.process.wait, 0.1) is not None:
                node.start()


async def run(fleet: Fleet, chosen: argparse.Namespace) -> Report:
    """Run all clients for the given time."""
    report, dice = Report(fleet), random.Random(chosen.seed)
    tasks = [asyncio.create_task(one) for one in actors(fleet, report, chosen)]
    if chosen.distributed:
        tasks.append(asyncio.create_task(notice_failures(fleet)))
        tasks.append(asyncio.create_task(kill_some(fleet, report, chosen.interval, dice)))
    await asyncio.sleep(SETTLE_S)
    for _ in range(round(60 * chosen.minutes / chosen.interval)):
        await asyncio.sleep(chosen.interval)
        print(report.line(), flush=True)
        for task in tasks:
            if task.done():
                raise RuntimeError("a client of the load test failed") from task.exception()
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    return report


def main() -> int:
    """Run the load test; 1 if anything unexpected happened or the streams were too slow."""
    chosen = options()
    with fleet(chosen.servers, chosen.distributed) as servers:
        report = asyncio.run(run(servers, chosen))
        complaints = servers.complaints()
        print(report.summary())
        print(f"tracebacks and failed forests in the logs: {len(complaints)}", *complaints[:10], sep="\n")
    return 0 if report.passed and not complaints else 1


if __name__ == "__main__":
    sys.exit(main())
