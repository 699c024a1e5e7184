"""The script that starts PostgreSQL, a store and a cluster for the tests."""

from __future__ import annotations

from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType

import psycopg
import pytest

REPOSITORY = Path(__file__).resolve().parents[3]


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.setattr("sys.dont_write_bytecode", True)
    path = REPOSITORY / "scripts" / "test-distributed"
    loader = SourceFileLoader("script_under_test", str(path))
    module = ModuleType(loader.name)
    module.__file__ = str(path)
    loader.exec_module(module)
    return module


def test_a_database_that_listens_but_does_not_answer_yet_is_waited_for(
    script: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    attempts: list[str] = []

    class Connection:
        def close(self) -> None:
            attempts.append("answered")

    def connect(database: str, **_: object) -> Connection:
        attempts.append(database)
        if len(attempts) < 3:
            raise psycopg.OperationalError("FATAL: the database system is starting up")
        return Connection()

    monkeypatch.setattr(psycopg, "connect", connect)
    monkeypatch.setattr(script.time, "sleep", lambda seconds: None)
    script.wait_for(script.answering("postgresql://galewood@127.0.0.1:1"), "PostgreSQL")
    assert attempts[-1] == "answered" and len(attempts) == 4
