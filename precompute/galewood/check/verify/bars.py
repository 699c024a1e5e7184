"""Structured tetrahedral meshes of bars and poles with exact cross-sections, for beam-theory checks."""

from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from galewood.util import Floats, Int32s
from galewood.wood import BARE_EXPONENT


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A bar along +y, clamped at y = 0, with all inputs of `build_model`.

    `area_m2` and `second_moment_m4` (bending in x) belong to the base polygon; `tip` lists the vertices at
    the free end.
    """

    vertices_m: Floats
    tets: Int32s
    radius_ratio: Floats
    tet_fibre: Floats
    mass_kg: Floats
    drag_area_m2: Floats
    fixed: Int32s
    tip: Int32s
    area_m2: float
    second_moment_m4: float

    @property
    def tet_branch(self) -> Int32s:
        """(m,) zeros: a bar is one limb."""
        return np.zeros(len(self.tets), np.int32)

    @property
    def tet_radius_m(self) -> Floats:
        """(m,) radius of the circle with the area of the base, m."""
        return np.full(len(self.tets), np.sqrt(self.area_m2 / np.pi))

    @property
    def leaf_mass_kg(self) -> Floats:
        """Empty: a bar has no leaves."""
        return np.zeros(0)

    @property
    def exposed_area_m2(self) -> None:
        """None: without leaves there is no shelter."""

    @property
    def wind_profile(self) -> None:
        """None: the wind is the same along the bar."""

    @property
    def streamlined_exponent(self) -> float:
        """That of bare wood."""
        return BARE_EXPONENT


def polygon_bar(
    *,
    sides: int,
    radius_m: float,
    length_m: float,
    layers: int,
    rings: int = 1,
    tip_radius_m: float | None = None,
) -> Bar:
    """A pole with a regular polygon as its section; with `tip_radius_m` it tapers linearly.

    `rings` = 1 has vertices only on the rim and, for more than four sides, at the centre.
    """
    section, triangles = _polygon(sides, rings)
    tip = radius_m if tip_radius_m is None else tip_radius_m
    heights = np.linspace(0, length_m, layers + 1)
    radii = radius_m + (tip - radius_m) * heights / length_m
    vertices = np.stack(
        [np.column_stack([r * section[:, 0], np.full(len(section), y), r * section[:, 1]])
         for r, y in zip(radii, heights, strict=True)]
    ).reshape(-1, 3)  # fmt: skip
    return _bar(
        vertices, _extrude(triangles, len(section), layers), len(section), radius_m, section, triangles
    )


def _polygon(sides: int, rings: int) -> tuple[Floats, Int32s]:
    """Unit polygon: points (k, 2) and triangles, a fan around the centre and `rings` − 1 rings around it."""
    angle = 2 * np.pi * np.arange(sides) / sides
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    if rings == 1 and sides <= 4:
        return rim, np.array([[0, k, k + 1] for k in range(1, sides - 1)], np.int32)
    points = [np.zeros((1, 2))] + [rim * (k + 1) / rings for k in range(rings)]
    triangles = [[0, 1 + k, 1 + (k + 1) % sides] for k in range(sides)]
    for ring in range(1, rings):
        inner, outer = 1 + (ring - 1) * sides, 1 + ring * sides
        for k in range(sides):
            after = (k + 1) % sides
            triangles += [[inner + k, outer + k, outer + after], [inner + k, outer + after, inner + after]]
    return np.concatenate(points), np.array(triangles, np.int32)


def _extrude(triangles: Int32s, points: int, layers: int) -> Int32s:
    """Three tets per triangle and layer; the diagonals follow vertex numbers, so that neighbours match."""
    tets: list[list[int]] = []
    for layer in range(layers):
        for triangle in triangles:
            a, b, c = sorted(int(t) for t in triangle)
            low, high = [v + layer * points for v in (a, b, c)], [v + (layer + 1) * points for v in (a, b, c)]
            tets += [[*low, high[2]], [low[0], low[1], high[1], high[2]], [low[0], *high]]
    return np.array(tets, np.int32)


def box_bar(*, size_m: tuple[float, float, float], cells: tuple[int, int, int]) -> Bar:
    """A box along +y with six tets per cell (Kuhn subdivision)."""
    axes = [np.linspace(-s / 2, s / 2, n + 1) for s, n in zip(size_m, cells, strict=True)]
    axes[1] = axes[1] + size_m[1] / 2
    y, x, z = np.meshgrid(axes[1], axes[0], axes[2], indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    strides = np.array([cells[2] + 1, (cells[0] + 1) * (cells[2] + 1), 1])
    corners = np.stack(np.meshgrid(*(np.arange(n) for n in cells), indexing="ij"), axis=-1).reshape(-1, 3)
    base = corners @ strides
    tets = [
        np.column_stack([base, base + strides[p], base + strides[p] + strides[q], base + strides.sum()])
        for p, q, _ in permutations(range(3))
    ]
    per_layer = int(strides[1])
    bar = _bar(
        vertices, np.concatenate(tets).astype(np.int32), per_layer, 1.0, np.zeros((0, 2)), np.zeros((0, 3))
    )
    width, depth = size_m[0], size_m[2]
    return replace(bar, area_m2=width * depth, second_moment_m4=depth * width**3 / 12)


def _bar(
    vertices: Floats,
    tets: Int32s,
    per_layer: int,
    radius: float,
    section: Floats,
    triangles: NDArray[np.generic],
) -> Bar:
    edges = vertices[tets[:, 1:]] - vertices[tets[:, :1]]
    negative = np.linalg.det(edges) < 0
    tets[negative] = tets[negative][:, [1, 0, 2, 3]]
    area, moment = _section_moments(radius * section, triangles.astype(np.int32))
    count = len(vertices)
    return Bar(
        vertices_m=vertices,
        tets=tets,
        radius_ratio=np.ones(len(tets)),
        tet_fibre=np.tile([0.0, 1.0, 0.0], (len(tets), 1)),
        mass_kg=np.zeros(count),
        drag_area_m2=np.zeros(count),
        fixed=np.arange(per_layer, dtype=np.int32),
        tip=np.arange(count - per_layer, count, dtype=np.int32),
        area_m2=area,
        second_moment_m4=moment,
    )


def _section_moments(points: Floats, triangles: Int32s) -> tuple[float, float]:
    """Area, m², and ∫x² about the centroid, m⁴; exact, as edge midpoints integrate quadratics exactly."""
    if not len(triangles):
        return 0.0, 0.0
    p = points[triangles]
    e, f = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    areas = np.abs(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]) / 2
    middles = (p + np.roll(p, 1, axis=1))[:, :, 0] / 2
    centre = (areas * p[:, :, 0].mean(axis=1)).sum() / areas.sum()
    return float(areas.sum()), float((areas * ((middles - centre) ** 2).mean(axis=1)).sum())
