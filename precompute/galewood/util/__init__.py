"""Utilities shared by all stages: array types, errors, atomic files, worker processes."""

from galewood.util.arrays import Array, Floats, Int32s, Int64s, Ints, Singles, joined_array
from galewood.util.atomic_file import write_arrays, write_atomically
from galewood.util.cancelled import Cancelled
from galewood.util.delimited import HEADER_WITHIN, Row, decoded, number_of, rows_of
from galewood.util.errors import MeshError, Reason
from galewood.util.glb import (
    ARRAY_BUFFER,
    ELEMENT_ARRAY_BUFFER,
    GLTF_FLOAT,
    WEBP_EXTENSION,
    WEBP_MIME,
    Json,
    glb_parts,
    packed_glb,
)
from galewood.util.guarded_process import FROZEN_S, AbortedError, GuardedProcess, Lifeline
from galewood.util.kernel_cache import compile_once, kernels_compiled
from galewood.util.process_usage import PeakMemory, cpu_seconds
from galewood.util.text import shown_message, shown_text
from galewood.util.worker_pool import WorkerPool, usable_cores

__all__ = [
    "ARRAY_BUFFER",
    "ELEMENT_ARRAY_BUFFER",
    "FROZEN_S",
    "GLTF_FLOAT",
    "HEADER_WITHIN",
    "WEBP_EXTENSION",
    "WEBP_MIME",
    "AbortedError",
    "Array",
    "Cancelled",
    "Floats",
    "GuardedProcess",
    "Int32s",
    "Int64s",
    "Ints",
    "Json",
    "Lifeline",
    "MeshError",
    "PeakMemory",
    "Reason",
    "Row",
    "Singles",
    "WorkerPool",
    "compile_once",
    "cpu_seconds",
    "decoded",
    "glb_parts",
    "joined_array",
    "kernels_compiled",
    "number_of",
    "packed_glb",
    "rows_of",
    "shown_message",
    "shown_text",
    "usable_cores",
    "write_arrays",
    "write_atomically",
]
