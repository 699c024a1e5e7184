"""``galewood.show``: trees in a notebook, from whatever stands for a tree in the Python API."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from galewood.io.api import MotionTable, Tree
from galewood.io.notebook.trees import shown_table
from galewood.motion.wind import Wind
from galewood.packaged import data_folder

if TYPE_CHECKING:
    from galewood.io.notebook.widget import ForestWidget

FRONT_END = "widget.js"


class NotebookError(RuntimeError):
    """Something that ``show`` needs is not installed or not built; the message says how to get it."""


def show(
    tree: str | Path | MotionTable | Tree,
    *,
    mesh: str | Path | None = None,
    trees: int = 5,
    wind: str | Wind | Mapping[str, Any] = "breeze",
    height_px: int = 400,
) -> ForestWidget:
    """Show trees that sway, as the result of a notebook cell (JupyterLab, Jupyter Notebook, VS Code).

    ``widget.wind`` changes the wind while they sway, and follows the controls below the picture.

    Args:
        tree: A built-in tree ("poplar", "maple", "oak", "spruce", …, each also as "maple-forest", grown in a
            closed forest), the path of a table, a table (``galewood.build``, ``galewood.load``), or a tree
            (``galewood.read``), whose motion is then estimated from beams along its branches.
        mesh: The GLB that belongs to the table at a path; by default the one beside it.
        trees: Number of trees, 1 to 500.
        wind: A preset ("still", "breeze", "autumn-gusts", "storm-front"), a ``galewood.Wind``, or a wind
            document, also as JSON.
        height_px: Height of the picture, px.

    Raises:
        NotebookError: anywidget is not installed, or the front end is not built (in a checkout).
        TableError: The file is not a table, or one of a version that is not read (a ValueError).
        ValueError: The table has no mesh, or the wood of the tree no branches.
        OSError: A file cannot be opened; FileNotFoundError lists the built-in trees.
        traitlets.TraitError: Number of trees, height or wind are out of range.
    """
    _check_installed()
    table = shown_table(tree, mesh)
    from galewood.io.notebook.widget import ForestWidget

    return ForestWidget(
        _front_end(),
        table=table.data,
        mesh=table.render_glb,
        trees=trees,
        wind=wind,
        height_px=height_px,
    )


def _check_installed() -> None:
    try:
        import_module("anywidget")
    except ImportError:
        raise NotebookError(
            "galewood.show needs the package anywidget: pip install 'galewood[notebook]'"
        ) from None


def _front_end() -> str:
    """The source of the front end: a JavaScript module in one piece."""
    path = data_folder("notebook", "web/player/dist/notebook") / FRONT_END
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise NotebookError(f"the front end is not built ({path} is missing): make player") from None
