"""glTF materials with their embedded textures."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
from PIL import Image

from galewood.formats.bounded_image import IMAGE_ERRORS, open_image
from galewood.formats.limits import MAX_PIXELS
from galewood.formats.types import Material

Json = dict[str, Any]
TextureReader = Callable[[int], tuple[bytes, str] | None]
"""The content and MIME type of the image of an index; None, after a warning, if it cannot be read."""
TEXTURE_EXTENSIONS = ("EXT_texture_webp", "KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds")
SLOTS = (
    ("pbrMetallicRoughness", "baseColorTexture"),
    ("pbrMetallicRoughness", "metallicRoughnessTexture"),
    ("", "normalTexture"),
    ("", "occlusionTexture"),
    ("", "emissiveTexture"),
)
KEPT_PROPERTIES = (
    "name", "pbrMetallicRoughness", "normalTexture", "occlusionTexture", "emissiveTexture",
    "emissiveFactor", "alphaMode", "alphaCutoff", "doubleSided",
)  # fmt: skip


def read_material(document: Json, raw: Json, images: TextureReader) -> Material:
    """A material whose texture infos contain image keys ("image 3") instead of texture indices."""
    material = copy.deepcopy({k: raw[k] for k in KEPT_PROPERTIES if k in raw})
    extensions = raw.get("extensions", {})
    if "KHR_materials_unlit" in extensions:
        material["extensions"] = {"KHR_materials_unlit": {}}
    _take_diffuse(material, extensions.get("KHR_materials_pbrSpecularGlossiness"))
    found = Material(material, {}, {})
    for group, slot in SLOTS:
        holder = material.get(group, {}) if group else material
        if slot in holder:
            _take_texture(document, holder, slot, images, found)
    return found


def _take_diffuse(material: Json, glossy: Json | None) -> None:
    """Use the diffuse colour of KHR_materials_pbrSpecularGlossiness, an older model, as the base colour."""
    if glossy is None:
        return
    pbr = material.setdefault("pbrMetallicRoughness", {})
    pbr["baseColorFactor"] = glossy.get("diffuseFactor", [1, 1, 1, 1])
    pbr |= {"metallicFactor": 0.0, "roughnessFactor": 1.0 - 0.5 * float(glossy.get("glossinessFactor", 1.0))}
    if "diffuseTexture" in glossy:
        pbr["baseColorTexture"] = copy.deepcopy(glossy["diffuseTexture"])


def _take_texture(document: Json, holder: Json, slot: str, images: TextureReader, found: Material) -> None:
    texture = document["textures"][natural(holder[slot]["index"])]
    source, content = _first_readable(texture, images)
    if content is None:
        del holder[slot]
        return
    key = f"image {source}"
    found.images[key] = content
    found.samplers[key] = document["samplers"][texture["sampler"]] if "sampler" in texture else {}
    holder[slot]["index"] = key


def _first_readable(texture: Json, images: TextureReader) -> tuple[int | None, tuple[bytes, str] | None]:
    """The image of the first source that can be read: WebP, KTX2 or AVIF, then the plain one."""
    extensions = texture.get("extensions", {})
    sources = [extensions[name].get("source") for name in TEXTURE_EXTENSIONS if name in extensions]
    for source in [*sources, texture.get("source")]:
        content = None if source is None else images(natural(source))
        if content is not None:
            return source, content
    return None, None


def natural(value: Any) -> int:
    """The index, if it is a non-negative integer, else IndexError: Python would accept negative ones."""
    if not isinstance(value, int) or value < 0:
        raise IndexError(f"index {value!r}")
    return value


def base_image(material: Material | None) -> Image.Image | None:
    """The decoded base colour image, or None if there is none or it cannot be decoded."""
    if material is None:
        return None
    info = material.json.get("pbrMetallicRoughness", {}).get("baseColorTexture")
    if info is None or info["index"] not in material.images:
        return None
    try:
        image = open_image(material.images[info["index"]][0])
        return None if image.width * image.height > MAX_PIXELS else image
    except IMAGE_ERRORS:
        return None


def alpha_coverage(material: Material | None) -> float:
    """Share of the base colour image that passes the alpha test; 1 without alpha."""
    image = base_image(material)
    if material is None or image is None or not _has_alpha(image):
        return 1.0
    cutoff = float(material.json.get("alphaCutoff", 0.5))
    try:
        alpha = np.asarray(image.convert("RGBA").resize((256, 256)))[:, :, 3]
    except IMAGE_ERRORS:
        return 1.0
    return float((alpha >= cutoff * 255).mean())


def _has_alpha(image: Image.Image) -> bool:
    return image.mode in ("RGBA", "LA", "PA") or "transparency" in image.info


def pack_material(material: Material | None) -> tuple[Json | None, dict[str, bytes]]:
    """Serialise a material to JSON and the bytes of its images."""
    if material is None:
        return None, {}
    mimes = {key: mime for key, (_, mime) in material.images.items()}
    head = {"json": material.json, "samplers": material.samplers, "mimes": mimes}
    return head, {key: content for key, (content, _) in material.images.items()}


def unpack_material(head: Json | None, images: dict[str, bytes]) -> Material | None:
    """Inverse of pack_material."""
    if head is None:
        return None
    return Material(head["json"], {k: (images[k], m) for k, m in head["mimes"].items()}, head["samplers"])
