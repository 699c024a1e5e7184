"""Files whose structure is nested so deep, or in a circle, that parsers overflow their stack."""

from __future__ import annotations

import struct
import zlib

from tests.precompute import tree_meshes as make
from tests.precompute.fbx_files import fbx_bytes

FBX_MAGIC = b"Kaydara FBX Binary  \0\x1a\0"


def deep_text_fbx(levels: int) -> bytes:
    plain = fbx_bytes({"bark": (make.y_tree(), (0.3, 0.2, 0.1))})
    return plain + b"Deep: {\n" * levels + b"}\n" * levels


def deep_binary_fbx(levels: int) -> bytes:
    """Records within records; each has a header of 13 bytes and a name of one."""
    offset = len(FBX_MAGIC) + 4
    end = offset + levels * (14 + 13)  # each record with children ends with an empty one
    body = b"".join(struct.pack("<3IB", end - 13 * k, 0, 0, 1) + b"d" for k in range(levels))
    return FBX_MAGIC + struct.pack("<I", 7400) + body + bytes(13 * levels) + bytes(13)


def model_fbx(links: list[tuple[int, int]], hidden: bool = False) -> bytes:
    """A text file with models that hang on one another; `hidden`: with comments between the tokens."""
    numbers = sorted({number for link in links for number in link if number})
    models = "".join(f'Model: {k}, "Model::m{k}", "Null" {{\nVersion: 232\n}}\n' for k in numbers)
    colon = ":;}\n" if hidden else ":"
    joined = "".join(f'C{colon} "OO",;"\n{child},{parent}\n' for child, parent in links)
    plain = fbx_bytes({"bark": (make.y_tree(), (0.3, 0.2, 0.1))})
    plain = plain.replace(b"Objects: {\n", b"Objects: {\n" + models.encode(), 1)
    return plain.replace(b"Connections: {\n", b"Connections: {\n" + joined.encode(), 1)


def fbx_record(name: bytes, properties: list[bytes], end_of_all: list[int]) -> bytes:
    """A record of a binary file without children; `end_of_all` holds the offset where it begins."""
    content = b"".join(properties)
    end_of_all[0] += 13 + len(name) + len(content)
    return struct.pack("<3IB", end_of_all[0], len(properties), len(content), len(name)) + name + content


def circular_binary_fbx() -> bytes:
    """Two models that contain each other. (The library wants more of a file, but the check comes first.)"""
    at = [27]
    models = [fbx_record(b"Model", [b"L" + struct.pack("<q", k)], at) for k in (5, 6)]
    kind = b"S" + struct.pack("<I", 2) + b"OO"
    ids = [b"L" + struct.pack("<q", k) for k in (5, 6)]
    links = [fbx_record(b"C", [kind, ids[k], ids[1 - k]], at) for k in (0, 1)]
    return FBX_MAGIC + struct.pack("<I", 7400) + b"".join([*models, *links]) + bytes(13)


def dae(nodes: str, scene: str) -> bytes:
    """A COLLADA document of a triangle, with a library of nodes."""
    positions = "0 0 0 1 0 0 0 1 0"
    return (
        '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'
        '<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="f" count="9">'
        f"{positions}</float_array><technique_common>"
        '<accessor source="#f" count="3" stride="3"><param name="X" type="float"/><param name="Y" '
        'type="float"/><param name="Z" type="float"/></accessor></technique_common></source>'
        '<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">'
        '<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>'
        f"</library_geometries><library_nodes>{nodes}</library_nodes>"
        '<library_visual_scenes><visual_scene id="s">'
        f"{scene}</visual_scene></library_visual_scenes>"
        '<scene><instance_visual_scene url="#s"/></scene></COLLADA>'
    ).encode()


TRIANGLE = '<instance_geometry url="#g"/>'


def cyclic_dae(by: str = "id") -> bytes:
    first = f'<node {by}="a">{TRIANGLE}<instance_node url="#b"/></node>'
    second = f'<node {by}="b"><instance_node url="#a"/></node>'
    return dae(first + second, '<node id="r"><instance_node url="#a"/></node>')


def self_containing_dae() -> bytes:
    return dae("", f'<node id="r">{TRIANGLE}<node id="q"><instance_node url="#r"/></node></node>')


