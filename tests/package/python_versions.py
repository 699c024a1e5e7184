"""`make test-python-versions`: the locked packages and a part of the tests, with other versions of Python.

For every version an environment is made in build/python, with the packages and hashes of requirements/*.txt.
A version without an interpreter is skipped, and said to be; the exit status is 1 if a test of another fails.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
VERSIONS = ("3.12", "3.13")
"""Beside 3.11, with which `make test` runs where it is installed."""
LOCK_FILES = ("base", "dev", "client")
TEST_GROUPS = (
    ["tests/docs/test_snippets.py", "-k", "readme_runs_as_a_file"],
    [f"tests/precompute/{part}" for part in ("formats", "io", "motion", "player", "table", "wood")],
    ["tests/server/api"],
)
"""The example of the README, a whole build; then what reads, plays, exports and serves."""


def interpreter(version: str) -> str | None:
    """A Python of a version: on the path, or installed by pyenv; None: there is none."""
    home = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    installed = sorted(home.glob(f"versions/{version}.*/bin/python"))
    for name in (f"python{version}", *map(str, installed)):
        found = shutil.which(name)
        # pyenv puts a script on the path that fails for versions that are not chosen
        if found and subprocess.run([found, "--version"], capture_output=True).returncode == 0:
            return found
    return None


def prepared(version: str, python: str) -> Path:
    """The interpreter of an environment with the locked packages and this project. CalledProcessError."""
    folder = ROOT / "build" / "python" / version
    own = folder / "bin" / "python"
    if not own.exists():
        subprocess.run([python, "-m", "venv", str(folder)], check=True)
    pip = [str(own), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"]
    for lock in LOCK_FILES:
        subprocess.run([*pip, "--require-hashes", "-r", f"requirements/{lock}.txt"], cwd=ROOT, check=True)
    subprocess.run([*pip, "--no-build-isolation", "-e", "."], cwd=ROOT, check=True)
    return own


def main() -> int:
    """Test every version that is there; return 1 if one fails."""
    failed, tested = list[str](), list[str]()
    for version in sys.argv[1:] or VERSIONS:
        python = interpreter(version)
        if python is None:
            print(f"Python {version}: skipped, as there is no python{version}, nor one of pyenv", flush=True)
            continue
        print(f"Python {version}: {python}", flush=True)
        tested.append(version)
        own = prepared(version, python)
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(own.parents[1] / "numba")}
        for tests in TEST_GROUPS:
            call = [str(own), "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not release", *tests]
            if subprocess.run(call, cwd=ROOT, env=environment).returncode:
                failed.append(version)
    print(f"tested: {', '.join(tested) or 'none'}; failed: {', '.join(dict.fromkeys(failed)) or 'none'}")
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
