"""The materials of a render mesh as UsdPreviewSurface, with all pictures of its glTF materials."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from galewood.io.export.gltf_file import GltfFile, given
from galewood.io.export.gltf_names import image_of
from galewood.io.export.usd.library import usd_library

if TYPE_CHECKING:
    import pygltflib

    Slot = pygltflib.TextureInfo | pygltflib.NormalMaterialTexture | pygltflib.OcclusionTextureInfo


def add_materials(stage: Any, root: str, file: GltfFile, folder: Path) -> list[Any]:
    """A material for every mesh of the file; pictures are written to FOLDER as PNG or JPEG."""
    pictures, made = _Pictures(file, folder), dict[int, Any]()
    for mesh in file.gltf.meshes:
        index = given(mesh.primitives[0].material)
        if index not in made:
            made[index] = _Preview(stage, root, file.gltf.materials[index], pictures).material
    return [made[given(mesh.primitives[0].material)] for mesh in file.gltf.meshes]


class _Pictures:
    """The images of a file as files beside the stage, each written when it is first used."""

    def __init__(self, file: GltfFile, folder: Path) -> None:
        self._file, self._folder = file, folder
        self._written = dict[int, str]()

    def name(self, texture: Slot) -> str:
        """The file of a slot's picture; USD renderers need not read WebP, which becomes PNG."""
        image = image_of(self._file.gltf, texture)
        if image not in self._written:
            content, kind = self._file.image(image)
            if kind not in ("image/png", "image/jpeg"):
                from PIL import Image

                stream = io.BytesIO()
                Image.open(io.BytesIO(content)).save(stream, "PNG")
                content, kind = stream.getvalue(), "image/png"
            target = f"{self._file.gltf.images[image].name}.{'jpg' if kind == 'image/jpeg' else 'png'}"
            (self._folder / target).write_bytes(content)
            self._written[image] = target
        return self._written[image]


@dataclass(frozen=True)
class _Reading:
    """How a picture is read: a value is texel · scale + bias."""

    scale: tuple[float, ...]
    bias: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    colour_space: str = "raw"


class _Preview:
    """A UsdPreviewSurface with the values and the pictures of a glTF material."""

    def __init__(self, stage: Any, root: str, source: pygltflib.Material, pictures: _Pictures) -> None:
        self._stage, self._pictures, self._reader = stage, pictures, None
        pxr = usd_library()
        self._path = f"{root}/materials/{pxr.Tf.MakeValidIdentifier(source.name)}"
        self.material = pxr.UsdShade.Material.Define(stage, self._path)
        self._shader = pxr.UsdShade.Shader.Define(stage, f"{self._path}/surface")
        self._shader.CreateIdAttr("UsdPreviewSurface")
        self._add_colour(source)
        self._add_surface(source)
        token = pxr.Sdf.ValueTypeNames.Token
        self.material.CreateSurfaceOutput().ConnectToSource(self._shader.CreateOutput("surface", token))

    def _add_colour(self, source: pygltflib.Material) -> None:
        pxr, surface = usd_library(), source.pbrMetallicRoughness
        types = pxr.Sdf.ValueTypeNames
        colour = tuple(surface.baseColorFactor or (1.0, 1.0, 1.0, 1.0)) if surface else (1.0, 1.0, 1.0, 1.0)
        diffuse = self._shader.CreateInput("diffuseColor", types.Color3f)
        if surface is None or surface.baseColorTexture is None:
            diffuse.Set(pxr.Gf.Vec3f(*colour[:3]))
            return
        reading = _Reading(colour, colour_space="sRGB")
        texture = self._texture("base_color", surface.baseColorTexture, reading)
        diffuse.ConnectToSource(texture.CreateOutput("rgb", types.Float3))
        if source.alphaMode == "MASK":
            opacity = self._shader.CreateInput("opacity", types.Float)
            opacity.ConnectToSource(texture.CreateOutput("a", types.Float))
            cutoff = 0.5 if source.alphaCutoff is None else source.alphaCutoff
            self._shader.CreateInput("opacityThreshold", types.Float).Set(float(cutoff))

    def _add_surface(self, source: pygltflib.Material) -> None:
        """Roughness (green), metal (blue), occlusion (red) and normals, as glTF 2.0, section 3.9 has them."""
        pxr, surface = usd_library(), source.pbrMetallicRoughness
        types = pxr.Sdf.ValueTypeNames
        factors = (
            {"roughness": surface.roughnessFactor, "metallic": surface.metallicFactor} if surface else {}
        )
        for use, channel in (("roughness", "g"), ("metallic", "b")):
            given_factor = factors.get(use)
            factor = 1.0 if given_factor is None else float(given_factor)
            value = self._shader.CreateInput(use, types.Float)
            if surface is None or surface.metallicRoughnessTexture is None:
                value.Set(factor)
            else:
                texture = self._texture(use, surface.metallicRoughnessTexture, _Reading((factor,) * 4))
                value.ConnectToSource(texture.CreateOutput(channel, types.Float))
        if source.occlusionTexture is not None:
            strength = _or_one(source.occlusionTexture.strength)
            reading = _Reading((strength,) * 4, (1.0 - strength,) * 4)
            texture = self._texture("occlusion", source.occlusionTexture, reading)
            value = self._shader.CreateInput("occlusion", types.Float)
            value.ConnectToSource(texture.CreateOutput("r", types.Float))
        if source.normalTexture is not None:
            bend = _or_one(source.normalTexture.scale)
            reading = _Reading((2 * bend, 2 * bend, 2.0, 1.0), (-bend, -bend, -1.0, 0.0))
            texture = self._texture("normal", source.normalTexture, reading)
            value = self._shader.CreateInput("normal", types.Normal3f)
            value.ConnectToSource(texture.CreateOutput("rgb", types.Float3))

    def _texture(self, use: str, picture: Slot, reading: _Reading) -> Any:
        pxr = usd_library()
        types = pxr.Sdf.ValueTypeNames
        texture = pxr.UsdShade.Shader.Define(self._stage, f"{self._path}/{use}")
        texture.CreateIdAttr("UsdUVTexture")
        texture.CreateInput("file", types.Asset).Set(f"./{self._pictures.name(picture)}")
        texture.CreateInput("scale", types.Float4).Set(pxr.Gf.Vec4f(*reading.scale))
        texture.CreateInput("bias", types.Float4).Set(pxr.Gf.Vec4f(*reading.bias))
        texture.CreateInput("sourceColorSpace", types.Token).Set(reading.colour_space)
        for wrap in ("wrapS", "wrapT"):
            texture.CreateInput(wrap, types.Token).Set("repeat")
        texture.CreateInput("st", types.Float2).ConnectToSource(self._coordinates())
        return texture

    def _coordinates(self) -> Any:
        pxr = usd_library()
        if self._reader is None:
            self._reader = pxr.UsdShade.Shader.Define(self._stage, f"{self._path}/st")
            self._reader.CreateIdAttr("UsdPrimvarReader_float2")
            self._reader.CreateInput("varname", pxr.Sdf.ValueTypeNames.String).Set("st")
        return self._reader.CreateOutput("result", pxr.Sdf.ValueTypeNames.Float2)


def _or_one(value: float | None) -> float:
    return 1.0 if value is None else float(value)
