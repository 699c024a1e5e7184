"""What a build hands out before it is done: pictures drawn beside it, and a first table."""

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
"""Takes a name ("tetrahedra.png") and the content. Called by one thread at a time, not always the build's."""


class ArtefactPublisher:
    """Draws in helpers and publishes each picture as soon as it is there; does nothing where nobody looks.

    A picture that fails is logged: a build does not fail for it.
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
        """Start a picture; it is published when it is done."""
        if self._publish:
            drawn = self._pool.start(picture, *args, **kwargs)
            drawn.add_done_callback(lambda drawn: self._drawn(name, drawn))

    def _drawn(self, name: str, drawn: Future[bytes]) -> None:
        try:
            self.publish(name, drawn.result)
        except CancelledError:
            pass  # the build was stopped
        except Exception:
            log.exception("%s was not handed out", name)

    def publish(self, name: str, make: Callable[[], bytes]) -> None:
        """Publish what a function makes, if anybody looks."""
        if self._publish:
            content = make()
            with self._lock:
                self._publish(name, content)
