"""Light copies of the shipped render meshes: what a browser downloads in place of them.

A light mesh has the vertices of its render mesh in the same order, so the same table moves it. Positions and
texture coordinates are rounded, normals are octahedral, and all are compressed with meshopt. Both forms of a
species share pictures, which are WebP files beside the mesh. The extras of the material ``leaves`` name a
further one as ``sprays``: eight sprays of the species, which a browser may draw near the eye in place of leaf
cards, and below them single leaves; ``drawn_sprays`` says where in a spray which leaf is. The cards of some
species show fuller shoots than those of the render mesh, which have the area of the tree's leaves.
The folder ``light`` holds

- ``name.glb`` for each tree, which refers to ``pictures/…`` relative to itself;
- ``pictures/species-what.hash.webp``, each named by its content;
- ``index.json``: SHA-256 of a render mesh -> the file of its light copy.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from PIL import Image

from galewood.pipeline.results.light_buffers import CompressedBuffers
from galewood.util import WEBP_EXTENSION, WEBP_MIME, Json, glb_parts, packed_glb, write_atomically

LIGHT_FOLDER, PICTURES_FOLDER, INDEX_FILE = "light", "pictures", "index.json"
PICTURE_NAMES = {("wood", "baseColorTexture"): "bark", ("wood", "normalTexture"): "bark-normal"}
"""Material and slot -> name of a picture; others are named by their material."""
LEAVES_NAME, SPRAYS_NAME, SHOOTS_NAME = "leaves", "sprays", "shoots"
DRAWN_SPRAYS_NAME = "drawn_sprays"
COLOUR_QUALITY, SPRAYS_QUALITY, NORMAL_QUALITY = 82, 70, 84


class SharedPictures(Protocol):
    """Where the pictures of a light mesh are."""

    @property
    def leaf_extras(self) -> Json:
        """The extras of the material of the leaves: the address of the picture of the sprays, relative to a
        light mesh, and what it shows; empty: there is none."""
        ...

    def uri(self, material: str, slot: str, content: bytes) -> str:
        """The address of a picture, relative to a light mesh."""
        ...


class PicturesOfLight:
    """The pictures of a light mesh, for another tree that has the same ones."""

    def __init__(self, glb: bytes) -> None:
        document, _ = glb_parts(glb)
        self._uris: dict[tuple[str, str], str] = {}
        self._extras: Json = {}
        for material in document["materials"]:
            if material.get("name") == LEAVES_NAME:
                self._extras = material.get("extras", {})
            for slot, index in _texture_slots(material):
                image = document["textures"][index]["extensions"][WEBP_EXTENSION]["source"]
                self._uris[material["name"], slot] = document["images"][image]["uri"]

    @property
    def leaf_extras(self) -> Json:
        """Those of the light mesh."""
        return self._extras

    def uri(self, material: str, slot: str, content: bytes) -> str:
        """The address of a picture. KeyError if the light mesh has none for this material and slot."""
        return self._uris[material, slot]


@dataclass
class Pictures:
    """The pictures of one species as WebP; those of its first form serve the other one too."""

    species: str
    files: dict[str, bytes] = field(default_factory=dict[str, bytes])
    """File name -> content."""
    _names: dict[str, str] = field(default_factory=dict[str, str])
    sprays: bytes | None = None
    """The picture of the sprays, as PNG."""
    drawn_sprays: Json | None = None
    """What it shows; None: needles."""
    shoots: bytes | None = None
    """The picture that browsers draw on the leaf cards, as PNG; None: that of the render mesh."""

    @property
    def sprays_uri(self) -> str | None:
        """The address of the picture of the sprays, which is packed when it is first asked for."""
        return None if self.sprays is None else self.uri(SPRAYS_NAME, "baseColorTexture", self.sprays)

    @property
    def leaf_extras(self) -> Json:
        """The picture of the sprays and what it shows."""
        extras = {SPRAYS_NAME: self.sprays_uri, DRAWN_SPRAYS_NAME: self.drawn_sprays}
        return {name: value for name, value in extras.items() if value is not None}

    def uri(self, material: str, slot: str, content: bytes) -> str:
        """The address of a picture, relative to a light mesh."""
        name = PICTURE_NAMES.get((material, slot), material)
        if name == LEAVES_NAME and self.shoots is not None:
            content = self.shoots
        if name not in self._names:
            colour = SPRAYS_QUALITY if name == SPRAYS_NAME else COLOUR_QUALITY
            packed = _webp(content, NORMAL_QUALITY if slot == "normalTexture" else colour)
            file = f"{self.species}-{name}.{hashlib.sha256(packed).hexdigest()[:12]}.webp"
            self.files[file], self._names[name] = packed, file
        return f"{PICTURES_FOLDER}/{self._names[name]}"


def light_glb(render_glb: bytes, pictures: SharedPictures) -> bytes:
    """The light copy of a render mesh, whose pictures are those of ``pictures``, or added to them."""
    document, body = glb_parts(render_glb)
    buffers = CompressedBuffers(document, body)
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            for name, accessor in primitive["attributes"].items():
                buffers.attribute(name, accessor)
            buffers.indices(primitive["indices"])
    images = _images(document, body, pictures)
    for material in document["materials"]:
        if material.get("name") == LEAVES_NAME and pictures.leaf_extras:
            material["extras"] = pictures.leaf_extras
    extensions = [*buffers.EXTENSIONS, *([WEBP_EXTENSION] if images else [])]
    return packed_glb(
        document
        | images
        | buffers.document()
        | {"extensionsUsed": extensions, "extensionsRequired": extensions},
        buffers.binary,
    )


def write_light(
    folder: Path, trees: Iterable[tuple[str, str, bytes]], drawn: Mapping[tuple[str, str], bytes]
) -> bool:
    """Write the light meshes of all trees to ``folder``, in place of those that it has; did a file change?

    ``trees``: name, species and render mesh of each. The first form of a species has the pictures of both.
    ``drawn``: what only browsers draw, by species and name: the pictures SPRAYS_NAME and SHOOTS_NAME as PNG,
    DRAWN_SPRAYS_NAME as JSON.
    """
    pictures: dict[str, Pictures] = {}
    meshes: dict[str, bytes] = {}
    index: dict[str, str] = {}
    for name, species, render_glb in trees:
        sprays, shown, shoots = (
            drawn.get((species, kind)) for kind in (SPRAYS_NAME, DRAWN_SPRAYS_NAME, SHOOTS_NAME)
        )
        own = pictures.setdefault(species, Pictures(species, sprays=sprays, shoots=shoots))
        own.drawn_sprays = None if shown is None else json.loads(shown)
        meshes[f"{name}.glb"] = light_glb(render_glb, own)
        index[hashlib.sha256(render_glb).hexdigest()] = f"{name}.glb"
        if own.sprays is not None and own.sprays_uri is not None:
            index[hashlib.sha256(own.sprays).hexdigest()] = own.sprays_uri
    images = {f"{PICTURES_FOLDER}/{file}": b for own in pictures.values() for file, b in own.files.items()}
    (folder / PICTURES_FOLDER).mkdir(parents=True, exist_ok=True)
    files = meshes | images | {INDEX_FILE: (json.dumps(index, indent=1) + "\n").encode()}
    before = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    changed = {
        file: content
        for file, content in files.items()
        if file not in before or before[file].read_bytes() != content
    }
    for file, content in changed.items():
        write_atomically(folder / file, content)
    for file in before.keys() - files.keys():
        before[file].unlink()
    return bool(changed)


def light_mesh(folder: Path, mesh_sha256: str) -> bytes | None:
    """The light copy of a render mesh in a folder of light meshes; None if it has none."""
    try:
        file = json.loads((folder / INDEX_FILE).read_bytes()).get(mesh_sha256)
        return (folder / file).read_bytes() if file else None
    except OSError:
        return None


def light_like(render_glb: bytes, folder: Path, name: str) -> bytes | None:
    """The light copy of a tree that has the pictures of a built-in one; None without a light copy of that.

    ``folder`` has the light meshes, ``name`` is the id of the built-in tree.
    """
    path = folder / f"{name}.glb"
    return light_glb(render_glb, PicturesOfLight(path.read_bytes())) if path.is_file() else None


def _texture_slots(material: Json) -> list[tuple[str, int]]:
    """The slots of a material that have a texture, and its index."""
    slots = material.get("pbrMetallicRoughness", {}) | material
    return [(slot, info["index"]) for slot, info in slots.items() if slot.endswith("Texture")]


def _images(document: Json, body: bytes, pictures: SharedPictures) -> Json:
    """Textures and images of the light mesh: one texture per slot, in the order of the render mesh."""
    textures: list[Json] = [{} for _ in document.get("textures", [])]
    images: list[Json] = []
    for material in document["materials"]:
        for slot, index in _texture_slots(material):
            texture = document["textures"][index]
            view = document["bufferViews"][document["images"][texture["source"]]["bufferView"]]
            start = view["byteOffset"]
            content = body[start : start + view["byteLength"]]
            images.append({"uri": pictures.uri(material["name"], slot, content), "mimeType": WEBP_MIME})
            textures[index] = {
                "sampler": texture["sampler"],
                "extensions": {WEBP_EXTENSION: {"source": len(images) - 1}},
            }
    return {"textures": textures, "images": images} if images else {}


def _webp(content: bytes, quality: int) -> bytes:
    """A picture as lossy WebP; its alpha is kept, and so are the colours beyond a cut-out, for filtering."""
    target = io.BytesIO()
    with Image.open(io.BytesIO(content)) as picture:
        picture.save(target, "WEBP", quality=quality, alpha_quality=100, method=6, exact=True)
    return target.getvalue()
