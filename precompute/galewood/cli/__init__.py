"""The `galewood` command line."""

from galewood.cli.commands import JsonOut, app
from galewood.cli.tools import console, progress_bar, progress_reporter, write_figures

__all__ = ["JsonOut", "app", "console", "progress_bar", "progress_reporter", "write_figures"]
