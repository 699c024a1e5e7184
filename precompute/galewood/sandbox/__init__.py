"""Untrusted input is parsed in a sandboxed child process; in: arrays; out: arrays or a MeshError."""

from galewood.sandbox.arrays import Arrays, from_json_array, to_bytes_array, to_json_array
from galewood.sandbox.confinement import unavailable_restrictions
from galewood.sandbox.limited_process import Limits, run_limited
from galewood.sandbox.prepared import PreparedFunction
from galewood.sandbox.results import remove_folder

__all__ = [
    "Arrays",
    "Limits",
    "PreparedFunction",
    "from_json_array",
    "remove_folder",
    "run_limited",
    "to_bytes_array",
    "to_json_array",
    "unavailable_restrictions",
]
