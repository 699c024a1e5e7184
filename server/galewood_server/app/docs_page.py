"""`/docs`: the REST API in Swagger UI, served entirely from this server.

The viewer's files come from the package `fastapi-offline`. Nothing is loaded from other hosts and the page
has no inline script, so that the content security policy in headers.py can stay strict.
"""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import HTMLResponse, Response
from starlette.staticfiles import StaticFiles

DOCS_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Galewood REST API</title>
<link rel="icon" href="docs/files/favicon.png"><link rel="stylesheet" href="docs/files/swagger-ui.css">
</head><body><main id="reference"><noscript>
This page needs JavaScript. Machine-readable description: <a href="openapi.json">openapi.json</a>
</noscript></main><script src="docs/files/swagger-ui-bundle.js"></script><script src="docs/start.js"></script>
</body></html>"""
START_SCRIPT = """SwaggerUIBundle({
  url: "openapi.json",
  dom_id: "#reference",
  deepLinking: true,
  docExpansion: "list",
  defaultModelsExpandDepth: 0,
  validatorUrl: null,
});
"""


def install(app: FastAPI) -> None:
    """Add the routes of the page, its start script and the viewer's files."""
    app.add_api_route("/docs", _page, include_in_schema=False)
    app.add_api_route("/docs/start.js", _start, include_in_schema=False)
    app.mount("/docs/files", StaticFiles(directory=_viewer_files()))


def _page() -> Response:
    return HTMLResponse(DOCS_PAGE, headers={"Cache-Control": "no-cache"})


def _start() -> Response:
    return Response(START_SCRIPT, media_type="text/javascript", headers={"Cache-Control": "no-cache"})


def _viewer_files() -> Path:
    """The package's static files, located without importing it (it would create an application)."""
    package = find_spec("fastapi_offline")
    assert package and package.origin
    return Path(package.origin).parent / "static"
