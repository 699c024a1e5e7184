"""The only file that knows Dask: an embedded cluster in a process of its own, and a map over any cluster.

Dask unpickles what it is sent and has no passwords: the embedded one listens on the loopback interface
only, without a dashboard. Results are names of files written atomically under their hash, never arrays,
so that no finished work dies with a worker.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from galewood.threads import SINGLE_THREADED

from galewood_server.jobs.processes import die_with_parent

Item = TypeVar("Item")
Result = TypeVar("Result")
NICENESS = 10  # samples yield to the process that streams


class EngineLostError(Exception):
    """The cluster went away; what was finished is stored and the job can go on later."""


@contextmanager
def connected(address: str) -> Generator[Any]:
    """A client of the cluster. EngineLostError if it cannot be reached or is lost inside the block."""
    from distributed import Client
    from distributed.client import FutureCancelledError
    from distributed.comm.core import CommClosedError
    from distributed.scheduler import KilledWorker

    try:
        with Client(address, timeout=20, set_as_default=False) as client:
            yield client
    except (OSError, CommClosedError, FutureCancelledError, KilledWorker) as error:
        raise EngineLostError(str(error)) from error


def map_on_cluster(
    client: Any, work: Callable[[Item], Result], items: Sequence[Item], done: Callable[[int, Item], None]
) -> None:
    """`work` on every item, in worker processes.

    `done` is told how many are finished, and which was last; it may raise to stop the rest.
    """
    from distributed import as_completed

    futures = client.map(work, items, pure=False, retries=2)
    item_of = {future.key: item for future, item in zip(futures, items, strict=True)}
    try:
        for count, future in enumerate(as_completed(futures, loop=client.loop), 1):
            future.result()
            done(count, item_of[future.key])
    finally:
        client.cancel(futures, force=True)


def main() -> None:
    """Hold a cluster until standard input closes; first write its address to standard output."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--workers", type=int, required=True)
    parser.add_argument("--folder", required=True)
    options = parser.parse_args()
    os.nice(NICENESS)
    os.environ.update(SINGLE_THREADED)
    import distributed

    make_cluster: Any = distributed.LocalCluster  # its types promise a coroutine and a dashboard
    with make_cluster(
        n_workers=options.workers,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=None,
        worker_dashboard_address=None,
        local_directory=options.folder,
        memory_limit=0,
        silence_logs=40,
    ) as cluster:
        print(json.dumps({"address": cluster.scheduler_address}), flush=True)
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        die_with_parent()
        sys.stdin.read()


if __name__ == "__main__":
    main()
