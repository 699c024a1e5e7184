"""Reads what a confined child has written, which may be anything: no link, no size and no type is trusted."""

from __future__ import annotations

import json
import os
import shutil
import stat
import subprocess
import zipfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, get_args

import numpy as np

from galewood.sandbox.arrays import Arrays
from galewood.util import MeshError, Reason

ERROR_BYTES = 1 << 20
"""Maximum size of a description of an error."""
FILE_OVERHEAD_BYTES = 4096
"""What a file or folder counts beside its size, so that many empty ones count too."""
LARGEST_DEPTH = 16
"""Of folders below the working folder; a child has no use for more than three."""


class UntrustworthyError(Exception):
    """A child has written something that none of its functions writes."""


@contextmanager
def open_untrusted(path: Path) -> Generator[IO[bytes]]:
    """Open a file that a child has written. UntrustworthyError if it is none."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except OSError as error:
        raise UntrustworthyError(str(error)) from error
    with os.fdopen(descriptor, "rb") as file:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise UntrustworthyError(f"{path.name} is not a file")
        yield file


def read_arrays(path: Path, limit_bytes: int) -> Arrays:
    """The arrays of an uncompressed .npz file without pickles. UntrustworthyError."""
    with open_untrusted(path) as file:
        try:
            with zipfile.ZipFile(file) as archive:
                members = archive.infolist()
            if any(one.compress_type != zipfile.ZIP_STORED for one in members):
                raise UntrustworthyError(f"{path.name} is compressed")
            if sum(one.file_size for one in members) > limit_bytes:
                raise UntrustworthyError(f"{path.name} is too large")
            file.seek(0)
            with np.load(file, allow_pickle=False) as result:
                arrays: dict[str, Any] = {name: result[name] for name in result.files}
        except UntrustworthyError:
            raise
        except Exception as error:  # whatever the parsers of archives and arrays raise for such bytes
            raise UntrustworthyError(f"{path.name}: {error}") from error
    if not all(isinstance(one, np.ndarray) for one in arrays.values()):
        raise UntrustworthyError(f"{path.name} contains something other than arrays")
    return arrays


def read_error(path: Path) -> MeshError:
    """The MeshError that a child describes in a JSON file. UntrustworthyError."""
    with open_untrusted(path) as file:
        try:
            given = json.loads(file.read(ERROR_BYTES))
        except (ValueError, RecursionError) as error:
            raise UntrustworthyError(f"{path.name}: {error}") from error
    fields = ("code", "reason", "title", "hint")
    if not isinstance(given, dict) or not all(isinstance(given.get(name), str) for name in fields):
        raise UntrustworthyError(f"{path.name} is not an error description")
    if given["reason"] not in get_args(Reason):
        raise UntrustworthyError(f"{path.name} has an unknown reason")
    return MeshError(*(given[name] for name in fields))


def written_bytes(folder: Path) -> int:
    """Size of all files below a folder, with FILE_OVERHEAD_BYTES for each one and for each folder.

    UntrustworthyError if folders are nested deeper than LARGEST_DEPTH.
    """
    total, waiting = 0, [(folder, 0)]
    while waiting:
        parent, depth = waiting.pop()
        if depth > LARGEST_DEPTH:
            raise UntrustworthyError("folders are nested too deep")
        try:
            entries = list(os.scandir(parent))
        except OSError:  # it was removed meanwhile
            continue
        for entry in entries:
            total += FILE_OVERHEAD_BYTES
            if entry.is_dir(follow_symlinks=False):
                waiting.append((Path(entry.path), depth + 1))
            else:
                total += _size_bytes(entry)
    return total


def _size_bytes(entry: os.DirEntry[str]) -> int:
    try:
        return entry.stat(follow_symlinks=False).st_size
    except OSError:  # it was removed meanwhile
        return 0


def remove_folder(folder: Path) -> None:
    """Remove a folder with all that is in it, however deep; errors are ignored."""
    try:
        shutil.rmtree(folder, ignore_errors=True)
    except RecursionError:  # of Python 3.11
        subprocess.run(["rm", "-rf", "--", str(folder)], check=False)
