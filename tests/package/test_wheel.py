"""The wheel alone, installed with what it declares and far from the repository: it builds a tree and serves.

First only `galewood` is installed, then `galewood[server]`; both take the locked versions, so that what is
tested is which packages are declared, not which versions are new today.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil
import pytest
from numba.core.caching import _CacheLocator  # pyright: ignore[reportPrivateUsage]

from tests.precompute.fixtures.shared_tets import small_tree_glb
from tests.server.support.server_process import free_port

REPOSITORY = Path(__file__).resolve().parents[2]
BUILTIN_NAMES = sorted(
    tree["name"] for tree in json.loads((REPOSITORY / "assets/species/species.json").read_bytes())
)
LOOK_S = 0.1
QUICK = (
    "--species", "maple", "--target-tets", "500", "--frames", "4", "--sampled-elements", "1",
    "--reference-frames", "0",
)  # fmt: skip
DECODE = """
import json, sys
from pathlib import Path
import galewood
from galewood.table import decode
table = decode(Path(sys.argv[1]).read_bytes())
print(json.dumps({
    "code": galewood.__file__, "species": table.metadata["species"], "vertices": len(table.vertex_node),
}))
"""
SHOW = """
import galewood
from galewood.packaged import data_folder, species_folder
print(species_folder(), data_folder("notebook", "web/player/dist/notebook") / "widget.js", sep="\\n")
galewood.show("poplar")
"""
pytestmark = pytest.mark.timeout(1800)  # the first install of a machine fetches a few hundred megabytes


@dataclass(frozen=True)
class Installation:
    """An environment of its own, and a folder to work in; neither is inside the repository."""

    environment: Path
    here: Path

    def variables(self) -> dict[str, str]:
        """Nothing that leads to the repository, to our settings or to node."""
        kept = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("GALEWOOD_", "PYTHON", "NUMBA_", "PYTEST_", "VIRTUAL_ENV"))
            and name not in ("HOST", "PORT", "MAKEFLAGS", "MAKELEVEL")
        }
        folders = [str(self.environment / "bin"), *os.environ["PATH"].split(os.pathsep)]
        without_node = [
            folder
            for folder in folders
            if not any(Path(folder, name).exists() for name in ("node", "npm"))
            and not Path(folder).resolve().is_relative_to(REPOSITORY)
        ]
        return kept | {"PATH": os.pathsep.join(without_node), "NUMBA_CACHE_DIR": str(self.kernels)}

    def run(self, program: str, *arguments: str | Path, **settings: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [self.environment / "bin" / program, *arguments],
            cwd=self.here, env=self.variables() | settings, capture_output=True, text=True,
        )  # fmt: skip

    def install(self, what: str) -> None:
        """With what it declares, in the locked versions."""
        constraints = self.here / "locked.txt"
        lock = (REPOSITORY / "requirements" / "base.txt").read_text()
        constraints.write_text("\n".join(re.findall(r"(?m)^\S+==\S+", lock)) + "\n")
        pip = [sys.executable, "-m", "pip", "--python", self.environment / "bin" / "python", "install"]
        options = ["--quiet", "--disable-pip-version-check", "--only-binary", ":all:", "--no-compile"]
        installed = subprocess.run(
            [*pip, *options, "--constraint", constraints, what],
            cwd=self.here, env=self.variables(), capture_output=True, text=True,
        )  # fmt: skip
        assert installed.returncode == 0, installed.stderr

    def take_kernels(self) -> None:
        """Use the repository's compiled kernels, if there are any: to compile all takes longer than to build.

        numba finds them by the source's folder; the source's time and size must be those at compilation.
        """
        compiled = os.environ.get("NUMBA_CACHE_DIR")
        if compiled is None:
            return
        [installed] = (self.environment / "lib").glob("*/site-packages/galewood")
        for copy in installed.rglob("*.py"):
            source = REPOSITORY / "precompute" / "galewood" / copy.relative_to(installed)
            os.utime(copy, ns=(source.stat().st_atime_ns, source.stat().st_mtime_ns))
            theirs = Path(compiled, _CacheLocator.get_suitable_cache_subpath(str(source)))
            if theirs.is_dir():
                ours = self.kernels / _CacheLocator.get_suitable_cache_subpath(str(copy))
                shutil.copytree(theirs, ours, dirs_exist_ok=True)

    @property
    def kernels(self) -> Path:
        return self.here / "kernels"

    def processes(self) -> list[psutil.Process]:
        """What still runs with this environment's Python: a server that ends leaves children for a moment."""
        python = str(self.environment / "bin" / "python")
        return [one for one in psutil.process_iter(["cmdline"]) if python in (one.info["cmdline"] or [])]

    def remove(self) -> None:
        """Once nobody uses it; pytest would keep those of three runs, a gigabyte each."""
        while running := self.processes():
            psutil.wait_procs(running, timeout=1)
        shutil.rmtree(self.environment)


