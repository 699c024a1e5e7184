"""Artefacts that a build publishes before it is done: pictures and preliminary tables."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from typing import ParamSpec

from galewood.util import WorkerPool

log = logging.getLogger("galewood.build")
Arguments = ParamSpec("Arguments")
Publish = Callable[[str, bytes], None]
"""Receives a name ("tetrahedra.png") and the content. Called by one thread at a time, not always the same."""


class ArtefactPublisher:
    """Draws pictures in the worker pool and publishes each when it is done; does nothing without ``publish``.

    A picture that fails is logged and does not fail the build.
    """

    def __init__(self, pool: WorkerPool, publish: Publish | None) -> None:
        self._pool = pool
        self._publish = publish
        self._lock = threading.Lock()

    def draw(
        self,
        name: str,
        picture: Callable[Arguments, bytes],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> None:
        """Start drawing a picture in the worker pool; it is published when it is done."""
        if self._publish:
            future = self._pool.start(picture, *args, **kwargs)
            future.add_done_callback(lambda drawn: self._drawn(name, drawn))

    def _drawn(self, name: str, drawn: Future[bytes]) -> None:
        try:
            self.publish(name, drawn.result)
        except CancelledError:
            pass  # the build was cancelled
        except Exception:
            log.exception("could not publish %s", name)

    def publish(self, name: str, make: Callable[[], bytes]) -> None:
        """Publish the result of ``make``; without ``publish`` it is not called."""
        if self._publish:
            content = make()
            with self._lock:
                self._publish(name, content)
