"""Failures of the database and the data folder: whether they pass, and a sentence for the operator."""

from __future__ import annotations

import errno
import sqlite3
from pathlib import Path

from sqlalchemy import make_url
from sqlalchemy.exc import ArgumentError, DBAPIError, NoSuchModuleError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError

from galewood_server.settings import Settings

PRIMARY_CODE = 0xFF
"""Mask of SQLite's extended error codes."""
SQLITE_BUSY = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)
SQLITE_DAMAGED = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)
POSTGRESQL_FULL = "53100"
# serialisation failure, deadlock, too many connections, lock or statement timeout, shutting down, starting
POSTGRESQL_BUSY = frozenset({"40001", "40P01", "53300", "55P03", "57014", "57P01", "57P02", "57P03"})
POSTGRESQL_LOST = "08"
"""Class of the codes of lost connections."""
NO_SPACE = (errno.ENOSPC, errno.EDQUOT)
UNWRITABLE_ERRORS = (errno.EACCES, errno.EPERM, errno.EROFS)
NO_FOLDER = (errno.ENOTDIR, errno.EEXIST)


class StartError(Exception):
    """The service cannot start; the message is a sentence for the operator."""


def is_disk_full(error: BaseException | None) -> bool:
    """Whether a file system, SQLite or PostgreSQL had no space left."""
    if isinstance(error, OSError):
        return error.errno in NO_SPACE
    if isinstance(error, DBAPIError):
        return is_disk_full(error.orig)
    return _sqlstate(error) == POSTGRESQL_FULL or _sqlite_code(error) == sqlite3.SQLITE_FULL


def is_database_busy(error: BaseException | None) -> bool:
    """Whether the database is locked, overloaded or out of reach: the same statement may succeed later."""
    if isinstance(error, PoolTimeoutError):
        return True
    if isinstance(error, DBAPIError):
        unreachable = isinstance(error, OperationalError) and _sqlstate(error.orig, "") is None
        return error.connection_invalidated or unreachable or is_database_busy(error.orig)
    state = _sqlstate(error) or ""
    return _sqlite_code(error) in SQLITE_BUSY or state in POSTGRESQL_BUSY or state.startswith(POSTGRESQL_LOST)


def start_failure(error: BaseException, settings: Settings) -> str | None:
    """Why the service cannot start and what to do about it, in a sentence; None for an unexpected error."""
    if isinstance(error, StartError):
        return str(error)
    if is_disk_full(error):
        return f"The disk is full ({_where(error, settings)}): free some space, then start again."
    if isinstance(error, OSError):
        return _of_folder(error, settings)
    if isinstance(error, ArgumentError | NoSuchModuleError):
        return "GALEWOOD_DATABASE_URL is not the address of a database, such as postgresql://user@host/name."
    if isinstance(error, DBAPIError):
        return _of_database(error, settings)
    return None


def _of_folder(error: OSError, settings: Settings) -> str | None:
    path = _where(error, settings)
    if error.errno in UNWRITABLE_ERRORS:
        return (
            f"{path} cannot be written ({error.strerror}): change its permissions, or set GALEWOOD_DATA_DIR"
            " to a folder that the server may write."
        )
    if error.errno in NO_FOLDER:
        return f"{path} is not a folder: move the file away, or set GALEWOOD_DATA_DIR to a folder."
    return None


def _of_database(error: DBAPIError, settings: Settings) -> str | None:
    code, name = _sqlite_code(error.orig), _database_name(settings)
    what = str(error.orig).strip().partition("\n")[0]
    if code in SQLITE_DAMAGED:
        return (
            f"The database {name} is damaged ({what}): restore it from a backup, or move it away to start"
            " with an empty one."
        )
    if code in (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM):
        return (
            f"The database {name} cannot be opened for writing ({what}): change the permissions of the file"
            " and of its folder."
        )
    if code in (*SQLITE_BUSY, sqlite3.SQLITE_IOERR) or is_database_busy(error):
        return (
            f"The database {name} does not respond ({what}): check that it is reachable, and that no other"
            " program has locked it."
        )
    if isinstance(error, OperationalError) and code is None:  # e.g. a wrong password or name
        return f"The database {name} refuses the connection ({what}): check GALEWOOD_DATABASE_URL."
    return None


def _where(error: BaseException, settings: Settings) -> str:
    """The file that an error names, otherwise the data folder or the database."""
    if isinstance(error, OSError) and isinstance(error.filename, str | Path):
        return str(error.filename)
    return str(settings.data_dir) if isinstance(error, OSError) else _database_name(settings)


def _database_name(settings: Settings) -> str:
    url = make_url(settings.database)
    if url.get_backend_name() == "sqlite":
        return url.database or "in memory"
    return url.render_as_string(hide_password=True)


def _sqlite_code(error: BaseException | None) -> int | None:
    """The primary result code of an error of SQLite; None for other errors."""
    code: int | None = getattr(error, "sqlite_errorcode", None)
    return None if code is None else code & PRIMARY_CODE


def _sqlstate(error: BaseException | None, other: str | None = None) -> str | None:
    """PostgreSQL's code of an error: None where there was no connection, `other` for other errors."""
    state: str | None = getattr(error, "sqlstate", other)
    return state
