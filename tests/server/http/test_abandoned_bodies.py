"""Clients that leave while they send: 499 in the metrics, and nothing that looks like an error in the log."""

from __future__ import annotations

import re
import socket
from collections.abc import Callable
from typing import Any

from tests.server.support.server_process import Server, wait_until

FORM = "multipart/form-data; boundary=x"
PART = b'--x\r\nContent-Disposition: form-data; name="file"; filename="a.obj"\r\n\r\nv 0 0 0\n'
JSON = b'{"name": "'


def operations_with_a_body(document: dict[str, Any]) -> list[tuple[str, str, str]]:
    """Method, path and media type of each operation of the API that takes a body."""
    return [
        (method.upper(), path, next(iter(operation["requestBody"]["content"])))
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
        if "requestBody" in operation
    ]


def leave(server: Server, method: str, path: str, media: str) -> None:
    """Send the head of a request and the beginning of its body, and close the connection."""
    form = media == "multipart/form-data"
    head = f"{method} {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 500\r\n"
    head += f"Content-Type: {FORM if form else media}\r\n\r\n"
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        connection.sendall(head.encode() + (PART if form else JSON))


def statuses(server: Server, method: str, path: str) -> set[str]:
    """The statuses of an operation in the metrics."""
    with server.client() as api:
        text = api.get("/metrics").text
    labels = f'galewood_http_requests_total{{method="{method}",route="{re.escape(path)}",status="(\\d+)"}}'
    return set(re.findall(labels, text))


def test_a_client_that_leaves_within_the_body_is_no_error(start_server: Callable[..., Server]) -> None:
    server = start_server()
    with server.client() as api:
        operations = operations_with_a_body(api.get("/openapi.json").json())
    assert {"/api/trees", "/api/winds/validate", "/api/jobs"} <= {path for _, path, _ in operations}
    for method, path, media in operations:
        leave(server, method, path.replace("{tree_id}", "none"), media)
        assert wait_until(lambda m=method, p=path: statuses(server, m, p)) == {"499"}, (method, path)
    server.stop()
    assert not [line for line in server.log().splitlines() if "Traceback" in line or "failed" in line]
