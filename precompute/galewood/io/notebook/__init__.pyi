from .display import NotebookError as NotebookError
from .display import show as show
from .widget import ForestWidget as ForestWidget
