"""Shapes from which labelled trees are made: tubes, crowns, cards, fronds, grounds; y up, metres."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Rng = np.random.Generator
Points = NDArray[np.float64]


@dataclass
class Shape:
    """A triangle mesh with texture coordinates."""

    vertices: Points
    faces: NDArray[np.int32]
    uv: Points | None = None

    def moved(self, offset, scale=1.0) -> "Shape":
        return Shape(self.vertices * scale + np.asarray(offset, dtype=float), self.faces, self.uv)

    def turned(self, angle: float) -> "Shape":
        c, s = np.cos(angle), np.sin(angle)
        return Shape(self.vertices @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T, self.faces, self.uv)


def together(*shapes: Shape) -> Shape:
    offsets = np.cumsum([0] + [len(s.vertices) for s in shapes[:-1]])
    uv = [s.uv if s.uv is not None else np.zeros((len(s.vertices), 2)) for s in shapes]
    return Shape(
        np.concatenate([s.vertices for s in shapes]),
        np.concatenate([s.faces + o for s, o in zip(shapes, offsets, strict=True)]).astype(np.int32),
        np.concatenate(uv),
    )


def tube(path, radii, sides=8, closed=True) -> Shape:
    """A tube along a path (n, 3) with a radius at each point."""
    path, radii = np.asarray(path, dtype=float), np.broadcast_to(radii, len(path))
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(along[0], (0.0, 0.3, 1.0) if abs(along[0][2]) < 0.8 else (1.0, 0.2, 0.0))
    rings = []
    angle = np.arange(sides) * 2 * np.pi / sides
    for place, axis, radius in zip(path, along, radii, strict=True):
        side = side - axis * (side @ axis)
        side /= np.linalg.norm(side)
        other = np.cross(axis, side)
        rings.append(place + radius * (np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * other))
    vertices = np.concatenate(rings)
    faces = []
    for ring in range(len(path) - 1):
        for k in range(sides):
            a, b = ring * sides + k, ring * sides + (k + 1) % sides
            faces += [(a, b, b + sides), (a, b + sides, a + sides)]
    if closed:
        vertices = np.vstack([vertices, path[0], path[-1]])
        last, foot = (len(path) - 1) * sides, len(vertices) - 2
        for k in range(sides):
            n = (k + 1) % sides
            faces += [(n, k, foot), (last + k, last + n, foot + 1)]
    uv = np.column_stack([np.arange(len(vertices)) % sides / sides, vertices[:, 1] % 1.0])
    return Shape(vertices, np.array(faces, dtype=np.int32), uv)


def curve(rng: Rng, start, end, bend=0.05, points=6) -> Points:
    """A bent path between two points."""
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    t = np.linspace(0, 1, points)[:, None]
    middle = rng.normal(0, bend * np.linalg.norm(end - start), 3)
    return start + t * (end - start) + np.sin(np.pi * t) * middle


def ball(rng: Rng, centre, radii, noise=0.1, level=2) -> Shape:
    """An icosphere with noise: a low-poly crown."""
    g = (1 + 5**0.5) / 2
    vertices = np.array(
        [
            (-1, g, 0),
            (1, g, 0),
            (-1, -g, 0),
            (1, -g, 0),
            (0, -1, g),
            (0, 1, g),
            (0, -1, -g),
            (0, 1, -g),
            (g, 0, -1),
            (g, 0, 1),
            (-g, 0, -1),
            (-g, 0, 1),
        ],
        dtype=float,
    )
    faces = np.array(
        [
            (0, 11, 5),
            (0, 5, 1),
            (0, 1, 7),
            (0, 7, 10),
            (0, 10, 11),
            (1, 5, 9),
            (5, 11, 4),
            (11, 10, 2),
            (10, 7, 6),
            (7, 1, 8),
            (3, 9, 4),
            (3, 4, 2),
            (3, 2, 6),
            (3, 6, 8),
            (3, 8, 9),
            (4, 9, 5),
            (2, 4, 11),
            (6, 2, 10),
            (8, 6, 7),
            (9, 8, 1),
        ]
    )
    for _ in range(level - 1):
        edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        unique, inverse = np.unique(edges, axis=0, return_inverse=True)
        mid = len(vertices) + inverse.reshape(3, -1)
        vertices = np.vstack([vertices, vertices[unique].mean(axis=1)])
        a, b, c = faces.T
        ab, bc, ca = mid
        faces = np.concatenate(
            [np.column_stack(f) for f in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
        )
    vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    vertices *= 1 + noise * rng.uniform(-1, 1, (len(vertices), 1))
    uv = vertices[:, :2] / 4 + 0.5
    return Shape(vertices * np.broadcast_to(radii, 3) + np.asarray(centre), faces.astype(np.int32), uv)


def cone(centre, radius, height, sides=10, closed=True) -> Shape:
    """A cone standing on the plane y = centre's y."""
    angle = np.arange(sides) * 2 * np.pi / sides
    ring = np.column_stack([np.cos(angle), np.zeros(sides), np.sin(angle)]) * radius
    vertices = np.vstack([ring, (0, height, 0), (0, 0, 0)]) + np.asarray(centre)
    faces = [(k, sides, (k + 1) % sides) for k in range(sides)]
    if closed:
        faces += [((k + 1) % sides, sides + 1, k) for k in range(sides)]
    return Shape(vertices, np.array(faces, dtype=np.int32), vertices[:, [0, 2]] * 0.1)


def box(low, high) -> Shape:
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    corner = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Shape(low + corner * (high - low), np.array(faces, dtype=np.int32), corner[:, :2].astype(float))


