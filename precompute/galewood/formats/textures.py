"""Textures as the page can draw them: PNG, JPEG and WebP are kept, all other formats become PNG.

KTX2 (Basis Universal) is decoded by opengl_basisu, everything else by Pillow. Sizes are checked before that.
"""

from __future__ import annotations

import io
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from galewood.formats.bounded_image import IMAGE_ERRORS, open_image
from galewood.formats.companions import Source
from galewood.formats.limits import MAX_PIXELS
from galewood.formats.types import Material
from galewood.util import MeshError

KTX2_HEADER = b"\xabKTX 20\xbb\r\n\x1a\n"
KTX2_HEADER_BYTES = 80
MAX_SIDE = 4096  # larger textures are reduced: many graphics processors cannot take more
KEPT_FORMATS = {"PNG": "image/png", "JPEG": "image/jpeg", "WEBP": "image/webp"}
Encoded = tuple[bytes, str]  # content and MIME type


def drawable(content: bytes, name: str, source: Source) -> Encoded | None:
    """An image that browsers can draw, and its MIME type; None, with a warning, if it cannot be read.

    Raises MeshError for images of more than MAX_PIXELS.
    """
    try:
        if content.startswith(KTX2_HEADER):
            return _png(_reduced(_ktx2(content, name), name, source))
        image = open_image(content)
        _check_pixels(image.width, image.height, name)
        if image.format in KEPT_FORMATS and max(image.size) <= MAX_SIDE:
            return content, KEPT_FORMATS[image.format]
        return _png(_reduced(image, name, source))
    except Image.DecompressionBombError as error:
        raise _too_large(name) from error
    except (*IMAGE_ERRORS, ImportError) as error:
        source.warn(f"The texture {name!r} cannot be read ({_why(content, error)}); it is not drawn.")
        return None


def with_alpha(colour: bytes | None, mask: bytes, name: str, source: Source) -> Encoded | None:
    """A PNG with the colour of one image and, as its alpha, another image's alpha or brightness."""
    shown = drawable(mask, name, source)
    if shown is None:
        return None
    try:
        alpha = open_image(shown[0])
        alpha = alpha.getchannel("A") if "A" in alpha.getbands() else alpha.convert("L")
        base = Image.new("RGB", alpha.size, "white") if colour is None else open_image(colour)
        base = base.convert("RGB")
        base.putalpha(alpha.resize(base.size))
        return _png(base)
    except IMAGE_ERRORS as error:
        source.warn(f"The texture {name!r} cannot be read ({_why(mask, error)}); it is not drawn.")
        return None


def has_transparency(content: bytes) -> bool:
    """Whether an image has an alpha channel of which at least a hundredth is transparent."""
    try:
        image = open_image(content)
        if "A" not in image.getbands() and "transparency" not in image.info:
            return False
        alpha = np.asarray(image.convert("RGBA").getchannel("A").resize((128, 128)))
    except IMAGE_ERRORS:
        return False
    return float((alpha < 128).mean()) > 0.01


def cut_out_by_alpha(material: Material, key: str) -> None:
    """Cut a material out by its texture's transparent parts: formats other than glTF have no alpha mode."""
    if has_transparency(material.images[key][0]):
        material.json.update({"alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": True})


def _check_pixels(width: int, height: int, name: str) -> None:
    if width * height > MAX_PIXELS:
        raise _too_large(name)


def _too_large(name: str) -> MeshError:
    return MeshError(
        "image-too-large",
        "too-large",
        f"The texture {name!r} has more than {MAX_PIXELS // 1_000_000} million pixels.",
        f"Reduce textures to {MAX_SIDE} pixels or fewer on each side.",
    )


def _reduced(image: Image.Image, name: str, source: Source) -> Image.Image:
    if max(image.size) <= MAX_SIDE:
        return image
    before = f"{image.width} × {image.height}"
    image = image.convert("RGBA" if "A" in image.getbands() or "transparency" in image.info else "RGB")
    image.thumbnail((MAX_SIDE, MAX_SIDE))
    source.warn(f"The texture {name!r} was reduced from {before} to {image.width} × {image.height} pixels.")
    return image


def _png(image: Image.Image) -> Encoded:
    stream = io.BytesIO()
    mode = image.mode if image.mode in ("L", "LA", "RGB", "RGBA", "P") else "RGBA"
    image.convert(mode).save(stream, "PNG", compress_level=3)
    return stream.getvalue(), "image/png"


def _ktx2(content: bytes, name: str) -> Image.Image:
    """The largest image of a KTX2 file; header fields as in the KTX 2.0 specification, section 3."""
    if len(content) < KTX2_HEADER_BYTES:
        raise ValueError("truncated")
    width, height, depth, layers, faces, levels = struct.unpack_from("<6I", content, 20)
    _check_pixels(width, max(height, 1), name)
    if depth > 1 or layers > 1 or faces != 1 or levels > 32:
        raise ValueError("not a plain two-dimensional texture")
    blocks = ((width + 3) // 4) * ((max(height, 1) + 3) // 4)
    if len(content) >= KTX2_HEADER_BYTES + 24:
        (unpacked,) = struct.unpack_from("<Q", content, KTX2_HEADER_BYTES + 16)
        if unpacked > 16 * blocks:  # no format of KHR_texture_basisu has larger blocks
            raise ValueError("its declared size does not fit its dimensions")
    return Image.fromarray(_transcoded(content), "RGBA")


def _transcoded(content: bytes) -> NDArray[np.uint8]:
    import opengl_basisu  # not on all platforms

    texture: Any = opengl_basisu.open(content)
    return np.ascontiguousarray(texture.transcode("rgba8").data, dtype=np.uint8)


def _why(content: bytes, error: Exception) -> str:
    if isinstance(error, ImportError):
        return "KTX2 cannot be decoded on this computer"
    if content.startswith(KTX2_HEADER):
        return f"KTX2: {error}"[:120]
    return "damaged, or not an image"