def scene_within_itself_dae() -> bytes:
    return dae("", f'<node id="r">{TRIANGLE}<instance_node url="#s"/></node>')


def circular_parameters_dae() -> bytes:
    """A texture whose sampler takes its image from itself."""
    effect = (
        '<library_effects><effect id="e"><profile_COMMON>'
        '<newparam sid="a"><sampler2D><source>b</source></sampler2D></newparam>'
        '<newparam sid="b"><surface type="2D"><init_from> a </init_from></surface></newparam>'
        '<technique sid="t"><lambert><diffuse><texture texture="a" texcoord="u"/></diffuse></lambert>'
        "</technique></profile_COMMON></effect></library_effects>"
        '<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>'
    )
    return dae("", f"<node>{TRIANGLE}</node>").replace(
        b"<library_geom", effect.encode() + b"<library_geom", 1
    )


def doubling_dae(levels: int) -> bytes:
    nodes = "".join(
        f'<node id="n{k}"><instance_node url="#n{k + 1}"/><instance_node url="#n{k + 1}"/></node>'
        for k in range(levels)
    )
    return dae(f'{nodes}<node id="n{levels}">{TRIANGLE}</node>', '<node><instance_node url="#n0"/></node>')


def deep_dae(levels: int, tag: str = "node") -> bytes:
    return dae("", f"<{tag}>" * levels + f"<node>{TRIANGLE}</node>" + f"</{tag}>" * levels)


def three_ds_chunk(kind: int, body: bytes) -> bytes:
    return struct.pack("<HI", kind, 6 + len(body)) + body


def deep_3ds(levels: int) -> bytes:
    """A triangle with a hierarchy of dummy objects below one another."""
    vertices = struct.pack("<H9f", 3, 0, 0, 0, 1, 0, 0, 0, 1, 0)
    faces = struct.pack("<H4H", 1, 0, 1, 2, 0)
    mesh = three_ds_chunk(0x4100, three_ds_chunk(0x4110, vertices) + three_ds_chunk(0x4120, faces))
    objects = three_ds_chunk(0x3D3D, three_ds_chunk(0x4000, b"tree\0" + mesh))
    tracks = b"".join(
        three_ds_chunk(
            0xB002,
            three_ds_chunk(0xB030, struct.pack("<H", k))
            + three_ds_chunk(0xB010, b"tree\0" + struct.pack("<3H", 0, 0, k - 1 if k else 0xFFFF)),
        )
        for k in range(levels)
    )
    return three_ds_chunk(0x4D4D, objects + three_ds_chunk(0xB000, tracks))


def mat(variable: bytes) -> bytes:
    """A MATLAB 5 file of one variable."""
    return b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<HH", 0x0100, 0x4D49) + variable


def element(kind: int, body: bytes) -> bytes:
    return struct.pack("<II", kind, len(body)) + body + bytes(-len(body) % 8)


def matrix_head(array_class: int, name: bytes = b"") -> bytes:
    flags = element(6, struct.pack("<II", array_class, 0))
    return flags + element(5, struct.pack("<ii", 1, 1)) + element(1, name)


def nested_cells(levels: int, honest: bool = True, array_class: int = 1) -> bytes:
    """Cells (class 1), structs (2) or functions (16) in one another; sizes may lie, as scipy ignores them."""
    fields = element(5, struct.pack("<i", 8)) + element(1, b"f".ljust(8, b"\0")) if array_class == 2 else b""
    number = matrix_head(6) + element(9, struct.pack("<d", 1.0))
    size, heads = len(number), list[bytes]()
    for k in reversed(range(levels)):
        head = matrix_head(array_class, b"QSM" if k == 0 else b"") + fields
        heads.append(struct.pack("<II", 14, len(head) + 8 + size if honest or k == 0 else len(head)) + head)
        size += len(head) + 8
    return b"".join([*reversed(heads), struct.pack("<II", 14, len(number)), number])


def packed(variable: bytes) -> bytes:
    """The variable as MATLAB compresses it."""
    content = zlib.compress(variable, 6)
    return struct.pack("<II", 15, len(content)) + content
