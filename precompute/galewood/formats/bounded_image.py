"""Opens images of untrusted files so that the cost is bounded by their length.

Pillow reads headers, chunks and markers in Python, one after another, and a file can have millions of them.
"""

from __future__ import annotations

import io
import struct
import zlib

from PIL import Image

# what models use; others, such as EPS, start programs or have frames and layers without end
FORMATS = ("PNG", "JPEG", "WEBP", "AVIF", "TGA", "BMP", "DIB", "TIFF", "DDS", "GIF")
SPARE_READS = 10_000
BYTES_PER_READ = 256  # an image that is not made of tiny chunks needs fewer reads
TIMES_READ = 4
SPARE_BYTES = 1 << 20
READ_BY_PIXEL = ("DDS", "BMP")  # Pillow decodes some of these in Python, a pixel or a run at a time
MOST_SLOW_PIXELS = 1024 * 1024
IMAGE_ERRORS = (
    OSError, ValueError, SyntaxError, EOFError, IndexError, KeyError, TypeError, OverflowError, struct.error,
    zlib.error, Image.DecompressionBombError,
)  # fmt: skip
"""What Pillow's readers raise for damaged images."""


def open_image(content: bytes) -> Image.Image:
    """An image whose pixels are not decoded yet.

    Raises IMAGE_ERRORS, also when it is decoded, if it is none or would cost too much.
    """
    file = _BoundedFile(content)
    image = Image.open(file, formats=FORMATS)
    if image.format in READ_BY_PIXEL:
        file.reads_left += min(image.width * image.height, MOST_SLOW_PIXELS)
    return image


class _BoundedFile(io.BytesIO):
    """Bytes that can be read about as often as their length justifies."""

    def __init__(self, content: bytes) -> None:
        super().__init__(content)
        self.reads_left = SPARE_READS + len(content) // BYTES_PER_READ
        self._bytes_left = SPARE_BYTES + TIMES_READ * len(content)

    def read(self, size: int | None = -1, /) -> bytes:
        """As in BytesIO. OSError once too much was read."""
        found = super().read(size)
        self.reads_left -= 1
        self._bytes_left -= len(found)
        if self.reads_left < 0 or self._bytes_left < 0:
            raise OSError("the image has too many chunks")
        return found
