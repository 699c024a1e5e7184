"""Files that are whole or not there."""

from __future__ import annotations

import io
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np


def write_whole(target: Path, data: bytes | memoryview) -> None:
    """Write beside the target, flush to disk, then rename: a reader or a crash never meets a torn file.

    The temporary name begins with ".part-" and is its writer's own: two processes may write the same file.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=".part-")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())  # else a power cut could leave the name without the content
        Path(name).replace(target)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def write_arrays(target: Path, **arrays: Any) -> None:
    """Write named arrays as an .npz file."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    write_whole(target, buffer.getbuffer())
