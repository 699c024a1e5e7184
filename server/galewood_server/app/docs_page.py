"""`/docs`: the interface as a page to read and try, by Swagger UI, all of it from this server.

The viewer's files come with a package (`fastapi-offline`, which pins them); nothing is loaded from another
host and no script stands in the page, so that the policy in headers.py is as strict as for our own page.
"""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import HTMLResponse, Response
from starlette.staticfiles import StaticFiles

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Galewood: the interface for programs</title>
<link rel="icon" href="docs/files/favicon.png"><link rel="stylesheet" href="docs/files/swagger-ui.css">
</head><body><main id="reference"><noscript>The same for programs: <a href="openapi.json">openapi.json</a>
</noscript></main><script src="docs/files/swagger-ui-bundle.js"></script><script src="docs/start.js"></script>
</body></html>"""
START = """SwaggerUIBundle({
  url: "openapi.json",
  dom_id: "#reference",
  deepLinking: true,
  docExpansion: "list",
  defaultModelsExpandDepth: 0,
  validatorUrl: null,
});
"""


def install(app: FastAPI) -> None:
    """Serve the page, its start and the viewer's files."""
    app.add_api_route("/docs", _page, include_in_schema=False)
    app.add_api_route("/docs/start.js", _start, include_in_schema=False)
    app.mount("/docs/files", StaticFiles(directory=_viewer_files()))


def _page() -> Response:
    return HTMLResponse(PAGE, headers={"Cache-Control": "no-cache"})


def _start() -> Response:
    return Response(START, media_type="text/javascript", headers={"Cache-Control": "no-cache"})


def _viewer_files() -> Path:
    """Where the package has them, found without importing it, as it brings an application of its own."""
    package = find_spec("fastapi_offline")
    assert package and package.origin
    return Path(package.origin).parent / "static"
