"""Surface repair on arrays: welding, duplicate faces, consistent winding, hole filling."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from galewood.util import Floats, Ints

WELD_TOLERANCE = 2e-6  # relative to the bounding-box diagonal


@dataclass(frozen=True)
class Surface:
    """A triangle surface: vertices (n, 3), faces (m, 3)."""

    vertices: Floats
    faces: Ints


def weld(surface: Surface) -> Surface:
    """Merge vertices closer than WELD_TOLERANCE of the diagonal and remove degenerate faces."""
    used, inverse = np.unique(surface.vertices, axis=0, return_inverse=True)
    tolerance = WELD_TOLERANCE * float(np.linalg.norm(np.ptp(used, axis=0)))
    pairs = (
        KDTree(used).query_pairs(tolerance, output_type="ndarray") if tolerance > 0 else np.zeros((0, 2), int)
    )
    count, label = _components(len(used), pairs)
    first = np.full(count, -1)
    first[label[::-1]] = np.arange(len(used))[::-1]
    faces = label[inverse.reshape(-1)][surface.faces]
    return compact(Surface(used[first], clean_faces(used[first], faces.astype(np.int32))))


def weld_keeping_faces(surface: Surface) -> Surface:
    """Weld seams for connectivity; all faces, even degenerate ones, keep their order."""
    scale = float(np.ptp(surface.vertices, axis=0).max()) or 1.0
    rounded = np.round(surface.vertices / (scale * 1e-6)).astype(np.int64)
    _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    return Surface(surface.vertices[first], inverse.reshape(-1)[surface.faces].astype(np.int32))


def clean_faces(vertices: Floats, faces: Ints) -> Ints:
    """Faces without degenerate ones and without duplicates (of either orientation)."""
    a, b, c = faces.T
    distinct = (a != b) & (b != c) & (c != a)
    faces = faces[distinct]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    return faces[np.sort(first)]


def compact(surface: Surface) -> Surface:
    """The surface without unused vertices."""
    used, inverse = np.unique(surface.faces, return_inverse=True)
    return Surface(surface.vertices[used], inverse.reshape(-1, 3).astype(np.int32))


def face_components(faces: Ints, vertices: int) -> tuple[int, Ints]:
    """Number of connected components and the component of each face; shared vertices connect."""
    edges = np.concatenate([faces[:, :2], faces[:, 1:]])
    _, label = _components(vertices, edges)
    unique, of_face = np.unique(label[faces[:, 0]], return_inverse=True)
    return len(unique), of_face.astype(np.int32)


def edge_components(faces: Ints) -> tuple[int, Ints]:
    """Number of components connected through edges, not just vertices, and the component of each face."""
    ordered = np.sort(directed_edges(faces), axis=1).astype(np.int64)
    _, edge = np.unique(ordered[:, 0] * (int(faces.max()) + 1) + ordered[:, 1], return_inverse=True)
    face = np.tile(np.arange(len(faces)), 3)
    graph = np.column_stack([face, len(faces) + edge.reshape(-1)])
    _, label = _components(len(faces) + int(edge.max()) + 1, graph)
    unique, of_face = np.unique(label[: len(faces)], return_inverse=True)
    return len(unique), of_face.astype(np.int32)


def _components(count: int, pairs: np.ndarray) -> tuple[int, np.ndarray]:
    graph = coo_matrix((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return connected_components(graph, directed=False)


def agree_windings(faces: Ints) -> tuple[Ints, int]:
    """Faces reoriented so that neighbours run their common edge in opposite directions, and how many changed.

    Breadth-first search over faces that share an edge with exactly one other face.
    """
    neighbours, same = _edge_neighbours(faces)
    flip = np.full(len(faces), -1, dtype=np.int8)
    for start in range(len(faces)):
        if flip[start] >= 0:
            continue
        flip[start] = 0
        stack = [start]
        while stack:
            face = stack.pop()
            for side in range(3):
                other = neighbours[face, side]
                if other >= 0 and flip[other] < 0:
                    flip[other] = flip[face] ^ same[face, side]
                    stack.append(int(other))
    turned = flip == 1
    result = faces.copy()
    result[turned] = faces[turned][:, ::-1]
    return result, int(turned.sum())


def _edge_neighbours(faces: Ints) -> tuple[np.ndarray, np.ndarray]:
    """For each face side: the neighbouring face (−1: none or ambiguous), and 1 if both run the edge alike."""
    edges = directed_edges(faces)
    key = np.sort(edges, axis=1)
    order = np.lexsort((key[:, 1], key[:, 0]))
    ordered = key[order]
    new = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])
    starts = np.flatnonzero(new)
    sizes = np.diff(np.append(starts, len(order)))
    first, second = order[starts[sizes == 2]], order[starts[sizes == 2] + 1]
    neighbours = np.full((len(faces), 3), -1, dtype=np.int64)
    same = np.zeros((len(faces), 3), dtype=np.int8)
    alike = (edges[first, 0] == edges[second, 0]).astype(np.int8)
    rows = len(faces)
    for here, there in ((first, second), (second, first)):
        neighbours[here % rows, here // rows] = there % rows
        same[here % rows, here // rows] = alike
    return neighbours, same


def directed_edges(faces: Ints) -> Ints:
    """All directed edges (3 m, 2): first sides of all faces, then second, then third."""
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def unique_edges(faces: Ints) -> Ints:
    """Edges (e, 2) of triangles (m, 3), each once, as ascending pairs in ascending order."""
    return np.unique(np.sort(directed_edges(faces), axis=1), axis=0)


def signed_volumes(surface: Surface, of_face: Ints, count: int) -> Floats:
    """Signed volume of each component relative to its own centre, so that open components have one too."""
    corners = surface.vertices[surface.faces]
    weight = np.bincount(of_face, minlength=count)[:, None]
    centre = (
        np.stack([np.bincount(of_face, corners[:, :, k].mean(axis=1), count) for k in range(3)], axis=1)
        / weight
    )
    a, b, c = np.moveaxis(corners - centre[of_face][:, None], 1, 0)
    return np.asarray(
        np.bincount(of_face, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0, count), dtype=np.float64
    )


def face_outwards(surface: Surface) -> tuple[Surface, int]:
    """Reverse components of negative volume; also returns how many."""
    count, of_face = edge_components(surface.faces)
    inverted = signed_volumes(surface, of_face, count) < 0
    faces = surface.faces.copy()
    turn = inverted[of_face]
    faces[turn] = faces[turn][:, ::-1]
    return Surface(surface.vertices, faces), int(inverted.sum())


def open_edges(faces: Ints) -> Ints:
    """Directed edges (k, 2) without an opposite edge: the boundaries of holes."""
    edges = directed_edges(faces)
    size = int(faces.max()) + 1 if len(faces) else 1
    forward = edges[:, 0].astype(np.int64) * size + edges[:, 1]
    backward = edges[:, 1].astype(np.int64) * size + edges[:, 0]
    return edges[~np.isin(forward, backward)]


def cap(surface: Surface) -> tuple[Surface, int]:
    """Close every boundary loop with a fan around its centre; also returns the number of loops."""
    loops = _loops(open_edges(surface.faces))
    vertices, faces = [surface.vertices], [surface.faces]
    total = len(surface.vertices)
    for loop in loops:
        vertices.append(surface.vertices[loop].mean(axis=0, keepdims=True))
        following = np.roll(loop, -1)
        faces.append(np.column_stack([following, loop, np.full(len(loop), total)]).astype(np.int32))
        total += 1
    return Surface(np.concatenate(vertices), np.concatenate(faces)), len(loops)


def _loops(edges: Ints) -> list[Ints]:
    """Boundary loops as vertex sequences; where loops touch at a vertex, any remaining edge is followed."""
    following: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        following.setdefault(a, []).append(b)
    loops: list[Ints] = []
    for start in list(following):
        while following.get(start):
            loop = [start]
            step = following[start].pop()
            while step != start and following.get(step):
                loop.append(step)
                step = following[step].pop()
            if len(loop) >= 3 or (len(loop) == 2 and step == start):
                loops.append(np.array(loop, dtype=np.int32))
    return [loop for loop in loops if len(loop) >= 3]


def volume(surface: Surface) -> float:
    """Volume enclosed by a closed surface with outward faces."""
    a, b, c = np.moveaxis(surface.vertices[surface.faces] - surface.vertices.mean(axis=0), 1, 0)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)
