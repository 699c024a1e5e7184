"""Writes a small tree as web sites ship trees, in four ways, into the folder that is the argument.

draco.glb (compressed, a texture as WebP), skinned.glb (lies on its side without its skeleton), tree.zip (OBJ
with its materials and a texture),
scan.ply (upright along z, on the ground that was scanned with it, without colours).
"""

import io
import sys
import zipfile
from pathlib import Path

import numpy as np
from galewood.tree.repair import Surface

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.gltf_files import SQUARE_UV, GltfFile, leaf_image

CARDS = [(1.5, 4.3, 0.1), (1.2, 4.0, -0.1), (-1.2, 4.3, 0.3), (-1.4, 4.6, 0.2), (0.6, 3.2, 0.0)]


def slender(width: float) -> Surface:
    """A trunk with two thin branches, 5 m high; `width` makes the trees differ."""
    trunk = make.tube((0, 0, 0), (0, 2.6, 0), 0.07 * width, 0.05 * width)
    return make.joined(trunk, *(make.tube(a, b, 0.035, 0.012) for a, b in make.BRANCHES))


def draco() -> bytes:
    file = GltfFile()
    leaf = file.material("leaves", leaf_image("WEBP", 64), "image/webp", "EXT_texture_webp")
    crown = file.plain(make.cards(CARDS, 0.4), material=leaf)
    crown["attributes"]["TEXCOORD_0"] = file.accessor(np.tile(SQUARE_UV, (len(CARDS), 1)).astype("<f4"))
    file.node(name="trunk", mesh=file.mesh(file.draco(slender(1.0))))
    file.node(name="crown", mesh=file.mesh(crown))
    return file.bytes()


def skinned() -> bytes:
    tree = slender(1.1)
    lying = Surface(tree.vertices @ np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]).T, tree.faces)
    file = GltfFile()
    primitive = file.plain(lying)
    rows = np.zeros((len(lying.vertices), 4))
    primitive["attributes"]["JOINTS_0"] = file.accessor(rows.astype("<u1"))
    primitive["attributes"]["WEIGHTS_0"] = file.accessor((rows + np.eye(4)[0]).astype("<f4"))
    half = float(np.sqrt(0.5))
    joint = file.node(name="root", rotation=[0, 0, -half, half])
    file.json["skins"] = [{"joints": [joint]}]
    file.node(name="trunk", mesh=file.mesh(primitive), skin=0)
    return file.bytes()


def zipped() -> bytes:
    tree, crown = slender(1.2), make.cards(CARDS, 0.4)
    lines = ["mtllib tree.mtl", "usemtl bark"]
    lines += ["v " + " ".join(f"{c:.6f}" for c in row) for row in np.vstack([tree.vertices, crown.vertices])]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in tree.faces]
    lines += [f"vt {u} {1 - v}" for u, v in SQUARE_UV] + ["usemtl leaves"]
    first = len(tree.vertices)
    lines += ["f " + " ".join(f"{first + i + 1}/{i % 4 + 1}" for i in face) for face in crown.faces]
    library = "newmtl bark\nKd 0.45 0.33 0.25\nnewmtl leaves\nmap_Kd textures/leaf.png\n"
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("tree/tree.obj", "\n".join(lines))
        archive.writestr("tree/tree.mtl", library)
        archive.writestr("tree/textures/leaf.png", leaf_image("PNG", 64))
    return stream.getvalue()


def scanned() -> bytes:
    tree = slender(1.3)
    side = np.linspace(-3.0, 3.0, 21)
    x, y = (axis.ravel() for axis in np.meshgrid(side, side))
    ground = np.column_stack([x, y, 0.04 * np.sin(3 * x) * np.cos(2 * y)])
    corner = np.arange(20 * 21).reshape(20, 21)[:, :-1].ravel()
    halves = corner + np.array([[0], [1], [21]]), corner + np.array([[1], [22], [21]])
    upright = np.column_stack([tree.vertices[:, 0], -tree.vertices[:, 2], tree.vertices[:, 1]])
    vertices = np.vstack([upright, ground])
    faces = np.vstack([tree.faces, *(len(upright) + half.T for half in halves)])
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(f"{c:.5f}" for c in row) for row in vertices]
    lines += ["3 " + " ".join(str(k) for k in face) for face in faces]
    return "\n".join([*lines, ""]).encode()


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for name, content in (
        ("draco.glb", draco()),
        ("skinned.glb", skinned()),
        ("tree.zip", zipped()),
        ("scan.ply", scanned()),
    ):
        (folder / name).write_bytes(content)
