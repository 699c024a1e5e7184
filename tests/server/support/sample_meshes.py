"""Small meshes for uploads: a pole that builds fast, and invalid files."""

from __future__ import annotations

import io
import struct
import zipfile

import numpy as np


def pole_obj(height_m: float = 4.0, radius_m: float = 0.12, rings: int = 12, sides: int = 8) -> bytes:
    """A closed, tapering pole standing on the ground, y up."""
    angle = 2 * np.pi * np.arange(sides) / sides
    lines: list[str] = []
    for k in range(rings):
        share = k / (rings - 1)
        radius = radius_m * (1 - 0.7 * share)
        lines += [
            f"v {radius * np.cos(a):.6f} {height_m * share:.6f} {radius * np.sin(a):.6f}" for a in angle
        ]
    for k in range(rings - 1):
        for i in range(sides):
            a, b = k * sides + i + 1, k * sides + (i + 1) % sides + 1
            lines.append(f"f {a} {a + sides} {b + sides} {b}")
    top = (rings - 1) * sides
    lines.append("f " + " ".join(str(i + 1) for i in range(sides)))
    lines.append("f " + " ".join(str(top + i + 1) for i in reversed(range(sides))))
    return ("\n".join(lines) + "\n").encode()


def truncated_glb() -> bytes:
    """A GLB header without the declared data."""
    return struct.pack("<4sII", b"glTF", 2, 5000) + struct.pack("<I4s", 4000, b"JSON") + b'{"asset":{'


def zip_file() -> bytes:
    """A ZIP archive without a model."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("notes.txt", "no tree")
    return buffer.getvalue()


def greedy_ply() -> bytes:
    """A header that declares four billion vertices."""
    return (
        b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n"
        b"property float x\nproperty float y\nproperty float z\nelement face 4000000000\n"
        b"property list uchar int vertex_indices\nend_header\n" + bytes(64)
    )


def nowhere_obj() -> bytes:
    """An OBJ with NaN coordinates."""
    return pole_obj().replace(b"v 0.120000", b"v nan", 1)
