"""Processes beside a build: they work, they end with it, and what they use is seen."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import psutil
import pytest
from galewood.util.process_usage import PeakMemory, cpu_seconds
from galewood.util.worker_pool import WorkerPool

STARTS_ONE = """
import time
from galewood.util.worker_pool import WorkerPool
if __name__ == "__main__":
    pool = WorkerPool(1)
    print(pool.start(__import__("os").getpid).result(), flush=True)
    pool.start(time.sleep, 600)
    time.sleep(600)
"""


def test_what_a_helper_returns_and_raises_comes_back() -> None:
    with WorkerPool(1) as pool:
        assert pool.start(divmod, 17, 5).result() == (3, 2)
        with pytest.raises(ZeroDivisionError):
            pool.start(divmod, 1, 0).result()


def test_an_exception_ends_what_is_still_being_done() -> None:
    process: psutil.Process | None = None
    with pytest.raises(KeyError), WorkerPool(1) as pool:
        process = psutil.Process(pool.start(os.getpid).result())
        pool.start(time.sleep, 600)
        raise KeyError
    assert process is not None
    process.wait(60)


def test_no_helper_outlives_a_killed_build() -> None:
    with subprocess.Popen([sys.executable, "-c", STARTS_ONE], stdout=subprocess.PIPE) as build:
        assert build.stdout
        process = psutil.Process(int(build.stdout.readline()))
        build.send_signal(signal.SIGKILL)
        process.wait(60)


def _fill(megabytes: int) -> int:
    kept = np.ones(megabytes << 17)
    time.sleep(0.5)
    return len(kept)


def test_memory_of_a_helper_counts_as_its_own_and_in_the_sum() -> None:
    with PeakMemory() as memory, WorkerPool(1) as pool:
        pool.start(_fill, 300).result()
    assert memory.child_mb > 300
    assert memory.total_mb > memory.child_mb + 50
    assert memory.parent_mb < memory.total_mb - 300


def test_cpu_time_of_a_living_helper_is_counted() -> None:
    with WorkerPool(1) as pool:
        pool.start(os.getpid).result()
        before = cpu_seconds()
        pool.start(_burn).result()
        assert cpu_seconds() - before > 0.2


def _burn() -> None:
    begun = time.process_time()
    while time.process_time() - begun < 0.3:
        pass
