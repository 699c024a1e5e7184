"""Data textures: OpenEXR with half or single floats, and PNG with 16 bits per channel."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.io.export.options import TextureFormat
from galewood.util import Floats

MAX_WIDTH_PX = 4096
"""Widest texture: every graphics card of the last fifteen years takes it."""
MAX_HEIGHT_PX = 16384
_CHANNELS = {3: "RGB", 4: "RGBA"}
_PNG_COLOUR = {3: 2, 4: 6}


@dataclass(frozen=True)
class Written:
    """A texture as it was written, and how its texels become values: value = low + texel (high − low)."""

    file: str
    low: list[float]
    high: list[float]

    def about(self) -> dict[str, Any]:
        """For the JSON document."""
        return {"file": self.file, "low": self.low, "high": self.high}


def write_texture(
    folder: Path, name: str, rows: Floats, kind: TextureFormat, *, single: bool = False
) -> Written:
    """Write values (height, width, 3 or 4): as they are (EXR), or scaled to their range (PNG, 16 bits).

    Args:
        folder: Where to write.
        name: File name without its ending.
        rows: The values; row 0 is the top of the picture.
        kind: The format.
        single: EXR only: 32 bits instead of 16.
    """
    file = f"{name}.{kind}"
    channels = rows.shape[2]
    if kind == "exr":
        write_exr(folder / file, rows.astype(np.float32 if single else np.float16))
        return Written(file, [0.0] * channels, [1.0] * channels)
    low, high = rows.min(axis=(0, 1)), rows.max(axis=(0, 1))
    span = np.where(high > low, high - low, 1.0)
    write_png16(folder / file, np.rint((rows - low) / span * 65535).astype(np.uint16))
    return Written(file, low.tolist(), (low + span).tolist())


def read_texture(folder: Path, about: Written) -> Floats:
    """(height, width, k) values of a texture, decoded as a shader does."""
    path = folder / about.file
    texels = read_exr(path) if path.suffix == ".exr" else read_png16(path) / 65535
    low, high = np.array(about.low), np.array(about.high)
    return low + texels.astype(np.float64) * (high - low)


def write_exr(path: Path, pixels: npt.NDArray[np.floating[Any]]) -> None:
    """Write (height, width, 3 or 4) float16 or float32 pixels as a zip-compressed scan-line EXR."""
    exr = _openexr()
    header = {"compression": exr.ZIP_COMPRESSION, "type": exr.scanlineimage}
    channels = {_CHANNELS[pixels.shape[2]]: np.ascontiguousarray(pixels)}
    with exr.File(header, channels) as file:
        file.write(str(path))


def read_exr(path: Path) -> Floats:
    """(height, width, k) pixels of an EXR with RGB or RGBA channels."""
    with _openexr().File(str(path)) as file:
        return next(iter(file.channels().values())).pixels.astype(np.float64)


def _openexr() -> Any:
    import OpenEXR  # untyped; takes a moment to load

    return OpenEXR


def write_png16(path: Path, pixels: npt.NDArray[np.uint16]) -> None:
    """Write (height, width, 3 or 4) pixels as PNG (W3C PNG Specification): no filter, no colour profile."""
    _write_png(path, pixels, 16)


def write_png8(path: Path, pixels: npt.NDArray[np.uint8]) -> None:
    """The same with 8 bits per channel."""
    _write_png(path, pixels, 8)


def _write_png(path: Path, pixels: npt.NDArray[Any], depth: int) -> None:
    height, width, channels = pixels.shape
    raw = np.ascontiguousarray(pixels, f">u{depth // 8}").reshape(height, -1).view(np.uint8)
    lines = np.concatenate([np.zeros((height, 1), np.uint8), raw], axis=1)
    head = struct.pack(">IIBBBBB", width, height, depth, _PNG_COLOUR[channels], 0, 0, 0)
    parts = (b"IHDR", head), (b"IDAT", zlib.compress(lines.tobytes(), 6)), (b"IEND", b"")
    chunks = (
        struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))
        for name, content in parts
    )
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(chunks))


def read_png16(path: Path) -> Floats:
    """(height, width, k) pixels of a PNG of ``write_png16``."""
    data = path.read_bytes()
    width, height, _, colour = struct.unpack(">IIBB", data[16:26])
    size = struct.unpack(">I", data[33:37])[0]
    lines = np.frombuffer(zlib.decompress(data[41 : 41 + size]), np.uint8).reshape(height, -1)[:, 1:]
    channels = next(count for count, code in _PNG_COLOUR.items() if code == colour)
    return np.ascontiguousarray(lines).view(">u2").reshape(height, width, channels).astype(np.float64)
