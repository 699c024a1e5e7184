"""Binary glTF 2.0 as Galewood writes it: one JSON chunk, one binary chunk."""

from __future__ import annotations

import json
import struct
from typing import Any

Json = dict[str, Any]
GLTF_FLOAT = 5126
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
WEBP_MIME, WEBP_EXTENSION = "image/webp", "EXT_texture_webp"


def packed_glb(document: Json, binary: bytes) -> bytes:
    """A document and its binary chunk as a file."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    body = binary + b"\0" * (-len(binary) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body))
    chunks = (struct.pack("<I4s", len(text), b"JSON"), text, struct.pack("<I4s", len(body), b"BIN\0"), body)
    return head + b"".join(chunks)


def glb_parts(glb: bytes) -> tuple[Json, bytes]:
    """Inverse of ``packed_glb``."""
    size = struct.unpack_from("<I", glb, 12)[0]
    return json.loads(glb[20 : 20 + size]), glb[20 + size + 8 :]
