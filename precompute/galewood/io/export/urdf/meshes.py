"""The drawn mesh, divided among the bodies, as OBJ files with a common material file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.rigid.bodies import GROUND_BODY, RigidTree, upright
from galewood.io.export.rigid.looks import Look, write_look
from galewood.io.export.urdf.document import mesh_file
from galewood.table import Table
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class _Drawn:
    """A primitive of the drawn mesh, z up."""

    material: str
    corner: Ints
    """(f, 3)"""
    body: Ints
    """(f,) that carries the triangle."""
    rows: tuple[Floats, Floats, Floats]
    """Places (v, 3), texture coordinates (v, 2) with v from the bottom, and normals (v, 3)."""


def write_meshes(
    folder: Path, name: str, table: Table, file: GltfFile, tree: RigidTree, names: list[str]
) -> set[int]:
    """Write the OBJ file of each body that something is drawn of, and NAME.mtl; return these bodies.

    A triangle is drawn with the body of two of its corners. Places are relative to the body's hinge.
    ``names`` (b + 1): of the bodies, and last of what stands for the ground.
    """
    looks, drawn = list[tuple[str, Look]](), list[_Drawn]()
    body = tree.of_node[table.vertex_node.astype(np.int64)]
    rest, normals = upright(file.rest_m()), upright(file.normals())
    start = 0
    for index, primitive in enumerate(table.metadata["primitives"]):
        mine = slice(start, start + int(primitive["vertices"]))
        start, kind = mine.stop, str(primitive["kind"])
        if kind == "leaves" and table.foliage == "bare":
            continue
        material = f"{name}_{kind}_{index}"
        look = write_look(file, index, folder, name, transparent=True)
        looks.append((material, look))
        corner, uv = file.faces()[index], file.texture_coordinates()[index]
        picture = np.zeros((mine.stop - mine.start, 2)) if uv is None else _from_bottom(uv.astype(np.float64))
        held = np.sort(body[mine][corner], axis=1)[:, 1]
        drawn.append(_Drawn(material, corner, held, (rest[mine], picture, normals[mine])))
        if look.both_sides:  # the other side, as programs differ in whether they draw it
            drawn.append(_Drawn(material, corner[:, ::-1], held, (rest[mine], picture, -normals[mine])))
    (folder / f"{name}.mtl").write_text("\n".join(_material(*one) for one in looks))
    used = {int(one) for part in drawn for one in np.unique(part.body)}
    for one in used:
        place = np.zeros(3) if one == GROUND_BODY else upright(tree.hinge_m[one])
        (folder / mesh_file(names[one])).write_text(f"mtllib {name}.mtl\n" + _object(drawn, one, place))
    return used


def _from_bottom(uv: Floats) -> Floats:
    """Texture coordinates (v, 2) of glTF, whose second one counts from the top, as OBJ has them."""
    return np.stack([uv[:, 0], 1.0 - uv[:, 1]], axis=1)


def _material(name: str, look: Look) -> str:
    red, green, blue, alpha = look.rgba
    lines = [f"newmtl {name}", f"Kd {red:.4g} {green:.4g} {blue:.4g}", "Ks 0 0 0", f"d {alpha:.4g}"]
    if look.texture is not None:
        lines += [f"map_Kd {look.texture}", f"map_d {look.texture}"]
    return "\n".join(lines) + "\n"


def _object(drawn: list[_Drawn], body: int, place_m: Floats) -> str:
    """The lines of an OBJ file; its vertices are numbered from 1, through all materials."""
    lines, first = list[str](), 1
    for part in drawn:
        corner = part.corner[part.body == body]
        if not len(corner):
            continue
        kept, number = np.unique(corner, return_inverse=True)
        places, picture, normals = (rows[kept] for rows in part.rows)
        lines += [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in places - place_m]
        lines += [f"vt {u:.5f} {v:.5f}" for u, v in picture]
        lines += [f"vn {x:.4f} {y:.4f} {z:.4f}" for x, y, z in normals]
        lines.append(f"usemtl {part.material}")
        lines += [
            "f " + " ".join(f"{k}/{k}/{k}" for k in row) for row in (number.reshape(-1, 3) + first).tolist()
        ]
        first += len(kept)
    return "\n".join(lines) + "\n"
