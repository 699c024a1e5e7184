"""Query parameters that a route does not declare are refused; those that the page sends are declared."""

from __future__ import annotations

import asyncio
import re
from pathlib import Path

from fastapi.routing import APIRoute
from galewood_server.api import ROUTERS
from galewood_server.http import query_names

from tests.server.support.in_process import application
from tests.server.support.server_process import Server

ROUTES = [route for router in ROUTERS for route in router.routes if isinstance(route, APIRoute)]
PAGE_SOURCES = Path(__file__).parents[3] / "web/src"
ADDRESS = re.compile(r"`(api/[^`?]*)\?([^`]*)`")
"""An address with a query in the page's sources."""
HOLE = re.compile(r"\$\{[^}]*\}")


def test_every_route_refuses_an_unknown_parameter(tmp_path: Path) -> None:
    asyncio.run(_ask_every_route(tmp_path))


async def _ask_every_route(tmp_path: Path) -> None:
    async with application(tmp_path, reads_per_minute=0, writes_per_minute=0) as (_, api):
        for route in ROUTES:
            address = re.sub(r"\{[^}]*\}", "x", route.path)
            for method in route.methods or ():
                body = {"tree_id": "x"} if method in ("POST", "PATCH") else None
                answer = await api.request(method, f"{address}?mispelt=1", json=body)
                assert answer.status_code == 422, (method, address, answer.text)
                if method == "HEAD":
                    continue
                problem = answer.json()
                assert problem["code"] == "unknown-parameter", (method, address, problem)
                assert "'mispelt'" in problem["title"]
                known = query_names(route.dependant)
                assert all(name in problem["hint"] for name in known), (method, address, problem)
    assert len(ROUTES) > 60


def test_the_nearest_parameter_is_named(server: Server) -> None:
    with server.client() as api:
        answers = [api.get(f"/api/{rest}") for rest in ("jobs?limits=3", "jobs?limit=3", "health?limit=3")]
    assert [answer.status_code for answer in answers] == [422, 200, 422]
    assert answers[0].json()["hint"] == (
        "Did you mean 'limit'? Parameters of this address: after, limit, state, tree_id."
    )
    assert answers[2].json()["hint"] == "This address takes none."


def test_the_page_asks_only_with_declared_parameters() -> None:
    asked = [
        (HOLE.sub("x", path), re.findall(r"(?:^|[&`])([a-z_]+)=", _spelt_out(query, text)))
        for text in (file.read_text() for file in sorted(PAGE_SOURCES.rglob("*.ts")))
        for path, query in ADDRESS.findall(text)
    ]
    assert {name for _, names in asked for name in names} >= {"version", "start_s", "direction_deg"}
    for path, names in asked:
        assert names, path
        route = next(route for route in ROUTES if route.path_regex.match(f"/{path}"))
        assert set(names) <= query_names(route.dependant), path


def _spelt_out(query: str, text: str) -> str:
    """The query; where it is a constant of the file, that constant."""
    name = re.fullmatch(r"\$\{(\w+)\}", query)
    constant = name and re.search(rf"const {name[1]} = `([^`]*)`", text)
    return constant[1] if constant else query
