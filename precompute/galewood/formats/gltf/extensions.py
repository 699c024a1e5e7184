"""Which glTF extensions are supported; all others are reported, or refused if the file requires them."""

from __future__ import annotations

from typing import Any

from galewood.formats.companions import Source
from galewood.util import MeshError

Json = dict[str, Any]
SUPPORTED_EXTENSIONS = {
    "KHR_mesh_quantization",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "KHR_materials_unlit",
    "KHR_materials_pbrSpecularGlossiness",
}
# they change how a surface shines, or name things that are no part of a tree
HARMLESS_EXTENSIONS = (
    "KHR_materials_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_xmp",
    "KHR_animation_",
    "KHR_audio",
    "KHR_node_",
)


def check_required(document: Json) -> None:
    """MeshError if the file requires an extension without which it would be drawn wrong."""
    required = [str(name) for name in document.get("extensionsRequired", [])]
    unknown = [n for n in required if n not in SUPPORTED_EXTENSIONS and not n.startswith(HARMLESS_EXTENSIONS)]
    if any("texture" not in name for name in unknown):
        raise MeshError(
            "gltf-extension",
            "unsuitable",
            f"The glTF requires unsupported extensions: {', '.join(unknown)[:200]}.",
            "Export the file without them.",
        )


def warn_of_unused(document: Json, source: Source) -> None:
    """Report extensions and animations that have no effect here."""
    used = {str(name) for key in ("extensionsUsed", "extensionsRequired") for name in document.get(key, [])}
    unused = sorted(used - SUPPORTED_EXTENSIONS)
    if unused:
        listed = ", ".join(unused[:8]) + (", …" if len(unused) > 8 else "")
        source.warn(f"These extensions of the file are not drawn: {listed}.")
    if document.get("animations"):
        count = len(document["animations"])
        which = "The file's animation is" if count == 1 else f"The file's {count} animations are"
        source.warn(f"{which} not used; the tree is read as it stands at rest.")
