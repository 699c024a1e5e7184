"""The `galewood` command line."""

from galewood.io.cli.commands import app
from galewood.io.cli.request_options import Mesh, validated, with_options_of
from galewood.io.cli.tools import (
    JsonOut,
    console,
    print_error,
    print_report,
    progress_bar,
    progress_reporter,
    write_figures,
)

__all__ = [
    "JsonOut",
    "Mesh",
    "app",
    "console",
    "print_error",
    "print_report",
    "progress_bar",
    "progress_reporter",
    "validated",
    "with_options_of",
    "write_figures",
]