@dataclass(frozen=True)
class Alone:
    """What came of the commands while only the library's dependencies were there."""

    installation: Installation
    build: subprocess.CompletedProcess[str]
    decoded: subprocess.CompletedProcess[str]
    show: subprocess.CompletedProcess[str]
    serve: subprocess.CompletedProcess[str]
    key: subprocess.CompletedProcess[str]


@pytest.fixture(scope="module")
def wheel() -> Path:
    """The wheel of `make wheel`, made anew where a source is newer than it."""
    python = Path(sys.executable)
    # packages are there, or this would not run: make need not install any
    make = ["make", "--silent", "--old-file=.venv/.base", f"BIN={python.parent}", "wheel"]
    made = subprocess.run(make, cwd=REPOSITORY, capture_output=True, text=True)
    assert made.returncode == 0, made.stdout + made.stderr
    [path] = (REPOSITORY / "build" / "wheel").glob("*.whl")
    return path


@pytest.fixture(scope="module")
def installation(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Installation]:
    folder = tmp_path_factory.mktemp("installed")
    assert not folder.resolve().is_relative_to(REPOSITORY)
    (folder / "here").mkdir()
    # without a pip of its own, which takes seconds to set up: ours installs into it
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder / "environment"], check=True)
    made = Installation(folder / "environment", folder / "here")
    yield made
    made.remove()


@pytest.fixture(scope="module")
def alone(installation: Installation, wheel: Path) -> Alone:
    installation.install(str(wheel))
    installation.take_kernels()
    (installation.here / "tree.glb").write_bytes(small_tree_glb())
    build = ("build", "tree.glb", "--out", "tree.gwt", *QUICK)
    return Alone(
        installation,
        installation.run("galewood", *build),
        installation.run("python", "-c", DECODE, "tree.gwt"),
        installation.run("python", "-c", SHOW),
        installation.run("galewood", "serve"),
        installation.run("galewood", "key"),
    )


@dataclass
class Served:
    """A server of the installed wheel."""

    process: subprocess.Popen[bytes]
    url: str
    log: Path

    def get(self, path: str) -> tuple[int, str, bytes]:
        """Status, type and content."""
        try:
            with urllib.request.urlopen(f"{self.url}{path}") as answer:
                return answer.status, answer.headers.get_content_type(), answer.read()
        except urllib.error.HTTPError as error:
            return error.code, "", error.read()

    def json(self, path: str) -> Any:
        status, _, content = self.get(path)
        assert status == 200, content
        return json.loads(content)

    def answers(self) -> bool:
        try:
            return self.get("/api/health")[0] == 200
        except OSError:
            return False

    def wait_for(self, what: str) -> None:
        """Until a method of ours says yes; no longer than the server runs."""
        while not getattr(self, what)():
            assert self.process.poll() is None, self.log.read_text()
            time.sleep(LOOK_S)

    def has_its_species(self) -> bool:
        return len(self.json("/api/trees")["trees"]) >= len(BUILTIN_NAMES)


