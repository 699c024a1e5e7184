"""The REST API against its OpenAPI description with generated requests.

Schemathesis makes the requests; the examples are few and always the same. `GALEWOOD_API_EXAMPLES` and
`GALEWOOD_FUZZ_SEED` make more and other ones, as `make test-distributed` does.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
import schemathesis
from galewood_server.access import READ_ONLY_POSTS
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.strategies import booleans
from schemathesis.checks import not_a_server_error
from schemathesis.core.failures import FailureGroup
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from tests.server.support.server_process import FAKE_JOB, FAKE_SERVER, NO_CLUSTER, Server, wait_until

EXAMPLES = int(os.environ.get("GALEWOOD_API_EXAMPLES", "6"))
SEED = int(os.environ.get("GALEWOOD_FUZZ_SEED", "30"))
CHECKS: list[Any] = [
    not_a_server_error, status_code_conformance, content_type_conformance, response_schema_conformance,
]  # fmt: skip


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("openapi") / "data"
    data_dir.mkdir()
    unlimited = {"GALEWOOD_READS_PER_MINUTE": "0", "GALEWOOD_WRITES_PER_MINUTE": "0"}
    environment = {"GALEWOOD_JOB_MODULE": FAKE_JOB, **NO_CLUSTER, **unlimited}
    server = Server(data_dir, FAKE_SERVER, environment).start()
    yield server
    server.stop()


@pytest.fixture(scope="module")
def names_in_use(server: Server) -> dict[str, str]:
    """Identifiers of a computed tree and its resources."""
    with server.client() as api:
        tree = api.post("/api/trees?build=true", files={"file": ("a.obj", b"a tree")}).json()
        address = f"/api/trees/{tree['id']}"
        tree = wait_until(lambda: (now := api.get(address).json())["state"] == "ready" and now)
    return {"tree_id": tree["id"], "job_id": tree["job_id"], "sha256": tree["table_sha256"]}


@pytest.fixture(scope="module")
def described(server: Server) -> Any:
    # event streams do not end
    return schemathesis.openapi.from_url(f"{server.url}/openapi.json").exclude(path_regex=r"/events$")


EVERY_CHECK: list[Any] = list(HealthCheck)  # hypothesis does not type the members that it lists
FEW = settings(
    max_examples=EXAMPLES,
    deadline=None,
    database=None,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=EVERY_CHECK,
)


def test_every_response_matches_the_description(
    server: Server, described: Any, names_in_use: dict[str, str]
) -> None:
    tried = [operation.ok() for operation in described.get_all_operations()]
    complaints = [complaint for operation in tried if (complaint := _try(operation, names_in_use))]
    assert len(tried) > 20 and not complaints, "\n\n".join(complaints)
    asked = [line.rsplit(" ", 1) for line in httpx.get(f"{server.url}/metrics").text.splitlines()]
    asked = [(name, float(count)) for name, count in asked if name.startswith("galewood_http_requests_total")]
    print(sorted(asked))
    assert sum(count for _, count in asked) > 2 * len(tried)


def _try(operation: Any, known: dict[str, str]) -> str:
    """Failures of an operation; path parameters are random or existing identifiers."""

    @seed(SEED)
    @FEW
    @given(case=operation.as_strategy(), exists=booleans())
    def ask(case: Any, exists: bool) -> None:
        if exists:
            case.path_parameters.update({key: known[key] for key in case.path_parameters if key in known})
        case.validate_response(case.call(timeout=20), checks=CHECKS)

    try:
        ask()
    except FailureGroup as group:
        return f"{operation.label}: " + "; ".join(str(one) for one in group.exceptions)
    return ""


def test_every_route_has_a_description_and_problems(server: Server) -> None:
    with server.client() as api:
        paths = api.get("/openapi.json").json()["paths"]
    for path, operations in paths.items():
        for method, operation in operations.items():
            assert operation.get("description") or path == "/metrics", (method, path)
            if path.startswith("/api/"):
                assert "429" in operation["responses"], (method, path)
            if method in ("post", "put", "patch", "delete") and path not in READ_ONLY_POSTS:
                assert {"401", "403"} <= set(operation["responses"]) and operation["security"], (method, path)


def test_every_answer_has_a_type_and_a_schema(server: Server) -> None:
    with server.client() as api:
        paths = api.get("/openapi.json").json()["paths"]
    names: list[str] = []
    for path, operations in paths.items():
        for method, operation in operations.items():
            names.append(operation["operationId"])
            for status, answer in operation["responses"].items():
                kinds = answer.get("content", {})
                assert bool(kinds) == (status not in ("204", "304")), (method, path, status)
                assert all(kind.get("schema") for kind in kinds.values()), (method, path, status)
                if status[0] == "4":
                    assert list(kinds) == ["application/problem+json"], (method, path, status)
                assert (status in ("201", "202")) == ("Location" in answer.get("headers", {}))
    assert len(set(names)) == len(names) and all(name.isidentifier() for name in names)


def test_wrong_methods_are_answered_with_the_allowed_ones(server: Server) -> None:
    with httpx.Client(base_url=server.url) as api:
        answer = api.put("/api/trees")
        assert answer.status_code == 405 and answer.json()["code"] == "method-not-allowed"
        assert answer.headers["allow"]
