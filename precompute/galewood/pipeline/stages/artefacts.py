"""Artefacts that a build publishes before it is done: pictures and preliminary tables."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from concurrent.futures import CancelledError
from typing import ParamSpec

from galewood.util import WorkerPool

log = logging.getLogger("galewood.build")
RENDER_MESH_FILE = "render.glb"
"""Name under which a build publishes the mesh that its tables animate."""
TETS_PREFIX = "tets-"
"""Tetrahedra are published under their name in the mesher's cache, which begins with this."""
Arguments = ParamSpec("Arguments")
Publish = Callable[[str, bytes], None]
"""Receives a name ("tetrahedra.png") and the content. Called by one thread at a time, not always the same."""


class ArtefactPublisher:
    """Publishes artefacts as soon as they are done; does nothing without ``publish``.

    Pictures are drawn in the worker pool. What fails in the background is logged and does not fail the build.
    """

    def __init__(self, pool: WorkerPool, publish: Publish | None) -> None:
        self._pool = pool
        self._publish = publish
        self._lock = threading.Lock()
        self._computing: list[threading.Thread] = []

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
            future.add_done_callback(lambda drawn: self._publish_safely(name, drawn.result))

    def compute(self, name: str, make: Callable[[], bytes | None]) -> None:
        """Start computing an artefact in a thread; it is published when it is done.

        The workers are still starting when the first table is wanted, and this process waits for the mesher.
        """
        if self._publish:
            thread = threading.Thread(target=self._publish_safely, args=(name, make), name=name, daemon=True)
            self._computing.append(thread)
            thread.start()

    def wait(self) -> None:
        """Wait until everything that is computed in threads is published: what follows replaces it."""
        while self._computing:
            self._computing.pop().join()

    def _publish_safely(self, name: str, make: Callable[[], bytes | None]) -> None:
        try:
            self.publish(name, make)
        except CancelledError:
            pass  # the build was cancelled
        except Exception:
            log.exception("could not publish %s", name)

    def publish(self, name: str, make: Callable[[], bytes | None]) -> None:
        """Publish the result of ``make``, unless it is None; without ``publish`` it is not called."""
        if self._publish:
            content = make()
            if content is None:
                log.info("%s is not published", name)
                return
            with self._lock:
                self._publish(name, content)
