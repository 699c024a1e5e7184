"""The Python code of the README and of docs/ runs as a new user would run it, in a folder with a mesh."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

from tests.precompute.fixtures.shared_tets import TARGET_TETS, cache_with_tets, small_tree_glb

ROOT = Path(__file__).parents[2]
HEIGHT_M = 12.0
"""As in the README and the tutorial, so that their tree is meshed already."""
QUICK = {
    "galewood.build(tree": f"{TARGET_TETS=}, sampled_elements=8, frames=16, design_speed_m_s=14.0",
    "galewood.Model(tree": f"{TARGET_TETS=}",
}
"""Options as in tests/precompute/io/test_api.py, so that the runs are simulated once for both."""
TIMEOUT_S = 1700
"""Of one program: a build with the default options takes two minutes of processor time."""
pytestmark = pytest.mark.timeout(1800)


def python_blocks(page: str) -> list[str]:
    """The code of a page's Python blocks."""
    text = ROOT.joinpath(page).read_text(encoding="utf-8")
    return re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def quick(code: str) -> str:
    """The same code with options for a quick build."""
    for call, options in QUICK.items():
        code = code.replace(call, f"{call}, {options.lower()}")
    return code


EXAMPLE = "\n".join(python_blocks("README.md"))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """What a new user has: a mesh, and an empty cache."""
    tmp_path.joinpath("mytree.glb").write_bytes(small_tree_glb())
    monkeypatch.setenv("GALEWOOD_CACHE_DIR", str(tmp_path / "cache"))
    # neither the user's profile nor the user's kernels
    for name in ("IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR"):
        monkeypatch.setenv(name, str(tmp_path / name.lower()))
    return tmp_path


@pytest.fixture
def meshed(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same folder with a cache that has the tree's tetrahedra and runs."""
    cache_with_tets(folder / "cache", tmp_path_factory, HEIGHT_M, share_runs=True)
    return folder


def run(folder: Path, *arguments: str, stdin: str = "") -> str:
    """What a Python program prints. It may not print a traceback, even if it exits with 0."""
    command = [sys.executable, *arguments]
    # the variables of this process hold other numbers of threads than a user's
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    ran = subprocess.run(
        command, cwd=folder, env=environment, input=stdin, capture_output=True, text=True, timeout=TIMEOUT_S
    )
    assert ran.returncode == 0 and "Traceback" not in ran.stderr, ran.stderr
    return ran.stdout


def run_file(folder: Path, code: str) -> str:
    folder.joinpath("program.py").write_text(code, encoding="utf-8")
    return run(folder, "program.py")


def run_command(folder: Path, code: str) -> None:
    run(folder, "-c", code)


def run_at_the_prompt(folder: Path, code: str) -> None:
    run(folder, "-i", "-q", stdin=code)


def run_in_a_thread(folder: Path, code: str) -> None:
    start = "import threading\nthread = threading.Thread(target=work)\nthread.start()\nthread.join()\n"
    run_file(folder, f"def work():\n{textwrap.indent(code, '    ')}\n{start}")


def run_notebook(folder: Path, *cells: str) -> None:
    """nbclient.exceptions.CellExecutionError if a cell fails."""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    resources = {"metadata": {"path": str(folder)}}
    NotebookClient(notebook, timeout=TIMEOUT_S, startup_timeout=TIMEOUT_S, resources=resources).execute()


def test_the_example_of_the_readme_runs_as_a_file(folder: Path) -> None:
    """With nothing changed, and an empty cache."""
    run_file(folder, EXAMPLE)
    assert folder.joinpath("mytree.gwt").stat().st_size > 0


AT_RELEASES = [
    pytest.param(form, marks=pytest.mark.release)
    for form in (run_command, run_at_the_prompt, run_in_a_thread)
]


@pytest.mark.parametrize("form", [run_notebook, *AT_RELEASES])
def test_the_example_of_the_readme_runs_elsewhere(form: Callable[[Path, str], None], meshed: Path) -> None:
    """Worker processes are started however the program was: they do not import it."""
    form(meshed, quick(EXAMPLE))
    assert meshed.joinpath("mytree.gwt").stat().st_size > 0


def test_the_code_of_the_tutorial_runs_as_a_file(meshed: Path) -> None:
    blocks = python_blocks("docs/tutorial.md")
    assert len(blocks) >= 6
    printed = run_file(meshed, quick("\n".join(blocks)))
    assert re.search(r"^\(\d+, 3\)$", printed, re.MULTILINE)  # the shape of the vertices
    assert "100% " in printed and "largest vertex error: " in printed


def test_the_code_of_the_notebook_page_runs_in_a_notebook(folder: Path) -> None:
    run_notebook(folder, *python_blocks("docs/how-to/notebook.md"))


def test_the_code_of_the_measured_wind_runs_as_a_file(folder: Path) -> None:
    rows = [f"{second},{8 + second % 5},{200 + second % 7}" for second in range(120)]
    folder.joinpath("mast.csv").write_text("\n".join(["time_s,speed_m_s,direction_deg", *rows]))
    printed = run_file(folder, "\n".join(python_blocks("docs/how-to/wind-measurements.md")))
    assert printed.startswith(("9.", "10."))


def test_the_code_of_the_wind_risk_page_runs_as_a_file(folder: Path) -> None:
    page = "docs/how-to/wind-risk.md"
    grow = re.findall(
        r"^python docs/examples/(synthetic_scan.py) (.*)$", (ROOT / page).read_text(), re.MULTILINE
    )
    ((script, options),) = grow
    run(folder, str(ROOT / "docs" / "examples" / script), *options.split())
    steady, gusts = run_file(folder, "\n".join(python_blocks(page))).splitlines()
    breast_height, stem, boughs = (float(text) for text in re.findall(r"(?:^|strain=)([0-9.e-]+)", steady))
    assert 0 < breast_height < stem < boughs < 0.01
    factor, stem_in_gusts, boughs_in_gusts = (
        float(text) for text in re.findall(r"(?:^|strain=)([0-9.e-]+)", gusts)
    )
    assert 2 < factor < 6 and stem < stem_in_gusts < boughs_in_gusts < 0.02


def test_the_code_of_the_motion_page_runs_as_a_file(folder: Path) -> None:
    printed = run_file(folder, "\n".join(python_blocks("docs/how-to/motion-records.md")))
    found = re.fullmatch(r"([0-9.]+) Hz, damping ratio ([0-9.]+)\n", printed)
    assert found is not None
    # the impulse response in the code: angular frequency 1.6, decay 0.1 per second
    assert float(found.group(1)) == pytest.approx(1.6 / (2 * np.pi), rel=0.02)
    assert float(found.group(2)) == pytest.approx(0.1 / 1.6, rel=0.2)
