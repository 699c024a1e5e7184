"""Worker processes: results, termination with the build, measured resource usage."""

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

START_WORKER = """
import time
from galewood.util.worker_pool import WorkerPool
if __name__ == "__main__":
    pool = WorkerPool(1)
    print(pool.start(__import__("os").getpid).result(), flush=True)
    pool.start(time.sleep, 600)
    time.sleep(600)
"""


def test_results_and_exceptions_are_returned() -> None:
    with WorkerPool(1) as pool:
        assert pool.start(divmod, 17, 5).result() == (3, 2)
        with pytest.raises(ZeroDivisionError):
            pool.start(divmod, 1, 0).result()


def test_exception_aborts_running_tasks() -> None:
    process: psutil.Process | None = None
    with pytest.raises(KeyError), WorkerPool(1) as pool:
        process = psutil.Process(pool.start(os.getpid).result())
        pool.start(time.sleep, 600)
        raise KeyError
    assert process is not None
    process.wait(60)


def test_workers_exit_when_the_build_is_killed() -> None:
    with subprocess.Popen([sys.executable, "-c", START_WORKER], stdout=subprocess.PIPE) as build:
        assert build.stdout
        process = psutil.Process(int(build.stdout.readline()))
        build.send_signal(signal.SIGKILL)
        process.wait(60)


def _fill(megabytes: int) -> int:
    kept = np.ones(megabytes << 17)
    time.sleep(0.5)
    return len(kept)


def test_memory_of_a_worker_counts_as_child_and_in_the_total() -> None:
    with PeakMemory() as memory, WorkerPool(1) as pool:
        pool.start(_fill, 300).result()
    assert memory.child_mb > 300
    assert memory.total_mb > memory.child_mb + 50
    assert memory.parent_mb < memory.total_mb - 300


def test_cpu_time_of_a_running_worker_is_counted() -> None:
    with WorkerPool(1) as pool:
        pool.start(os.getpid).result()
        before = cpu_seconds()
        pool.start(_spin).result()
        assert cpu_seconds() - before > 0.2


def _spin() -> None:
    start = time.process_time()
    while time.process_time() - start < 0.3:
        pass
