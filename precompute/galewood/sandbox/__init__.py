"""Untrusted input is parsed in a sandboxed child process; in: arrays; out: arrays or a MeshError."""

from galewood.sandbox.confinement import unavailable_restrictions
from galewood.sandbox.limited_process import Arrays, Limits, run_limited
from galewood.sandbox.prepared import PreparedFunction
from galewood.sandbox.results import remove_folder

__all__ = ["Arrays", "Limits", "PreparedFunction", "remove_folder", "run_limited", "unavailable_restrictions"]
