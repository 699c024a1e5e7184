"""The notebook of the package ``galewood`` runs. Its front end is tested in tests/e2e/player.spec.ts."""

from __future__ import annotations

from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).parents[2] / "web/player/examples/notebook/forest.ipynb"
BUNDLE = Path(__file__).parents[2] / "web/player/dist/notebook/widget.js"


@pytest.mark.skipif(not BUNDLE.exists(), reason="the package is not built: make player")
def test_the_notebook_shows_a_widget() -> None:
    pytest.importorskip("anywidget")
    pytest.importorskip("ipykernel")
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    resources = {"metadata": {"path": str(NOTEBOOK.parent)}}
    nbclient.NotebookClient(notebook, timeout=120, resources=resources).execute()
    results = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert [result.output_type for result in results] == ["execute_result"]
    assert "application/vnd.jupyter.widget-view+json" in results[0].data
