"""The `galewood` command line."""

from galewood.cli.commands import app
from galewood.cli.tools import JsonOut, console, progress_bar, progress_reporter, write_figures

__all__ = ["JsonOut", "app", "console", "progress_bar", "progress_reporter", "write_figures"]
