"""The Dask interface: an embedded cluster in a separate process, and a parallel map on any cluster.

Dask unpickles its messages and has no authentication, so the embedded cluster listens only on the loopback
interface and has no dashboard. Results are names of atomically written files, never arrays, so that finished
work survives the loss of a worker.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar, cast

from galewood.threads import SINGLE_THREADED

SIMULATION_MODULE = "galewood.solid.fem.dynamics"
"""Workers load it, and with it the finite elements, when they start: while the wood is meshed."""
Item = TypeVar("Item")
Result = TypeVar("Result")


class EngineLostError(Exception):
    """The cluster was lost. Finished runs are stored; the job can be resumed."""


@contextmanager
def connected(address: str) -> Generator[Any]:
    """Connect to a cluster. EngineLostError if it is unreachable or lost inside the block."""
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
    client: Any,
    work: Callable[[Item], Result],
    items: Sequence[Item],
    done: Callable[[int, Item], None],
    priority: int = 0,
) -> None:
    """Apply `work` to every item in the worker processes, after all items of a higher priority.

    `done` is called with the number of finished items and the last one; it may raise to cancel the others.
    """
    from distributed import as_completed

    futures: list[Any] = client.map(work, items, pure=False, retries=2, priority=priority)
    item_of = {future.key: item for future, item in zip(futures, items, strict=True)}
    try:
        finished = cast(Iterable[Any], as_completed(futures, loop=client.loop))
        for count, future in enumerate(finished, 1):
            future.result()
            done(count, item_of[future.key])
    finally:
        client.cancel(futures, force=True)


def main() -> None:
    """Run an embedded cluster until standard input closes. Writes its address to standard output as JSON."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--workers", type=int, required=True)
    parser.add_argument("--folder", required=True)
    options = parser.parse_args()
    os.environ.update(SINGLE_THREADED)
    import distributed

    make_cluster: Any = distributed.LocalCluster  # its type stubs do not allow this use
    with make_cluster(
        n_workers=options.workers,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address=None,
        worker_dashboard_address=None,
        local_directory=options.folder,
        memory_limit=0,
        preload=[SIMULATION_MODULE],
        silence_logs=40,
    ) as cluster:
        print(json.dumps({"address": cluster.scheduler_address}), flush=True)
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        sys.stdin.read()


if __name__ == "__main__":
    main()
