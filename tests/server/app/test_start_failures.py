"""A server that cannot start, and commands that cannot work, say why in a sentence; no traceback."""

from __future__ import annotations

import errno
import os
import socket
import sqlite3
import subprocess
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path

import pytest
from galewood_server.app.start_failures import check_address
from galewood_server.cli.commands import app
from galewood_server.settings import Settings
from galewood_server.storage import StartError, start_failure
from galewood_server.storage.database import HEAD_REVISION, migrate
from sqlalchemy.exc import OperationalError
from typer.testing import CliRunner

from tests.server.support.server_process import NO_CLUSTER, REPOSITORY, free_port

Prepare = Callable[[Path], dict[str, str]]
ANOTHER_VERSION = (
    f"The database belongs to another version of Galewood (schema 0007; this version uses {HEAD_REVISION}): "
    "install that version, or set GALEWOOD_DATA_DIR to an empty folder"
)


def ended(data: Path, *command: str, **environment: str) -> tuple[int, str]:
    """Exit status and output of a command."""
    given = {**os.environ, "GALEWOOD_DATA_DIR": str(data), "GALEWOOD_BUILTIN_TREES": "false", **NO_CLUSTER}
    given |= {"PORT": str(free_port()), "COLUMNS": "400", **environment}
    done = subprocess.run(
        [sys.executable, "-m", "galewood_server.cli.main", *command],
        env=given, cwd=REPOSITORY, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    return done.returncode, done.stdout + done.stderr


def damaged(data: Path) -> dict[str, str]:
    (data / "galewood.sqlite").write_bytes(b"this is not a database" * 1000)
    return {}


def torn(data: Path) -> dict[str, str]:
    """A database whose pages behind the first are lost."""
    path = data / "galewood.sqlite"
    migrate(f"sqlite:///{path}")
    path.write_bytes(path.read_bytes()[:4096] + b"\xff" * 40_000)
    return {}


def of_another_version(data: Path) -> dict[str, str]:
    path = data / "galewood.sqlite"
    migrate(f"sqlite:///{path}")
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE alembic_version SET version_num = '0007'")
    return {}


def a_file(data: Path) -> dict[str, str]:
    data.rmdir()
    data.write_bytes(b"")
    return {}


def below_a_file(data: Path) -> dict[str, str]:
    (data / "file").write_bytes(b"")
    return {"GALEWOOD_DATA_DIR": str(data / "file" / "data")}


def a_folder_instead_of_the_database(data: Path) -> dict[str, str]:
    (data / "galewood.sqlite").mkdir()
    return {}


def unreachable(_data: Path) -> dict[str, str]:
    return {"GALEWOOD_DATABASE_URL": f"postgresql://me:secret@127.0.0.1:{free_port()}/trees"}


def no_database_address(_data: Path) -> dict[str, str]:
    return {"GALEWOOD_DATABASE_URL": "trees"}


@pytest.mark.parametrize(
    ("prepare", "expected"),
    [
        (damaged, "galewood.sqlite is damaged (file is not a database): restore it from a backup"),
        (torn, "galewood.sqlite is damaged (database disk image is malformed): restore it from a backup"),
        (of_another_version, ANOTHER_VERSION),
        (a_file, "is not a folder: move the file away, or set GALEWOOD_DATA_DIR"),
        (below_a_file, "is not a folder: move the file away, or set GALEWOOD_DATA_DIR"),
        (a_folder_instead_of_the_database, "galewood.sqlite cannot be opened for writing (unable to open"),
        (unreachable, "does not respond (connection failed"),
        (no_database_address, "GALEWOOD_DATABASE_URL is not the address of a database"),
    ],
)
def test_a_server_that_cannot_start_says_why(tmp_path: Path, prepare: Prepare, expected: str) -> None:
    (tmp_path / "data").mkdir()
    code, said = ended(
        tmp_path / "data",
        "serve",
        **{"GALEWOOD_DATA_DIR": str(tmp_path / "data"), **prepare(tmp_path / "data")},
    )
    assert code == 3
    assert "Traceback" not in said
    assert said.count(expected) == 1, said
    assert "secret" not in said


@pytest.mark.parametrize(
    ("prepare", "expected"),
    [
        (damaged, "is damaged (file is not a database)"),
        (torn, "is damaged (database disk image is malformed)"),
        (of_another_version, ANOTHER_VERSION),
        (a_file, "galewood.sqlite cannot be opened"),
        (unreachable, "does not respond (connection failed"),
        (no_database_address, "GALEWOOD_DATABASE_URL is not the address of a database"),
    ],
)
def test_the_doctor_says_what_is_wrong(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, prepare: Prepare, expected: str
) -> None:
    data = tmp_path / "data"
    data.mkdir()
    for name, value in {"GALEWOOD_DATA_DIR": str(data), "COLUMNS": "400", **prepare(data)}.items():
        monkeypatch.setenv(name, value)
    found = CliRunner().invoke(app, ["doctor"])
    assert (found.exit_code, type(found.exception)) == (1, SystemExit)
    assert expected in found.output


@pytest.mark.parametrize("command", ["serve", "doctor"])
@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("GALEWOOD_PORT", "many", "GALEWOOD_PORT: Input should be a valid integer"),
        ("GALEWOOD_API_KEYS", "swordfish", "GALEWOOD_API_KEYS: Value error, expected SHA-256 hashes"),
        ("GALEWOOD_TRUSTED_PROXIES", "proxy", "GALEWOOD_TRUSTED_PROXIES: Value error, expected IP addresses"),
        ("GALEWOOD_ALLOWED_ORIGINS", "https://a.example", "allowed_origins"),
    ],
)
def test_a_wrong_setting_is_named(
    monkeypatch: pytest.MonkeyPatch, command: str, name: str, value: str, expected: str
) -> None:
    monkeypatch.setenv(name, value)
    found = CliRunner().invoke(app, [command], env={"COLUMNS": "400"})
    assert (found.exit_code, type(found.exception)) == (1, SystemExit)
    assert expected in found.output


