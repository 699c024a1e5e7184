"""Reading an upload in a child process with limits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from precompute.intake_types import IntakeOptions
from server.settings import Settings


def read_upload_tree(settings: Settings) -> Callable[[bytes, str, IntakeOptions], Any]:
    def read(data: bytes, filename: str, options: IntakeOptions) -> Any:
        from precompute.intake_process import run_intake

        return run_intake(data, filename, options, None)

    return read
