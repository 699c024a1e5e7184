"""Names in an exported GLB: every one begins with the tree's, so that several trees fit into one project."""

from __future__ import annotations

from typing import TYPE_CHECKING

from galewood.io.export.options import file_name

if TYPE_CHECKING:
    import pygltflib

    Slot = pygltflib.TextureInfo | pygltflib.NormalMaterialTexture | pygltflib.OcclusionTextureInfo

PICTURES = {
    "baseColorTexture": "base_color",
    "metallicRoughnessTexture": "roughness",
    "normalTexture": "normal",
    "occlusionTexture": "occlusion",
    "emissiveTexture": "emissive",
}
"""What a picture is called, by the slot that first uses it."""
ROUGHNESS_SLOTS = ("baseColorTexture", "metallicRoughnessTexture")
"""Slots that glTF keeps in pbrMetallicRoughness."""
WEBP_EXTENSION = "EXT_texture_webp"


def give_names(gltf: pygltflib.GLTF2, name: str) -> None:
    """Name scene, nodes, meshes, materials and pictures after the tree: NAME_wood_0, NAME_wood_normal."""
    gltf.scenes[gltf.scene or 0].name = name
    for node in gltf.nodes:
        if node.mesh is not None:
            mesh = gltf.meshes[node.mesh]
            mesh.name = node.name = f"{name}_{node.name or mesh.name or f'part_{node.mesh}'}"
    taken = set[str]()
    for material in gltf.materials:
        material.name = _unique(f"{name}_{file_name(material.name or 'material')}", taken)
    taken.clear()
    for material in gltf.materials:
        for slot, use in PICTURES.items():
            holder = material.pbrMetallicRoughness if slot in ROUGHNESS_SLOTS else material
            texture = getattr(holder, slot, None)
            if texture is None:
                continue
            image = gltf.images[image_of(gltf, texture)]
            if image.name is None or not image.name.startswith(f"{name}_"):
                image.name = _unique(f"{material.name}_{use}", taken)


def image_of(gltf: pygltflib.GLTF2, texture: Slot) -> int:
    """The image that a slot of a material shows."""
    found = gltf.textures[int(texture.index or 0)]
    extension = (found.extensions or {}).get(WEBP_EXTENSION)
    return int(extension["source"] if extension else found.source or 0)


def _unique(name: str, taken: set[str]) -> str:
    found, count = name, 2
    while found in taken:
        found, count = f"{name}_{count}", count + 1
    taken.add(found)
    return found
