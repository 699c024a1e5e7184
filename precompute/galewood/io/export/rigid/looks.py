"""How the primitives of a drawn mesh look: colour and picture, as robot simulators take them."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path

from galewood.io.export.gltf_file import GltfFile, given

MOST_TEXTURE_PX = 1024
WEBP_EXTENSION = "EXT_texture_webp"


@dataclass(frozen=True)
class Look:
    """Colour of a primitive, the name of its picture's file, and whether it is seen from both sides."""

    rgba: tuple[float, float, float, float]
    texture: str | None
    both_sides: bool


def write_look(file: GltfFile, index: int, folder: Path, name: str, *, transparent: bool) -> Look:
    """The look of a mesh of the file; its picture is written to the folder as PNG.

    ``transparent``: whether the picture keeps its transparency.
    """
    gltf = file.gltf
    material = gltf.materials[given(gltf.meshes[index].primitives[0].material)]
    surface = material.pbrMetallicRoughness
    red, green, blue, alpha = (surface and surface.baseColorFactor) or (1.0, 1.0, 1.0, 1.0)
    picture = surface.baseColorTexture if surface else None
    if picture is None:
        return Look((red, green, blue, alpha), None, bool(material.doubleSided))
    texture = gltf.textures[picture.index]
    extension = (texture.extensions or {}).get(WEBP_EXTENSION)
    image = int(extension["source"]) if extension else given(texture.source)
    target = f"{name}_texture_{image}.png"
    (folder / target).write_bytes(_png(file.image(image)[0], "RGBA" if transparent else "RGB"))
    return Look((red, green, blue, alpha), target, bool(material.doubleSided))


def _png(content: bytes, mode: str) -> bytes:
    from PIL import Image

    picture = Image.open(io.BytesIO(content)).convert(mode)
    picture.thumbnail((MOST_TEXTURE_PX, MOST_TEXTURE_PX))
    stream = io.BytesIO()
    picture.save(stream, "PNG")
    return stream.getvalue()
