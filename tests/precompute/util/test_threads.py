"""A build in a program that loaded numpy before: the numerical libraries have one thread, then as before."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from galewood.pipeline.stages import model_of
from galewood.pipeline.tables import BuildOptions
from galewood.threads import single_threaded
from galewood.util import WorkerPool
from threadpoolctl import threadpool_info, threadpool_limits


def blas_threads() -> set[int]:
    """Threads of every BLAS that this process has loaded."""
    np.linalg.inv(np.eye(2))
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_the_limit_holds_during_the_work_and_also_ends_with_an_error() -> None:
    with threadpool_limits(limits=2, user_api="blas"):
        before = blas_threads()
        assert single_threaded(blas_threads)() == {1}
        assert blas_threads() == before
        with pytest.raises(ZeroDivisionError):
            single_threaded(lambda: 1 // 0)()
        assert blas_threads() == before


def test_a_build_limits_its_own_process(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    seen: list[set[int]] = []

    def read(*_: object) -> None:
        seen.append(blas_threads())
        raise InterruptedError

    monkeypatch.setattr("galewood.pipeline.stages.build.import_tree", read)
    with threadpool_limits(limits=2, user_api="blas"), pytest.raises(InterruptedError):
        model_of(b"", "tree.glb", BuildOptions(), tmp_path)
    assert seen == [{1}]


def test_workers_have_one_thread_each() -> None:
    with WorkerPool(1) as pool:
        assert pool.start(blas_threads).result() == {1}
