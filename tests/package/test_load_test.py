"""What the load test computes itself, and that its proxy runs the configuration that is deployed."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.testing import assert_array_equal

from tests.load.proxy import configuration
from tests.load.report import FrameTimes, gap_percentiles


def test_percentiles_of_a_histogram_are_those_of_its_values() -> None:
    rng = np.random.default_rng(5)
    gaps = [rng.integers(20, 400, size) for size in (300, 1, 77)]
    times = [FrameTimes(Counter(one.tolist())) for one in gaps]
    percent = [1.0, 50.0, 99.0, 100.0]
    expected = np.percentile(np.concatenate(gaps), percent, method="inverted_cdf")
    assert_array_equal(gap_percentiles(times, percent), expected)
    assert np.isnan(gap_percentiles([], [50.0])).all()


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
