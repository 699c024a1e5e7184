"""Functions that a process keeps loaded: each call is a confined fork, and fails as a child would."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path

import numba
import numpy as np
import psutil
import pytest
from galewood.sandbox import Arrays, Limits, PreparedFunction, run_limited, unavailable_restrictions
from galewood.util import MeshError

HERE = "tests.precompute.sandbox.test_prepared"
OUTSIDE = Path(__file__).with_name("written-by-a-fork")
loads: list[int] = []


def warm_up() -> None:
    """Called once by the process that loads this module."""
    loads.append(os.getpid())


def act(arguments: Arrays) -> Arrays:
    """What a call is asked for."""
    what = arguments["what"].tobytes().decode()
    if what == "refuse":
        raise MeshError("no-wood", "unsuitable", "No wood.", "Add some.")
    if what == "hang":
        time.sleep(600)
    if what == "crash":
        os.abort()
    if what == "write":
        OUTSIDE.write_bytes(b"a fork is not confined")
    if what == "answer":
        os.write(1, b"0\n")  # as if it were the process that forked
        raise ValueError("it has failed all the same")
    loads.append(0)  # seen by no other fork
    return {"loads": np.array(loads), "pid": np.array([os.getpid(), os.getppid()])}


@numba.njit(cache=True)
def doubled(value: float) -> float:
    """A kernel that no cache holds: a confined process may not write there."""
    return 2.0 * value


def compile_kernel(arguments: Arrays) -> Arrays:
    return {"four": np.array([doubled(2.0)])}


def ask(function: PreparedFunction, what: str, limits: Limits | None = None) -> Arrays:
    arguments = {"what": np.frombuffer(what.encode(), np.uint8)}
    return function.run(arguments, limits or Limits(), what="The test")


@pytest.fixture(scope="module")
def function() -> Iterator[PreparedFunction]:
    function = PreparedFunction(f"{HERE}:{act.__name__}")
    function.prepare()
    yield function
    function.close()


def test_each_call_is_a_fork_of_the_process_that_loaded_the_function(function: PreparedFunction) -> None:
    first, second = ask(function, ""), ask(function, "")
    server = int(first["pid"][1])
    assert server == second["pid"][1] and first["pid"][0] != second["pid"][0]
    assert first["loads"].tolist() == second["loads"].tolist() == [server, 0]


@pytest.mark.parametrize(
    ("what", "code"),
    [("refuse", "no-wood"), ("crash", "crashed"), ("write", "crashed"), ("answer", "crashed")],
)
def test_what_a_fork_does_wrong_is_its_own_failure(function: PreparedFunction, what: str, code: str) -> None:
    if what == "write" and unavailable_restrictions():
        pytest.skip("files are not confined on this machine")
    with pytest.raises(MeshError) as caught:
        ask(function, what)
    assert caught.value.code == code
    assert not OUTSIDE.exists()
    assert ask(function, "")["loads"].tolist()[1:] == [0]


def test_a_fork_that_hangs_is_ended_and_the_next_call_served(function: PreparedFunction) -> None:
    server = int(ask(function, "")["pid"][1])
    with pytest.raises(MeshError) as caught:
        ask(function, "hang", Limits(wall_s=1.0))
    assert caught.value.code == "timed-out"
    assert not psutil.pid_exists(server)
    assert ask(function, "")["pid"][1] != server


def test_without_the_process_a_call_has_a_child_of_its_own(function: PreparedFunction) -> None:
    server = int(ask(function, "")["pid"][1])
    psutil.Process(server).kill()
    assert ask(function, "")["loads"].tolist() == [0], "it was not warmed up"
    function.prepare()
    assert len(ask(function, "")["loads"]) == 2


@pytest.mark.parametrize("shared_cache", [False, True])
def test_a_kernel_that_is_in_no_cache_is_compiled(
    shared_cache: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    if shared_cache:
        monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    else:
        monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    assert run_limited(f"{HERE}:{compile_kernel.__name__}", {}, Limits(), what="The test")["four"] == 4.0
    assert not list(tmp_path.iterdir())


def test_what_a_crashed_call_printed_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    with pytest.raises(MeshError, match="exit code 1"):
        run_limited(
            f"{HERE}:{act.__name__}", {"what": np.frombuffer(b"answer", np.uint8)}, Limits(), what="It"
        )
    assert "it has failed all the same" in caplog.text
