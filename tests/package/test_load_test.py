"""What the load test computes itself, and that its proxy runs the configuration that is deployed."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
from numpy.testing import assert_array_equal

from tests.load.priorities import set_niceness
from tests.load.proxy import configuration
from tests.load.report import FrameTimes, frame_count, gap_percentiles


def test_percentiles_of_a_histogram_are_those_of_its_values() -> None:
    rng = np.random.default_rng(5)
    gaps = [rng.integers(20, 400, size) for size in (300, 1, 77)]
    times = [FrameTimes(Counter(one.tolist())) for one in gaps]
    percent = [1.0, 50.0, 99.0, 100.0]
    expected = np.percentile(np.concatenate(gaps), percent, method="inverted_cdf")
    assert_array_equal(gap_percentiles(times, percent), expected)
    assert np.isnan(gap_percentiles([], [50.0])).all()


def test_late_frames_are_counted() -> None:
    times = [FrameTimes(Counter({33: 100, 700: 2})), FrameTimes(Counter({2500: 1}))]
    assert [frame_count(times, longer_than_s) for longer_than_s in (0.0, 0.5, 2.0, 3.0)] == [103, 3, 1, 0]


def test_a_priority_is_that_of_all_threads() -> None:
    ready = "import threading, time; [threading.Thread(target=time.sleep, args=(60,)).start() for _ in '12']"
    command = [sys.executable, "-c", f"{ready}; print(flush=True)"]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as child:
        try:
            assert child.stdout
            child.stdout.readline()
            set_niceness(child.pid, 7)
            threads = [int(one.name) for one in Path(f"/proc/{child.pid}/task").iterdir()]
            assert [os.getpriority(os.PRIO_PROCESS, thread) for thread in threads] == [7, 7, 7]
        finally:
            child.kill()
    set_niceness(child.pid, 7)  # it has ended


def test_a_watcher_that_gets_no_frame_again_waits_until_the_end() -> None:
    times = FrameTimes()
    times.end()
    assert not times.gaps_ms, "it has not begun"
    times.frame()
    times.end()
    assert times.gaps_ms.total() == 1


def test_the_proxy_has_the_policy_that_is_deployed() -> None:
    text = configuration([20001, 20002])
    assert "reverse_proxy 127.0.0.1:20001 127.0.0.1:20002" in text
    assert "lb_policy query share" in text and "server-a" not in text and "trusted_proxies" in text
