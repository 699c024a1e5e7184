"""A writer of small ASCII FBX files (version 7.4) for the tests."""

from collections.abc import Iterable

from galewood.tree.repair import Surface

AXES = {"y": (1, 1, 2, 1, 0, 1), "z": (2, 1, 1, -1, 0, 1)}  # up, front and right: axis and sign
NAMES = ("UpAxis", "UpAxisSign", "FrontAxis", "FrontAxisSign", "CoordAxis", "CoordAxisSign")


def fbx_bytes(
    parts: dict[str, tuple[Surface, tuple[float, float, float]]], up="y", centimetres_per_unit=100.0
) -> bytes:
    """Parts by the name of their material, with its diffuse colour (sRGB)."""
    objects: list[str] = []
    links: list[str] = []
    for k, (name, (surface, colour)) in enumerate(parts.items()):
        geometry, model, material = 1000 + k, 2000 + k, 3000 + k
        corners = [i if n < 2 else ~i for face in surface.faces.tolist() for n, i in enumerate(face)]
        objects.append(
            f'Geometry: {geometry}, "Geometry::{name}", "Mesh" {{\n'
            f"Vertices: {_array(f'{c:.9g}' for c in surface.vertices.reshape(-1))}\n"
            f"PolygonVertexIndex: {_array(str(c) for c in corners)}\n"
            'LayerElementMaterial: 0 {\nVersion: 101\nName: ""\nMappingInformationType: "AllSame"\n'
            'ReferenceInformationType: "IndexToDirect"\nMaterials: *1 {\na: 0\n}\n}\n'
            "Layer: 0 {\nVersion: 100\nLayerElement: {\n"
            'Type: "LayerElementMaterial"\nTypedIndex: 0\n}\n}\n}\n'
            f'Model: {model}, "Model::{name}", "Mesh" {{\nVersion: 232\n}}\n'
            f'Material: {material}, "Material::{name}", "" {{\nVersion: 102\nShadingModel: "lambert"\n'
            f'Properties70: {{\nP: "DiffuseColor", "Color", "", "A",{",".join(map(str, colour))}\n}}\n}}\n'
        )
        links += [f'C: "OO",{model},0', f'C: "OO",{geometry},{model}', f'C: "OO",{material},{model}']
    settings = "\n".join(f'P: "{n}", "int", "Integer", "",{v}' for n, v in zip(NAMES, AXES[up], strict=True))
    return (
        "; FBX 7.4.0 project file\nFBXHeaderExtension: {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\n"
        f"GlobalSettings: {{\nVersion: 1000\nProperties70: {{\n{settings}\n"
        f'P: "UnitScaleFactor", "double", "Number", "",{centimetres_per_unit}\n}}\n}}\n'
        f"Objects: {{\n{''.join(objects)}}}\nConnections: {{\n" + "\n".join(links) + "\n}\n"
    ).encode()


def _array(values: Iterable[str]) -> str:
    listed = list(values)
    return f"*{len(listed)} {{\na: {','.join(listed)}\n}}"
