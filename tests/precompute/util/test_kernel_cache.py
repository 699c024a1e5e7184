"""Compiled kernels: one process compiles them, the others wait, and changed sources are compiled again."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from galewood.util import compile_once, kernel_cache, kernels_compiled


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder))
    return folder


def test_one_compiles_and_the_others_wait(cache: Path) -> None:
    assert not kernels_compiled()
    started, go_on = threading.Event(), threading.Event()
    calls: list[int] = []

    def compile_all() -> None:
        calls.append(1)
        started.set()
        assert go_on.wait(60)

    with ThreadPoolExecutor(4) as threads:
        first = threads.submit(compile_once, compile_all)
        assert started.wait(60)
        others = [threads.submit(compile_once, compile_all) for _ in range(3)]
        assert not kernels_compiled()
        go_on.set()
        for one in (first, *others):
            one.result(60)
    assert calls == [1]
    assert kernels_compiled()


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "sources"
    folder.mkdir()
    (folder / "kernel.py").write_text("import numba")
    (folder / "constants.py").write_text("LIMIT_PA = 1.0")
    monkeypatch.setattr(kernel_cache, "PACKAGE", folder)
    return folder


def test_kernels_with_another_value_of_a_constant_are_removed(cache: Path, sources: Path) -> None:
    ours, others = cache / "sources_1" / "kernel.step-1.py311.nbi", cache / "other_1" / "kernel.f-1.py311.nbi"
    compile_once(lambda: None)
    for file in (ours, others):
        file.parent.mkdir()
        file.write_bytes(b"compiled")
    (sources / "constants.py").write_text("LIMIT_PA = 2.0")
    assert not kernels_compiled()
    compile_once(lambda: None)
    assert kernels_compiled()
    assert not ours.exists() and others.exists()


def test_kernels_of_changed_sources_are_compiled_again(cache: Path, sources: Path) -> None:
    kernel = sources / "kernel.py"
    compile_once(lambda: None)
    assert kernels_compiled()
    Path(sources, "other.py").write_text("without kernels")
    assert kernels_compiled()
    kernel.write_text("import numba  # changed")
    assert not kernels_compiled()


def test_kernels_that_could_not_be_compiled_are_not_marked(cache: Path) -> None:
    def fail() -> None:
        raise RuntimeError("no compiler")

    with pytest.raises(RuntimeError):
        compile_once(fail)
    assert not kernels_compiled()


def test_where_nothing_can_be_cached_nobody_waits(cache: Path) -> None:
    cache.write_text("a file where the folder should be")
    calls: list[int] = []
    assert kernels_compiled()
    compile_once(lambda: calls.append(1))
    assert calls == [1]
