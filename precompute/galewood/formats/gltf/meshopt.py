"""Buffer views compressed with meshopt (EXT_meshopt_compression, KHR_meshopt_compression).

The package meshopt decodes them: a binding of meshoptimizer's own decoder.
"""

from __future__ import annotations

from typing import Any

from galewood.formats.gltf.material import natural
from galewood.formats.limits import Budget
from galewood.util import MeshError

Json = dict[str, Any]
NAMES = ("EXT_meshopt_compression", "KHR_meshopt_compression")
MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
FILTERS = ("NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR")


def compressed_view(view: Json) -> Json | None:
    """The extension of a compressed buffer view, or None."""
    extensions = view.get("extensions", {})
    return next((extensions[name] for name in NAMES if name in extensions), None)


def decode_view(packed: Json, content: bytes, budget: Budget) -> bytes:
    """The decoded bytes of a compressed buffer view; MeshError if they are damaged or declared too large."""
    count, stride = natural(packed["count"]), natural(packed["byteStride"])
    mode, scheme = packed["mode"], packed.get("filter", "NONE")
    if mode not in MODES or scheme not in FILTERS or not 1 <= stride <= 256:
        raise _damaged()
    budget.add_bytes(count * stride)
    import meshopt  # only compressed files need it

    try:
        return meshopt.decode_gltf_buffer(content, count, stride, mode, scheme).tobytes()
    except (ValueError, RuntimeError, OverflowError) as error:
        raise _damaged() from error


def _damaged() -> MeshError:
    return MeshError(
        "meshopt-damaged", "malformed", "Data compressed with meshopt cannot be decoded.",
        "The file is damaged; export it again.",
    )  # fmt: skip
