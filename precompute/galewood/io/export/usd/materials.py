"""The materials of a render mesh as UsdPreviewSurface: base colour, its texture and its transparency."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from galewood.io.export.gltf_file import GltfFile, given
from galewood.io.export.usd.library import usd_library

SURFACE_ROUGHNESS = 0.9
WEBP_EXTENSION = "EXT_texture_webp"


def add_materials(stage: Any, root: str, file: GltfFile, folder: Path, name: str) -> list[Any]:
    """A material for every mesh of the file; textures are written to FOLDER as PNG or JPEG."""
    gltf, written = file.gltf, dict[int, str]()
    found = list[Any]()
    for index, mesh in enumerate(gltf.meshes):
        material = gltf.materials[given(mesh.primitives[0].material)]
        surface = material.pbrMetallicRoughness
        colour = list(surface.baseColorFactor or [1.0, 1.0, 1.0, 1.0]) if surface else [1.0, 1.0, 1.0, 1.0]
        texture = surface.baseColorTexture if surface else None
        picture = None
        if texture is not None:
            image = _image_of(gltf.textures[texture.index])
            picture = written.setdefault(image, _written(file, image, folder, name))
        cutoff = float(material.alphaCutoff or 0.5) if material.alphaMode == "MASK" else None
        found.append(_preview(stage, f"{root}/materials/material_{index}", colour, picture, cutoff))
    return found


def _image_of(texture: Any) -> int:
    extension = (texture.extensions or {}).get(WEBP_EXTENSION)
    return int(extension["source"] if extension else texture.source)


def _written(file: GltfFile, image: int, folder: Path, name: str) -> str:
    """Write an image beside the stage and return its name; USD renderers need not read WebP."""
    content, kind = file.image(image)
    if kind not in ("image/png", "image/jpeg"):
        from PIL import Image

        stream = io.BytesIO()
        Image.open(io.BytesIO(content)).save(stream, "PNG")
        content, kind = stream.getvalue(), "image/png"
    target = f"{name}_texture_{image}.{'jpg' if kind == 'image/jpeg' else 'png'}"
    (folder / target).write_bytes(content)
    return target


def _preview(stage: Any, path: str, colour: list[float], picture: str | None, cutoff: float | None) -> Any:
    pxr = usd_library()
    types = pxr.Sdf.ValueTypeNames
    material = pxr.UsdShade.Material.Define(stage, path)
    shader = pxr.UsdShade.Shader.Define(stage, f"{path}/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("roughness", types.Float).Set(SURFACE_ROUGHNESS)
    shader.CreateInput("metallic", types.Float).Set(0.0)
    diffuse = shader.CreateInput("diffuseColor", types.Color3f)
    if picture is None:
        diffuse.Set(pxr.Gf.Vec3f(*colour[:3]))
    else:
        reader = pxr.UsdShade.Shader.Define(stage, f"{path}/st")
        reader.CreateIdAttr("UsdPrimvarReader_float2")
        reader.CreateInput("varname", types.String).Set("st")
        texture = pxr.UsdShade.Shader.Define(stage, f"{path}/picture")
        texture.CreateIdAttr("UsdUVTexture")
        texture.CreateInput("file", types.Asset).Set(f"./{picture}")
        texture.CreateInput("scale", types.Float4).Set(pxr.Gf.Vec4f(*colour))
        for wrap in ("wrapS", "wrapT"):
            texture.CreateInput(wrap, types.Token).Set("repeat")
        coordinates = reader.CreateOutput("result", types.Float2)
        texture.CreateInput("st", types.Float2).ConnectToSource(coordinates)
        diffuse.ConnectToSource(texture.CreateOutput("rgb", types.Float3))
        if cutoff is not None:
            opacity = shader.CreateInput("opacity", types.Float)
            opacity.ConnectToSource(texture.CreateOutput("a", types.Float))
            shader.CreateInput("opacityThreshold", types.Float).Set(cutoff)
    material.CreateSurfaceOutput().ConnectToSource(shader.CreateOutput("surface", types.Token))
    return material
