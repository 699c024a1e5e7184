"""Python client of the service: upload meshes, wait for tables, download them, and stream forests.

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
from galewood.formats import mesh_with_companions
from galewood.table import decode, encode
from httpx_sse import connect_sse
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosedError

from galewood_server.stream import wire

END_STATES = ("done", "failed", "cancelled")
READ_TIMEOUT_S = 60.0  # the server sends a ping at least every 15 s
MAX_TRIES = 5
Json = dict[str, Any]


class ServiceError(Exception):
    """A problem response of the service (RFC 9457)."""

    def __init__(self, status: int, code: str, title: str, hint: str) -> None:
        super().__init__(f"{title} {hint}".strip())
        self.status, self.code, self.title, self.hint = status, code, title, hint


class Client:
    """HTTP client of one server. `key` is the API key for write access, if the server requires one."""

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

    def upload(self, mesh: Path, **options: str | float | bool | list[str]) -> Json:
        """Upload a mesh, with the textures beside it, and return its tree. ServiceError.

        ``options`` are fields of ``galewood.ImportRequest``, and ``name``. The same file gives the same tree.
        """
        fields = {
            name: ",".join(value) if isinstance(value, list) else str(value)
            for name, value in options.items()
        }
        file = (mesh.name, mesh_with_companions(mesh))
        return self._request("POST", "/api/trees", files={"file": file}, data=fields)

    def tree(self, tree_id: str) -> Json:
        """A tree. ServiceError."""
        return self._request("GET", f"/api/trees/{tree_id}")

    def start(self, tree_id: str, **settings: Any) -> Json:
        """Compute a tree's table. Returns the job, already done if the table exists. ServiceError."""
        return self._request("POST", "/api/jobs", json={"tree_id": tree_id, "settings": settings})

    def follow(self, job_id: str, kind: str = "jobs") -> Iterator[Json]:
        """Yield the job at every change until it ends; reconnects if the connection breaks. ServiceError.

        `kind`: "jobs", "evaluations" or "comparisons".
        """
        tries = 0
        while True:
            try:
                for job in self._events(job_id, kind):
                    tries = 0
                    yield job
                    if job["state"] in END_STATES:
                        return
                time.sleep(1.0)  # the server is shutting down
            except httpx.TransportError:
                tries += 1
                if tries >= MAX_TRIES:
                    raise
                time.sleep(min(2.0**tries, 10.0))

    def table(self, sha256: str) -> bytes:
        """Download a table and verify its hash. ServiceError; ValueError if it is damaged."""
        return self._file("tables", sha256)

    def records(self, sha256: str) -> bytes:
        """Download the records of a table (`records_sha256`) and verify their hash.

        ServiceError; ValueError if they are damaged.
        """
        return self._file("records", sha256)

    def whole_table(self, tree: Json) -> bytes:
        """The table of a tree in one file, with the paper's records if they are computed. ServiceError."""
        table = self.table(tree["table_sha256"])
        if not tree["records_sha256"]:
            return table
        return encode(decode(table, self.records(tree["records_sha256"])))

    def _file(self, kind: str, sha256: str) -> bytes:
        answer = self._http.get(f"/api/{kind}/{sha256}")
        _check(answer)
        if hashlib.sha256(answer.content).hexdigest() != sha256:
            raise ValueError(f"the downloaded file of {kind} is damaged")
        return answer.content

    def cancel(self, job_id: str, kind: str = "jobs") -> Json:
        """Cancel a job. ServiceError."""
        return self._request("POST", f"/api/{kind}/{job_id}/cancel")

    def evaluate(self, tree_id: str, **parameters: float) -> Json:
        """Start an evaluation of a tree's table with `sway` or `speed_m_s`, `frames` and `seed`.

        Use `follow` with kind "evaluations" to wait for it. ServiceError.
        """
        return self._request("POST", f"/api/trees/{tree_id}/evaluations", json=parameters)

    def evaluations(self, tree_id: str) -> list[Json]:
        """The evaluations of a tree, newest first. ServiceError."""
        return self._request("GET", f"/api/trees/{tree_id}/evaluations")["evaluations"]

    def evaluation_report(self, evaluation_id: str) -> Json:
        """The report of a finished evaluation (spec/formats/evaluation.md). ServiceError."""
        return self._request("GET", f"/api/evaluations/{evaluation_id}/report")

    def evaluation_plot(self, evaluation_id: str) -> bytes:
        """The error plot of a finished evaluation (PNG). ServiceError."""
        answer = self._http.get(f"/api/evaluations/{evaluation_id}/plot")
        _check(answer)
        return answer.content

    def _events(self, job_id: str, kind: str) -> Iterator[Json]:
        timeout = httpx.Timeout(60.0, read=READ_TIMEOUT_S)
        path = f"/api/{kind}/{job_id}/events"
        with connect_sse(self._http, "GET", path, timeout=timeout) as source:
            if source.response.is_error:
                source.response.read()
            _check(source.response)
            for event in source.iter_sse():
                yield event.json()

    def _request(self, method: str, path: str, **given: Any) -> Json:
        answer = self._http.request(method, path, **given)
        _check(answer)
        return answer.json()


def _check(answer: httpx.Response) -> None:
    if not answer.is_error:
        return
    try:
        problem: Json = answer.json()
    except ValueError:
        problem = {}
    title = problem.get("title") or f"The server responded with status {answer.status_code}."
    raise ServiceError(answer.status_code, problem.get("code", ""), title, problem.get("hint", ""))


async def stream(url: str, forest: wire.Forest, name: str = "galewood client") -> AsyncIterator[wire.Reply]:
    """Yield the server's messages about a forest (stream/wire) until the caller stops.

    `url` is the server's, as for Client. Ends after a Failure. ConnectionClosedError if the socket breaks.
    """
    address = url.rstrip("/").replace("http", "ws", 1) + "/ws/forest"
    if forest.share is not None:  # by which a proxy finds the server of this forest
        address += f"?share={forest.share}"
    async with connect(address, max_size=None, compression=None) as socket:
        for request in (wire.Hello(name), forest):
            await socket.send(wire.encode_request(request))
        reply: wire.Reply | None = None
        try:
            async for message in socket:
                if isinstance(message, bytes):
                    reply = wire.decode_reply(message)
                    yield reply
        except ConnectionClosedError:
            if not isinstance(reply, wire.Failure):  # the Failure has the reason
                raise