def sqlite_error(code: int) -> OperationalError:
    error = sqlite3.OperationalError("it failed")
    error.sqlite_errorcode = code
    return OperationalError("SELECT", {}, error)


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (
            PermissionError(errno.EACCES, "Permission denied", "/srv/data/.lock"),
            "/srv/data/.lock cannot be written",
        ),
        (
            OSError(errno.EROFS, "Read-only file system", "/srv/data"),
            "/srv/data cannot be written (Read-only",
        ),
        (OSError(errno.ENOSPC, "No space left on device"), "The disk is full (data)"),
        (sqlite_error(sqlite3.SQLITE_FULL), "The disk is full ("),
        (sqlite_error(sqlite3.SQLITE_READONLY), "cannot be opened for writing (it failed)"),
        (sqlite_error(sqlite3.SQLITE_READONLY_DIRECTORY), "cannot be opened for writing (it failed)"),
        (sqlite_error(sqlite3.SQLITE_BUSY), "no other program has locked it"),
        (sqlite_error(sqlite3.SQLITE_IOERR_READ), "does not respond (it failed)"),
    ],
)
def test_failures_have_a_sentence(error: Exception, expected: str) -> None:
    assert expected in (start_failure(error, Settings()) or "")


@pytest.mark.parametrize(
    "error", [ValueError("a bug"), OSError(errno.EBADF, "Bad"), sqlite_error(sqlite3.SQLITE_ERROR)]
)
def test_an_unexpected_failure_keeps_its_traceback(error: Exception) -> None:
    assert start_failure(error, Settings()) is None


@contextmanager
def taken_port() -> Generator[int]:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        yield int(other.getsockname()[1])


def test_a_port_in_use_is_named_before_any_work(tmp_path: Path) -> None:
    with taken_port() as port:
        code, said = ended(tmp_path / "data", "serve", PORT=str(port))
    assert code == 3 and "Traceback" not in said
    assert f"Port {port} is used by another program: end it, or set PORT" in said
    assert not (tmp_path / "data").exists()


@pytest.mark.parametrize(
    ("host", "expected"),
    [("203.0.113.77", "is not an address of this machine"), ("not a name", "is not a known name")],
)
def test_an_address_of_another_machine_is_named(host: str, expected: str) -> None:
    with pytest.raises(StartError, match=expected):
        check_address(host, free_port())
    check_address("127.0.0.1", free_port())
    check_address("localhost", 0)
