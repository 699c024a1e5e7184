"""A forest below a cell: ``pip install anywidget``, then ``show("poplar.table", "poplar.glb")``."""

from __future__ import annotations

from pathlib import Path

import anywidget
import traitlets

BUNDLE = Path(__file__).parents[2] / "dist/notebook/widget.js"


class ForestWidget(anywidget.AnyWidget):
    """Trees of one table that sway; ``wind`` may be changed while they do."""

    _esm = BUNDLE
    table = traitlets.Bytes().tag(sync=True)
    mesh = traitlets.Bytes().tag(sync=True)
    trees = traitlets.Int(5, min=1, max=500).tag(sync=True)
    wind = traitlets.Unicode("breeze").tag(sync=True)
    height_px = traitlets.Int(400, min=50, max=4000).tag(sync=True)


def show(table: str | Path, mesh: str | Path, *, trees: int = 5, wind: str = "breeze") -> ForestWidget:
    """Shows trees.

    Args:
        table: the table's file.
        mesh: the GLB that belongs to it.
        trees: their number, 1 to 500.
        wind: ``still``, ``breeze``, ``autumn-gusts``, ``storm-front`` or a wind document as JSON.

    Returns:
        The widget, which the notebook shows as the result of a cell.
    """
    return ForestWidget(table=Path(table).read_bytes(), mesh=Path(mesh).read_bytes(), trees=trees, wind=wind)
