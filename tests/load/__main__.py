"""`scripts/load-test`: visitors and attackers on real servers for a while; figures every interval."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import itertools
import random
import resource
import signal
import sys
from collections.abc import Coroutine
from typing import Any

import psutil

from tests.load import attackers, visitors
from tests.load.priorities import set_idle
from tests.load.report import Report
from tests.load.servers import Fleet, Node, fleet, victims
from tests.load.wire_client import ask
from tests.server.support.sample_meshes import pole_obj

SETTLE_S = 5.0
BETWEEN_BUILDS_S = 60.0
LONGEST_WAIT_S = 2.0
"""For the next frame, also if the watcher's server was killed."""
DISTRIBUTED = "one PostgreSQL, one S3-compatible store, one Dask cluster; kills processes in each interval"


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="scripts/load-test", description=__doc__)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--interval", type=float, default=60.0, help="seconds between two lines")
    parser.add_argument("--watchers", type=int, default=30, help="clients of shared forests")
    parser.add_argument("--trees", type=int, default=500, help="trees of each shared forest (ten clients)")
    parser.add_argument("--listeners", type=int, default=30, help="event streams, each from its own address")
    parser.add_argument("--no-attacks", action="store_true")
    parser.add_argument("--one-by-one", action="store_true", help="one kind of attack after the other")
    parser.add_argument("--servers", type=int, default=1)
    parser.add_argument("--distributed", action="store_true", help=DISTRIBUTED)
    parser.add_argument("--proxy", metavar="CADDY", help="Caddy's program, to be started before the servers")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def actors(fleet: Fleet, report: Report, chosen: argparse.Namespace) -> list[Coroutine[Any, Any, Any]]:
    """All clients."""
    started: list[Any] = [visitors.probe(fleet.next, report)]
    for number in range(chosen.watchers):
        started.append(visitors.watch(fleet.next, report, number, chosen.trees, chosen.interval))
    started += [visitors.listen(fleet.next, report, number) for number in range(chosen.listeners)]
    started.append(visitors.repeatedly(visitors.downloads(fleet.next, report), 1.0))
    upload = visitors.builds if chosen.distributed else visitors.uploads
    work = upload(fleet.next, report, lambda k: pole_obj(2.0 + k / 1000))
    started.append(visitors.repeatedly(work, BETWEEN_BUILDS_S if chosen.distributed else 15.0))
    return started


def attacks(fleet: Fleet, report: Report, chosen: argparse.Namespace) -> list[tuple[str, list[Any]]]:
    """What to start for each part of the run: its name and its clients."""
    if chosen.no_attacks:
        return [("no attack", [])]
    kinds = attackers.all_attacks(fleet.next, report)
    if chosen.one_by_one:
        return [("no attack", []), *kinds.items(), ("no attack", [])]
    return [("all attacks", [start for starts in kinds.values() for start in starts])]


async def notice_failures(fleet: Fleet) -> None:
    """What a proxy does: ask every server for its health, and send nobody to one that does not answer.

    A forest is reached through any server, so clients choose without regard to it.
    """
    while True:
        for node in fleet.nodes:
            target = fleet.target(node)
            try:
                async with asyncio.timeout(2):
                    status, _ = await ask(target, "GET", "/api/health", "10.99.0.1")
            except visitors.LOST:
                status = 0
            (fleet.down.discard if status == 200 else fleet.down.add)(node.port)
            if status == 200:
                node.started()
        await asyncio.sleep(0.3)


async def notice_started(fleet: Fleet) -> None:
    """Give servers that were started again the priority of the others."""
    while True:
        for node in fleet.nodes:
            if node.starting and node.process and node.process.poll() is None:
                with contextlib.suppress(*visitors.LOST):
                    async with asyncio.timeout(2):
                        await ask(fleet.target(node), "GET", "/api/health", "10.99.0.1")
                    node.started()
        await asyncio.sleep(0.5)


