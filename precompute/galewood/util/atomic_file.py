"""Atomic file writes: a file either has its complete content or does not exist."""

from __future__ import annotations

import io
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np


def write_atomically(target: Path, data: bytes | memoryview) -> None:
    """Write a file atomically: write to a temporary file beside the target, flush to disk, then rename.

    Readers never see a partial file, even after a crash. The temporary name begins with ".part-" and is
    unique to the writer, so several processes may write the same target at once.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=".part-")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())  # otherwise a power failure could leave a renamed but empty file
        Path(name).replace(target)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def write_arrays(target: Path, **arrays: Any) -> None:
    """Write named arrays atomically as an .npz file."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    write_atomically(target, buffer.getbuffer())
