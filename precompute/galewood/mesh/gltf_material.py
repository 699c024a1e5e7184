"""glTF materials with their embedded textures."""

from __future__ import annotations

import copy
import io
from collections.abc import Callable
from typing import Any

import numpy as np
from PIL import Image

from galewood.mesh.types import Material

Json = dict[str, Any]
MAX_PIXELS = 64_000_000
SLOTS = (
    ("pbrMetallicRoughness", "baseColorTexture"),
    ("pbrMetallicRoughness", "metallicRoughnessTexture"),
    ("", "normalTexture"),
    ("", "occlusionTexture"),
    ("", "emissiveTexture"),
)
KEPT = (
    "name", "pbrMetallicRoughness", "normalTexture", "occlusionTexture", "emissiveTexture",
    "emissiveFactor", "alphaMode", "alphaCutoff", "doubleSided",
)  # fmt: skip


def read_material(
    document: Json, raw: Json, image_bytes: Callable[[Json], tuple[bytes, str] | None]
) -> Material:
    """A material whose texture infos contain image keys ("image 3") instead of texture indices."""
    material = copy.deepcopy({k: raw[k] for k in KEPT if k in raw})
    if "KHR_materials_unlit" in raw.get("extensions", {}):
        material["extensions"] = {"KHR_materials_unlit": {}}
    images: dict[str, tuple[bytes, str]] = {}
    samplers: dict[str, Json] = {}
    for group, slot in SLOTS:
        holder = material.get(group, {}) if group else material
        if slot in holder:
            _take_texture(document, holder, slot, image_bytes, images, samplers)
    return Material(material, images, samplers)


def _take_texture(
    document: Json,
    holder: Json,
    slot: str,
    image_bytes: Callable[[Json], tuple[bytes, str] | None],
    images: dict[str, tuple[bytes, str]],
    samplers: dict[str, Json],
) -> None:
    texture = document["textures"][holder[slot]["index"]]
    source = texture.get("source")
    content = None if source is None else image_bytes(document["images"][source])
    if content is None:  # external or in an unsupported container: rendered without it
        del holder[slot]
        return
    key = f"image {source}"
    images[key] = content
    samplers[key] = document["samplers"][texture["sampler"]] if "sampler" in texture else {}
    holder[slot]["index"] = key


def base_image(material: Material | None) -> Image.Image | None:
    """The decoded base colour image, or None if there is none or it cannot be decoded."""
    if material is None:
        return None
    info = material.json.get("pbrMetallicRoughness", {}).get("baseColorTexture")
    if info is None or info["index"] not in material.images:
        return None
    try:
        image = Image.open(io.BytesIO(material.images[info["index"]][0]))
        return None if image.width * image.height > MAX_PIXELS else image
    except (OSError, ValueError, Image.DecompressionBombError):
        return None


def alpha_coverage(material: Material | None) -> float:
    """Share of the base colour image that passes the alpha test; 1 without alpha."""
    image = base_image(material)
    if material is None or image is None or not _has_alpha(image):
        return 1.0
    cutoff = float(material.json.get("alphaCutoff", 0.5))
    try:
        alpha = np.asarray(image.convert("RGBA").resize((256, 256)))[:, :, 3]
    except (OSError, ValueError):
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
