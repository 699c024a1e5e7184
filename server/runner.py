"""The pipeline's trajectory runner on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any


class DaskRunner:
    """Samples every wind on the cluster; the trajectories are files in the cache that all processes share."""

    def __init__(self, client: Any) -> None:
        self._client = client

    def __call__(self, model: Path, winds: Sequence[Any], done: Callable[[int], None]) -> list[Path]:
        raise RuntimeError("not landed")
