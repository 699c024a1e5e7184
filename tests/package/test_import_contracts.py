"""Every contract on imports fails on a violation: each is planted in a copy of the sources and found."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
LINT_IMPORTS = Path(sys.executable).with_name("lint-imports")
PLANTED = {
    "upward import in the library": (
        "precompute/galewood/solid/fem/solver.py",
        "from galewood.pipeline.tables import BuildOptions",
        "The library's packages import downwards only",
    ),
    "upward import in the service": (
        "server/galewood_server/storage/files.py",
        "from galewood_server.http import ProblemError",
        "The service's packages import downwards only",
    ),
    "a package without a layer": (
        "precompute/galewood/newcomer/__init__.py",
        "",
        "The library's packages import downwards only",
    ),
    "HTTP in the library": (
        "precompute/galewood/table/format.py",
        "import httpx",
        "The library knows no server, HTTP or database",
    ),
    "the server in the library": (
        "precompute/galewood/util/errors.py",
        "import galewood_server.settings",
        "The library knows no server, HTTP or database",
    ),
    "a database in the library": (
        "precompute/galewood/io/api/tables.py",
        "import sqlalchemy",
        "The library knows no server, HTTP or database",
    ),
    "Dask outside the jobs": (
        "server/galewood_server/stream/forest.py",
        "import distributed",
        "Only galewood_server.jobs imports Dask",
    ),
    "a cycle": (
        "precompute/galewood/solid/fem/elements/rotation.py",
        "from galewood.solid.fem.dynamics import Simulator",
        "No import cycles between modules",
    ),
    "a module of another package": (
        "precompute/galewood/pipeline/tables/report.py",
        "from galewood.solid.fem.solver import NotPositiveDefinite",
        "Other packages import a package's public names",
    ),
}


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    copy = tmp_path_factory.mktemp("sources")
    for part in ("precompute", "server", "scripts"):
        shutil.copytree(REPOSITORY / part, copy / part, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(REPOSITORY / "pyproject.toml", copy)
    return copy


def lint(folder: Path) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join([str(folder), str(folder / "precompute"), str(folder / "server")])
    return subprocess.run(
        [LINT_IMPORTS, "--no-cache"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path, "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_sources_keep_every_contract(sources: Path) -> None:
    found = lint(sources)
    assert found.returncode == 0, found.stdout
    assert " 0 broken" in found.stdout


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_violation_is_found(sources: Path, name: str) -> None:
    file, line, contract = PLANTED[name]
    path = sources / file
    before = path.read_text() if path.exists() else None
    path.parent.mkdir(exist_ok=True)
    try:
        path.write_text(f"{before or ''}\n{line}\n")
        found = lint(sources)
    finally:
        if before is None:
            shutil.rmtree(path.parent)
        else:
            path.write_text(before)
    assert found.returncode != 0
    assert f"{contract} BROKEN" in found.stdout or f"{contract}, not its modules BROKEN" in found.stdout