async def disturb(fleet: Fleet, report: Report, every_s: float, dice: random.Random) -> None:
    """In each interval, remove a server or add it again, and kill a server; at times the jobs or the workers.

    One after the other: they have machines of their own elsewhere, and share two cores here.
    """
    removed: Node | None = None
    for number in itertools.count():
        await asyncio.sleep(every_s / 4)
        if removed:
            removed.start()
            report.note("added", "server")
        removed = None if removed or len(fleet.nodes) < 3 else dice.choice(fleet.nodes)
        if removed and removed.process and removed.process.poll() is None:
            removed.process.terminate()
            report.note("removed", "server")
        others = {1: ("job",), 3: ("worker",)}.get(number % 4, ())  # so that builds end
        for kind in ("server", *others):
            await asyncio.sleep(every_s / 4)
            with contextlib.suppress(psutil.NoSuchProcess):  # it has just ended by itself
                kill(victims(fleet, kind, dice), kind, report)
            if kind == "server":
                await asyncio.sleep(0.5)
                for node in fleet.nodes:
                    if node is not removed and node.process and node.process.poll() is not None:
                        node.start()
        await asyncio.sleep(every_s / 2 if not others else every_s / 4)


async def put_jobs_last(every_s: float = 1.0) -> None:
    """Let jobs have what the servers leave, as `scripts/test-distributed` does with workers.

    Ten servers on one machine have ten jobs; elsewhere these have other machines.
    """
    seen = set[int]()
    while True:
        for pid in set(psutil.pids()) - seen:
            seen.add(pid)
            with contextlib.suppress(psutil.Error, OSError):
                if "job_process" in " ".join(psutil.Process(pid).cmdline()):
                    set_idle(pid)
        await asyncio.sleep(every_s)


def kill(processes: list[psutil.Process], kind: str, report: Report) -> None:
    """Kill processes that may have ended already."""
    for process in processes:
        try:
            process.send_signal(signal.SIGKILL)
            report.note("killed", kind)
        except psutil.NoSuchProcess:
            continue


async def run(fleet: Fleet, chosen: argparse.Namespace) -> Report:
    """Run all clients for the given time."""
    report, dice = Report(fleet, LONGEST_WAIT_S if chosen.distributed else None), random.Random(chosen.seed)
    tasks = [asyncio.create_task(one) for one in actors(fleet, report, chosen)]
    if chosen.distributed:
        tasks.append(asyncio.create_task((notice_started if chosen.proxy else notice_failures)(fleet)))
        tasks.append(asyncio.create_task(put_jobs_last()))
        tasks.append(asyncio.create_task(disturb(fleet, report, chosen.interval, dice)))
    await asyncio.sleep(SETTLE_S)
    parts = attacks(fleet, report, chosen)
    for name, starts in parts:
        print(name, flush=True)
        attacking = [asyncio.create_task(start()) for start in starts]
        for _ in range(max(1, round(60 * chosen.minutes / chosen.interval / len(parts)))):
            await asyncio.sleep(chosen.interval)
            print(report.line(), flush=True)
            for task in tasks + attacking:
                if task.done():
                    raise RuntimeError("a client of the load test failed") from task.exception()
        await end(attacking)
    for times in report.frame_times:
        times.end()
    if chosen.distributed:
        await visitors.note_jobs(fleet.next, report)
    await end(tasks)
    return report


async def end(tasks: list[asyncio.Task[Any]]) -> None:
    """Cancel tasks and wait for them."""
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


def main() -> int:
    """Run the load test; 1 if anything unexpected happened or the streams were too slow."""
    chosen = options()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that all that was started ends too
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    soft = most if most != resource.RLIM_INFINITY else 1 << 16
    with fleet(chosen.servers, chosen.distributed, chosen.proxy) as servers:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, most))  # for the clients; servers keep theirs
        report = asyncio.run(run(servers, chosen))
        complaints = servers.complaints()
        print(report.summary())
        print(f"tracebacks and failed forests in the logs: {len(complaints)}", *complaints[:10], sep="\n")
    return 0 if report.passed and not complaints else 1


if __name__ == "__main__":
    sys.exit(main())
