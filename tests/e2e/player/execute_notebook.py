"""Executes the example notebook with a kernel of its own: python -m tests.e2e.player.execute_notebook FOLDER

Writes FOLDER/forest.ipynb, with its outputs and the state of its widgets. Fails if a cell fails.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).parents[3] / "web/player/examples/notebook/forest.ipynb"
TIMEOUT_S = 600


def execute(folder: Path) -> None:
    """nbclient.exceptions.CellExecutionError if a cell fails."""
    # neither the user's profile nor the user's kernels
    for name in ("IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR"):
        os.environ[name] = str(folder / name.lower())
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    resources = {"metadata": {"path": str(folder)}}
    NotebookClient(notebook, timeout=TIMEOUT_S, startup_timeout=TIMEOUT_S, resources=resources).execute()
    nbformat.write(notebook, folder / "forest.ipynb")


if __name__ == "__main__":
    execute(Path(sys.argv[1]))
