"""The parts of a glTF document that are read, with their types; whatever else it holds is dropped here.

Values of a wrong type, out of range or not finite are refused at this one place, and names are cleaned, so
that the readers can rely on both. Source: glTF 2.0 specification, section 5.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Required, TypeVar

from pydantic import AfterValidator, BeforeValidator, FailFast, Field, TypeAdapter, ValidationError
from typing_extensions import TypedDict

from galewood.util import MeshError, shown_text

Json = dict[str, Any]
MOST_ATTRIBUTES = 256  # of a primitive
_T = TypeVar("_T")


def _clean_name(value: object) -> str:
    return shown_text(value) if isinstance(value, str) else ""


def _whole(value: object) -> object:
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _opaque(colour: list[float]) -> list[float]:
    return [*colour, 1.0][:4]


_Name = Annotated[str, BeforeValidator(_clean_name)]
# an index, a count, or a number of bytes; some exporters write 3.0
_Index = Annotated[int, BeforeValidator(_whole), Field(ge=0, lt=1 << 53)]
_Number = Annotated[float, Field(allow_inf_nan=False)]
_List = Annotated[list[_T], FailFast()]
_Two = Annotated[list[_Number], Field(min_length=2, max_length=2)]
_Three = Annotated[list[_Number], Field(min_length=3, max_length=3)]
_Four = Annotated[list[_Number], Field(min_length=4, max_length=4)]
# exporters also write three components, or more than four
_Colour = Annotated[list[_Number], Field(min_length=3), AfterValidator(_opaque)]
_Matrix = Annotated[list[_Number], Field(min_length=16, max_length=16)]
_Attributes = Annotated[dict[str, _Index], Field(max_length=MOST_ATTRIBUTES)]
_ComponentType = Literal[5120, 5121, 5122, 5123, 5125, 5126]


class _Scene(TypedDict, total=False):
    nodes: _List[_Index]


class _Instancing(TypedDict):
    attributes: _Attributes


class _NodeExtensions(TypedDict, total=False):
    EXT_mesh_gpu_instancing: _Instancing


class _Node(TypedDict, total=False):
    name: _Name
    mesh: _Index
    skin: _Index
    weights: _List[_Number]
    children: _List[_Index]
    matrix: _Matrix
    translation: _Three
    rotation: _Four
    scale: _Three
    extensions: _NodeExtensions


class _Draco(TypedDict):
    bufferView: _Index
    attributes: _Attributes


class _PrimitiveExtensions(TypedDict, total=False):
    KHR_draco_mesh_compression: _Draco


class _Primitive(TypedDict, total=False):
    attributes: Required[_Attributes]
    indices: _Index
    material: _Index
    mode: Literal[0, 1, 2, 3, 4, 5, 6]
    targets: _List[_Attributes]
    extensions: _PrimitiveExtensions


class _Mesh(TypedDict, total=False):
    name: _Name
    primitives: _List[_Primitive]
    weights: _List[_Number]


class _SparseIndices(TypedDict, total=False):
    bufferView: Required[_Index]
    componentType: Required[_ComponentType]
    byteOffset: _Index


class _SparseValues(TypedDict, total=False):
    bufferView: Required[_Index]
    byteOffset: _Index


class _Sparse(TypedDict):
    count: _Index
    indices: _SparseIndices
    values: _SparseValues


class _Accessor(TypedDict, total=False):
    bufferView: _Index
    byteOffset: _Index
    componentType: Required[_ComponentType]
    normalized: bool
    count: Required[_Index]
    type: Required[Literal["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]]
    sparse: _Sparse


class _Meshopt(TypedDict, total=False):
    buffer: Required[_Index]
    byteOffset: _Index
    byteLength: Required[_Index]
    byteStride: Required[_Index]
    count: Required[_Index]
    mode: Required[str]
    filter: str


class _ViewExtensions(TypedDict, total=False):
    EXT_meshopt_compression: _Meshopt
    KHR_meshopt_compression: _Meshopt


class _BufferView(TypedDict, total=False):
    buffer: Required[_Index]
    byteOffset: _Index
    byteLength: Required[_Index]
    byteStride: _Index
    extensions: _ViewExtensions


class _Buffer(TypedDict, total=False):
    uri: str
    byteLength: _Index


class _Image(TypedDict, total=False):
    name: _Name
    uri: str
    bufferView: _Index


class _Source(TypedDict, total=False):
    source: _Index


class _TextureExtensions(TypedDict, total=False):
    EXT_texture_webp: _Source
    KHR_texture_basisu: _Source
    EXT_texture_avif: _Source
    MSFT_texture_dds: _Source


class _Texture(TypedDict, total=False):
    sampler: _Index
    source: _Index
    extensions: _TextureExtensions


class _Sampler(TypedDict, total=False):
    magFilter: _Index
    minFilter: _Index
    wrapS: _Index
    wrapT: _Index


class _TextureTransform(TypedDict, total=False):
    offset: _Two
    rotation: _Number
    scale: _Two
    texCoord: _Index


class _TextureInfoExtensions(TypedDict, total=False):
    KHR_texture_transform: _TextureTransform


class _TextureInfo(TypedDict, total=False):
    index: Required[_Index]
    texCoord: _Index
    scale: _Number  # of normals
    strength: _Number  # of occlusion
    extensions: _TextureInfoExtensions


class _Metallic(TypedDict, total=False):
    baseColorFactor: _Colour
    baseColorTexture: _TextureInfo
    metallicFactor: _Number
    roughnessFactor: _Number
    metallicRoughnessTexture: _TextureInfo


class _Glossy(TypedDict, total=False):
    diffuseFactor: _Colour
    diffuseTexture: _TextureInfo
    glossinessFactor: _Number


class _Nothing(TypedDict):
    pass


class _MaterialExtensions(TypedDict, total=False):
    KHR_materials_unlit: _Nothing
    KHR_materials_pbrSpecularGlossiness: _Glossy


class _Material(TypedDict, total=False):
    name: _Name
    pbrMetallicRoughness: _Metallic
    normalTexture: _TextureInfo
    occlusionTexture: _TextureInfo
    emissiveTexture: _TextureInfo
    emissiveFactor: _Three
    alphaMode: Literal["OPAQUE", "MASK", "BLEND"]
    alphaCutoff: _Number
    doubleSided: bool
    extensions: _MaterialExtensions


class _Skin(TypedDict, total=False):
    joints: Required[_List[_Index]]
    inverseBindMatrices: _Index


class _Document(TypedDict, total=False):
    extensionsUsed: _List[_Name]
    extensionsRequired: _List[_Name]
    animations: list[Any]
    scene: _Index
    scenes: _List[_Scene]
    nodes: _List[_Node]
    meshes: _List[_Mesh]
    skins: _List[_Skin]
    materials: _List[_Material]
    textures: _List[_Texture]
    images: _List[_Image]
    samplers: _List[_Sampler]
    accessors: _List[_Accessor]
    bufferViews: _List[_BufferView]
    buffers: _List[_Buffer]


_DOCUMENT = TypeAdapter(_Document)


def checked_document(raw: Json) -> Json:
    """What is read of a document, all of the right types. MeshError that names the first wrong value."""
    try:
        return dict(_DOCUMENT.validate_python(raw, strict=True))
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False, include_input=False)[0]
        place = ".".join(shown_text(str(step)) for step in first["loc"])
        raise MeshError(
            "gltf-structure",
            "malformed",
            f"The glTF has a wrong value at {place}: {first['msg'].replace('Input', 'it', 1)}.",
            "The file is damaged; export it again.",
        ) from error