@pytest.fixture(scope="module")
def served(alone: Alone, wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    installation, port = alone.installation, free_port()
    installation.install(f"{wheel}[server]")
    log, data = installation.here / "serve.log", tmp_path_factory.mktemp("data")
    with log.open("wb") as output:
        process = subprocess.Popen(
            [installation.environment / "bin" / "galewood", "serve", "--port", str(port), "--data-dir", data],
            cwd=installation.here, env=installation.variables(), stdout=output, stderr=output,
        )  # fmt: skip
    server = Served(process, f"http://127.0.0.1:{port}", log)
    try:
        server.wait_for("answers")
        yield server
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait()


def test_the_wheel_holds_everything_once(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    assert len(names) == len(set(names))
    sources = {
        f"{package}/{path.relative_to(folder).as_posix()}"
        for package, folder in (
            ("galewood", REPOSITORY / "precompute/galewood"),
            ("galewood_server", REPOSITORY / "server/galewood_server"),
        )
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    copies = {
        f"{name}/{path.relative_to(folder).as_posix()}"
        for name, folder in (
            ("galewood_server/data/page", REPOSITORY / "web/dist"),
            ("galewood/data/species", REPOSITORY / "assets/species"),
            ("galewood/data/grower", REPOSITORY / "tools/species/dist"),
            ("galewood/data/notebook", REPOSITORY / "web/player/dist/notebook"),
        )
        for path in folder.rglob("*")
        if path.is_file()
    }
    packed = {name for name in names if ".dist-info/" not in name}
    assert packed == sources | copies
    assert {"galewood/py.typed", "galewood_server/py.typed"} <= packed
    assert "galewood_server/storage/migrations/script.py.mako" in packed


def test_node_is_out_of_reach(installation: Installation) -> None:
    path = installation.variables()["PATH"]
    assert shutil.which("node", path=path) is None
    assert shutil.which("npm", path=path) is None


def test_the_library_alone_builds_a_table(alone: Alone) -> None:
    assert alone.build.returncode == 0, alone.build.stderr
    assert alone.decoded.returncode == 0, alone.decoded.stderr
    told = json.loads(alone.decoded.stdout)
    assert Path(told["code"]).is_relative_to(alone.installation.environment)
    assert told["species"] == "maple"
    assert told["vertices"] > 0


def test_without_its_extra_show_says_what_to_install(alone: Alone) -> None:
    assert alone.show.stderr.strip().splitlines()[-1].endswith("pip install 'galewood[notebook]'")
    files = [Path(line) for line in alone.show.stdout.splitlines()]
    assert all(file.is_relative_to(alone.installation.environment) and file.exists() for file in files)
    assert len(files) == 2


def test_without_its_extra_the_service_says_what_to_install(alone: Alone) -> None:
    for command in (alone.serve, alone.key):
        assert command.returncode == 1
        assert "galewood[server]" in command.stderr
        assert "Traceback" not in command.stderr
        assert len(command.stderr.strip().splitlines()) == 1, command.stderr


def test_without_its_extra_postgresql_is_refused_in_words(served: Served, alone: Alone) -> None:
    elsewhere = "postgresql://nobody@127.0.0.1/nothing"
    serve = alone.installation.run("galewood", "serve", GALEWOOD_DATABASE_URL=elsewhere)
    assert serve.returncode == 1
    assert "galewood[server,distributed]" in serve.stderr
    assert "Traceback" not in serve.stderr


def test_the_page_and_its_scripts_are_served(served: Served) -> None:
    status, kind, page = served.get("/")
    assert (status, kind) == (200, "text/html")
    scripts = re.findall(r'<script[^>]* src="([^"]+)"', page.decode())
    styles = re.findall(r'<link[^>]* rel="stylesheet"[^>]* href="([^"]+)"', page.decode())
    assert scripts
    files = [(name, "text/javascript") for name in scripts] + [(name, "text/css") for name in styles]
    for name, expected in files:
        status, kind, content = served.get("/" + name.lstrip("./"))
        assert (status, kind) == (200, expected)
        assert content


def test_the_service_is_well(served: Served) -> None:
    assert served.json("/api/health")["status"] == "ok"
    assert all(served.json("/api/health/ready")["checks"].values())
    assert served.get("/docs/files/swagger-ui.css")[0] == 200


def test_the_built_in_trees_are_there(served: Served) -> None:
    served.wait_for("has_its_species")
    trees = served.json("/api/trees")["trees"]
    assert sorted(tree["name"] for tree in trees) == BUILTIN_NAMES
    assert all(tree["builtin"] for tree in trees)
