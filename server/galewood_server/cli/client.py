"""A client of the service: send a mesh, wait for its table, fetch it, follow a forest.

with Client("http://127.0.0.1:8000", key=None) as galewood:
    tree = galewood.upload(Path("oak.glb"), species="maple")
    for job in galewood.follow(galewood.start(tree["id"])["id"]):
        print(job["stage"], job["fraction"])
    table = galewood.table(galewood.tree(tree["id"])["table_sha256"])
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any, Self

import httpx
from httpx_sse import connect_sse
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosedError

from galewood_server.stream import Failure, Forest, Hello, Reply, decode_reply, encode_request

ENDED = ("done", "failed", "cancelled")
QUIET_S = 60.0  # the server says something at least every 15 s
TRIES = 5
Json = dict[str, Any]


class ServiceError(Exception):
    """A problem that the service told (RFC 9457): `status`, `code`, and words for people."""

    def __init__(self, status: int, code: str, title: str, hint: str) -> None:
        super().__init__(f"{title} {hint}".strip())
        self.status, self.code, self.title, self.hint = status, code, title, hint


class Client:
    """Talks to one server; `key` is needed for what changes anything, where the server asks for one."""

    def __init__(
        self, url: str, key: str | None = None, *, transport: httpx.BaseTransport | None = None
    ) -> None:
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        timeout = httpx.Timeout(60.0, write=300.0)
        self._url = url.rstrip("/")
        self._http = httpx.Client(base_url=self._url, headers=headers, timeout=timeout, transport=transport)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._http.close()

    def upload(self, mesh: Path, **assumptions: str | float) -> Json:
        """Send a mesh; the tree with its report. The same file again is the same tree. ServiceError."""
        fields = {name: str(value) for name, value in assumptions.items()}
        with mesh.open("rb") as file:
            return self._ask("POST", "/api/trees", files={"file": (mesh.name, file)}, data=fields)

    def tree(self, tree_id: str) -> Json:
        """A tree as it stands. ServiceError."""
        return self._ask("GET", f"/api/trees/{tree_id}")

    def start(self, tree_id: str, **settings: Any) -> Json:
        """Have a tree's table computed; its job, done already if the table is there. ServiceError."""
        return self._ask("POST", "/api/jobs", json={"tree_id": tree_id, "settings": settings})

    def follow(self, job_id: str, kind: str = "jobs") -> Iterator[Json]:
        """The job at every change until it ends; a broken connection is taken up again. ServiceError.

        `kind`: "jobs", "evaluations" or "comparisons".
        """
        tries = 0
        while True:
            try:
                for job in self._events(job_id, kind):
                    tries = 0
                    yield job
                    if job["state"] in ENDED:
                        return
                time.sleep(1.0)  # the server ended it, as it does when it stops
            except httpx.TransportError:
                tries += 1
                if tries >= TRIES:
                    raise
                time.sleep(min(2.0**tries, 10.0))

    def table(self, sha256: str) -> bytes:
        """A table's bytes, held against their hash. ServiceError; ValueError if they are damaged."""
        answer = self._http.get(f"/api/tables/{sha256}")
        _check(answer)
        if hashlib.sha256(answer.content).hexdigest() != sha256:
            raise ValueError("the table came damaged")
        return answer.content

    def cancel(self, job_id: str, kind: str = "jobs") -> Json:
        """Ask a job to stop. ServiceError."""
        return self._ask("POST", f"/api/{kind}/{job_id}/cancel")

    def evaluate(self, tree_id: str, **asked: float) -> Json:
        """Have a tree's table held against its finite elements: `sway` or `speed_m_s`, `frames`, `seed`; the
        evaluation, to be followed as one of the kind "evaluations". ServiceError.
        """
        return self._ask("POST", f"/api/trees/{tree_id}/evaluations", json=asked)

    def evaluations(self, tree_id: str) -> list[Json]:
        """The evaluations of a tree, the newest first. ServiceError."""
        return self._ask("GET", f"/api/trees/{tree_id}/evaluations")["evaluations"]

    def evaluation_report(self, evaluation_id: str) -> Json:
        """All figures of an evaluation that is done (docs/formats/evaluation.md). ServiceError."""
        return self._ask("GET", f"/api/evaluations/{evaluation_id}/report")

    def evaluation_plot(self, evaluation_id: str) -> bytes:
        """Its errors over time as a PNG. ServiceError."""
        answer = self._http.get(f"/api/evaluations/{evaluation_id}/plot")
        _check(answer)
        return answer.content

    def _events(self, job_id: str, kind: str) -> Iterator[Json]:
        timeout = httpx.Timeout(60.0, read=QUIET_S)
        path = f"/api/{kind}/{job_id}/events"
        with connect_sse(self._http, "GET", path, timeout=timeout) as source:
            if source.response.is_error:
                source.response.read()
            _check(source.response)
            for event in source.iter_sse():
                yield event.json()

    def _ask(self, method: str, path: str, **given: Any) -> Json:
        answer = self._http.request(method, path, **given)
        _check(answer)
        return answer.json()


def _check(answer: httpx.Response) -> None:
    if not answer.is_error:
        return
    try:
        told: Json = answer.json()
    except ValueError:
        told = {}
    title = told.get("title") or f"The server answered {answer.status_code}."
    raise ServiceError(answer.status_code, told.get("code", ""), title, told.get("hint", ""))


async def stream(url: str, forest: Forest, name: str = "galewood client") -> AsyncIterator[Reply]:
    """What the server sends of a forest (stream/wire.py), until the caller has had enough.

    `url` is the server's, as for Client. Ends after a Failure; ConnectionClosedError if
    the socket breaks.
    """
    address = url.rstrip("/").replace("http", "ws", 1) + "/ws/forest"
    async with connect(address, max_size=None, compression=None) as socket:
        for request in (Hello(name), forest):
            await socket.send(encode_request(request))
        reply: Reply | None = None
        try:
            async for message in socket:
                if isinstance(message, bytes):
                    reply = decode_reply(message)
                    yield reply
        except ConnectionClosedError:
            if not isinstance(reply, Failure):  # which said why
                raise
