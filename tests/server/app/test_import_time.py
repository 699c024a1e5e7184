"""Startup: importing the application must not load the numerical packages of builds."""

from __future__ import annotations

import json
import subprocess
import sys

from tests.server.support.server_process import REPOSITORY

HEAVY = (
    "dask", "distributed", "galewood.solid.fem", "galewood.tree", "galewood.solid.model", "alembic",
    "galewood.pipeline.stages", "galewood.pipeline.tables", "galewood.pipeline.reduction",
    "galewood.pipeline.sampling", "matplotlib", "numba", "scipy", "trimesh",
)  # fmt: skip


def test_importing_the_application_loads_no_build_packages() -> None:
    program = "import json, sys; import galewood_server.app; print(json.dumps(sorted(sys.modules)))"
    output = subprocess.run(
        [sys.executable, "-c", program], cwd=REPOSITORY, capture_output=True, check=True, text=True
    ).stdout
    loaded = set(json.loads(output.splitlines()[-1]))
    assert "galewood_server.app.main" in loaded
    assert not loaded & set(HEAVY)