def cards(rng: Rng, centres, size, up=0.3) -> Shape:
    """A square card at each point, in random directions."""
    corner = np.array([(-0.5, 0.0), (0.5, 0.0), (0.5, 1.0), (-0.5, 1.0)])
    vertices, faces, uv = [], [], []
    for k, centre in enumerate(np.asarray(centres)):
        u, v = rng.normal(size=3), rng.normal(size=3) + np.array([0, up, 0])
        u /= np.linalg.norm(u)
        v -= u * (u @ v)
        v /= np.linalg.norm(v)
        s = size * rng.uniform(0.7, 1.3)
        vertices.append(centre + s * (corner[:, :1] * u + corner[:, 1:] * v))
        uv.append(corner + np.array([0.5, 0]))
        faces += [(4 * k, 4 * k + 1, 4 * k + 2), (4 * k, 4 * k + 2, 4 * k + 3)]
    return Shape(np.concatenate(vertices), np.array(faces, dtype=np.int32), np.concatenate(uv))


def crossed(rng: Rng, centres, size) -> Shape:
    """Two crossing upright cards that share their axis, at each point."""
    shapes = []
    for centre in np.asarray(centres):
        a = rng.uniform(0, np.pi)
        s = size * rng.uniform(0.7, 1.3)
        d, e = np.array([np.cos(a), 0, np.sin(a)]) * s / 2, np.array([-np.sin(a), 0, np.cos(a)]) * s / 2
        y = np.array([0, s, 0])
        v = np.array([-d, 0 * d, d, -d + y, y, d + y, -e, e, -e + y, e + y]) + centre
        f = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (6, 1, 4), (6, 4, 8), (1, 7, 9), (1, 9, 4)]
        uv = np.array([(0, 0), (0.5, 0), (1, 0), (0, 1), (0.5, 1), (1, 1), (0, 0), (1, 0), (0, 1), (1, 1)])
        shapes.append(Shape(v, np.array(f, dtype=np.int32), uv.astype(float)))
    return together(*shapes)


def leaves(rng: Rng, centres, size) -> Shape:
    """Modelled leaves of eight triangles, slightly folded."""
    outline = np.array([(0, 0), (0.25, 0.3), (0.3, 0.6), (0, 1), (-0.3, 0.6), (-0.25, 0.3)], dtype=float)
    middle = np.array([(0, 0.35), (0, 0.65)])
    flat = np.vstack([outline, middle])
    faces = np.array([(0, 1, 6), (1, 2, 6), (2, 7, 6), (2, 3, 7), (3, 4, 7), (4, 6, 7), (4, 5, 6), (5, 0, 6)])
    shapes = []
    for centre in np.asarray(centres):
        u, v = rng.normal(size=3), rng.normal(size=3)
        u /= np.linalg.norm(u)
        v -= u * (u @ v)
        v /= np.linalg.norm(v)
        fold = 0.15 * np.abs(flat[:, :1]) * np.cross(u, v)
        s = size * rng.uniform(0.7, 1.3)
        shapes.append(
            Shape(centre + s * (flat[:, :1] * u + flat[:, 1:] * v + fold), faces.astype(np.int32), flat)
        )
    return together(*shapes)


def frond(rng: Rng, start, direction, length, width, thick=0.0, points=7) -> Shape:
    """A palm frond: an arching strip, flat or with a lens-shaped section."""
    t = np.linspace(0, 1, points)
    out = np.array([np.cos(direction), 0, np.sin(direction)])
    spine = np.asarray(start) + length * (
        t[:, None] * out + (0.5 * t - 0.9 * t**2)[:, None] * np.array([0, 1.0, 0])
    )
    across = np.cross(out, (0, 1.0, 0))
    half = width / 2 * np.sin(np.pi * np.clip(t * 0.9 + 0.08, 0, 1))[:, None] * across
    rows = [spine - half, spine + half]
    if thick:
        lift = np.array([0, thick, 0]) * np.sin(np.pi * t)[:, None]
        rows = [spine - half, spine + lift, spine + half, spine - lift]
    n = len(rows)
    vertices = np.stack(rows, axis=1).reshape(-1, 3)
    faces = []
    for k in range(points - 1):
        for j in range(n if thick else 1):
            a, b = k * n + j, k * n + (j + 1) % n
            faces += [(a, b, b + n), (a, b + n, a + n)]
    if thick:
        last = (points - 1) * n
        faces += [(0, 2, 1), (0, 3, 2), (last, last + 1, last + 2), (last, last + 2, last + 3)]
    uv = np.tile(np.linspace(0, 1, n), points)
    return Shape(vertices, np.array(faces, dtype=np.int32), np.column_stack([uv, np.repeat(t, n)]))


def terrain(rng: Rng, radius, bump, cells=12, y=0.0) -> Shape:
    """A bumpy square of ground."""
    side = np.linspace(-radius, radius, cells + 1)
    x, z = np.meshgrid(side, side, indexing="ij")
    height = bump * rng.uniform(-1, 1, x.shape) - 0.6 * bump
    vertices = np.column_stack([x.ravel(), y + height.ravel(), z.ravel()])
    n = cells + 1
    a = (np.arange(cells)[:, None] * n + np.arange(cells)).ravel()
    faces = np.concatenate([np.column_stack([a, a + 1, a + n + 1]), np.column_stack([a, a + n + 1, a + n])])
    return Shape(vertices, faces.astype(np.int32), vertices[:, [0, 2]] / (2 * radius))


def in_ball(rng: Rng, centre, radii, count) -> Points:
    """Points in an ellipsoid, denser towards its surface."""
    d = rng.normal(size=(count, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    return np.asarray(centre) + d * rng.uniform(0.55, 1, (count, 1)) * np.broadcast_to(radii, 3)
