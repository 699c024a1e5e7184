"""Trees that sway below a cell of a notebook. The widget is loaded when it is first used: it needs the extra
``notebook``.
"""

from typing import TYPE_CHECKING

from galewood.io.notebook.display import NotebookError, show
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.io.notebook.widget import ForestWidget

__getattr__ = lazily(__name__, {"ForestWidget": "galewood.io.notebook.widget"})
__all__ = ["ForestWidget", "NotebookError", "show"]
