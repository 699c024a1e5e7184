"""Generated tree files in the styles that people upload, with the true label of every face.

The shapes, colours and proportions are drawn at random; nothing here knows the thresholds of the classifier.
"""

import io
import json
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from PIL import Image

from tests.precompute.labelled_shapes import (
    Rng,
    Shape,
    ball,
    box,
    cards,
    cone,
    crossed,
    curve,
    frond,
    in_ball,
    leaves,
    terrain,
    together,
    tube,
)

WOOD, LEAVES, OTHER = "wood", "leaves", "other"


@dataclass
class Look:
    """How a part is drawn; everything left out is missing in the file."""

    factor: tuple[float, ...] | None = None  # linear
    image: bytes | None = None
    alpha_mode: str | None = None
    vertex_colour: tuple[float, ...] | None = None  # linear
    cell: tuple[float, ...] | None = None  # part of the image: u0, v0, u1, v1
    noise: float = 0.0  # of the vertex colours


@dataclass
class Part:
    """Shapes with one name and one look, and their label."""

    name: str
    label: str
    shape: Shape
    look: Look = field(default_factory=Look)
    tree: int = 1


@dataclass
class LabelledFile:
    """A file, and the centre and label of each of its faces."""

    style: str
    filename: str
    data: bytes
    centres: np.ndarray
    labels: np.ndarray
    up: str


# --- looks ------------------------------------------------------------------------------------------------


def png(pixels: np.ndarray) -> bytes:
    out = io.BytesIO()
    Image.fromarray(pixels.astype(np.uint8)).save(out, "PNG")
    return out.getvalue()


def bark_pixels(rng: Rng, size=32, base=(96, 72, 50)) -> np.ndarray:
    streaks = rng.normal(0, 14, (1, size, 1)) + rng.normal(0, 8, (size, size, 1))
    rgb = np.clip(np.array(base) + streaks, 0, 255)
    return np.concatenate([rgb, np.full((size, size, 1), 255)], axis=2)


def leaf_pixels(rng: Rng, size=32, base=(70, 120, 40)) -> np.ndarray:
    y, x = np.mgrid[0:size, 0:size] / size - 0.5
    alpha = ((np.abs(x) * 1.6 + np.abs(y) < 0.5) * 255)[:, :, None]
    rgb = np.clip(np.array(base) + rng.normal(0, 12, (size, size, 1)), 0, 255)
    return np.concatenate([np.broadcast_to(rgb, (size, size, 3)), alpha], axis=2)


def palette(colours) -> bytes:
    """A palette of four by four cells, as low-poly packs share."""
    rows = [np.array(c) for c in colours]
    grid = np.array([rows[k % len(rows)] for k in range(16)]).reshape(4, 4, 3)
    return png(np.repeat(np.repeat(grid, 8, axis=0), 8, axis=1))


def palette_cell(k: int):
    return (k % 4 / 4 + 0.1, k // 4 / 4 + 0.1, k % 4 / 4 + 0.14, k // 4 / 4 + 0.14)


def atlas(rng: Rng) -> bytes:
    """Bark in the left half, leaves with alpha in the right half."""
    return png(np.concatenate([bark_pixels(rng), leaf_pixels(rng)], axis=1))


BARK_HALF, LEAF_HALF = (0.02, 0.0, 0.48, 1.0), (0.5, 0.0, 1.0, 1.0)


def linear(rgb):
    return tuple(float((c / 255) ** 2.2) for c in rgb)


def green(rng: Rng):
    return tuple(int(c) for c in (rng.integers(30, 120), rng.integers(125, 190), rng.integers(20, 70)))


def brown(rng: Rng):
    r = int(rng.integers(70, 140))
    return (r, int(r * rng.uniform(0.6, 0.8)), int(r * rng.uniform(0.35, 0.55)))


# --- parts of trees ---------------------------------------------------------------------------------------


def trunk(rng: Rng, height, radius=None, sides=None, closed=True, at=(0, 0, 0)) -> Shape:
    radius = radius or height * rng.uniform(0.03, 0.06)
    path = curve(
        rng,
        at,
        np.asarray(at) + np.array([rng.normal(0, 0.03 * height), height, rng.normal(0, 0.03 * height)]),
        0.03,
    )
    return tube(
        path, np.linspace(radius, 0.55 * radius, len(path)), sides or int(rng.integers(6, 13)), closed
    )


def branches(rng: Rng, height, count, reach, radius, at=(0, 0, 0), first=0.45) -> list[Shape]:
    found = []
    for k in range(count):
        a, y = k * 2.4 + rng.uniform(0, 1), height * rng.uniform(first, 0.95)
        length = reach * rng.uniform(0.7, 1.1)
        end = np.array([np.cos(a) * length, y + length * rng.uniform(0.3, 0.9), np.sin(a) * length]) + at
        found.append(
            tube(
                curve(rng, np.array([0, y, 0]) + at, end, 0.06),
                np.linspace(radius, 0.3 * radius, 6),
                int(rng.integers(5, 8)),
            )
        )
    return found


def blobs(rng: Rng, centre, size, count, level=2) -> list[Shape]:
    points = in_ball(rng, centre, (0.6 * size, 0.45 * size, 0.6 * size), count)
    return [ball(rng, p, size * rng.uniform(0.4, 0.65) * np.array([1, 0.8, 1]), 0.12, level) for p in points]


def broadleaf(rng: Rng, height=None, at=(0, 0, 0)):
    """Wood and crown centre, crown size of a branched tree."""
    height = height or rng.uniform(4, 12)
    stem = 0.6 * height
    wood = [
        trunk(rng, stem, at=at),
        *branches(rng, stem, int(rng.integers(4, 8)), 0.3 * height, 0.018 * height, at),
    ]
    return wood, np.array([0, 0.72 * height, 0]) + at, 0.3 * height


# --- styles -----------------------------------------------------------------------------------------------

Style = Callable[[Rng], list[Part]]
STYLES: dict[str, tuple[Style, str, str]] = {}


def style(kind="glb", up="y"):
    """Registers a style with its file format and the up axis of its export."""

    def keep(make: Style) -> Style:
        STYLES[make.__name__] = (make, kind, up)
        return make

    return keep


def lowpoly(rng: Rng, wood_look: Look, leaf_look: Look, names=("", ""), height=None, at=(0, 0, 0), tree=1):
    wood, middle, size = broadleaf(rng, height, at)
    crown = blobs(rng, middle, size, int(rng.integers(3, 9)))
    return [
        Part(names[0], WOOD, together(*wood), wood_look, tree),
        Part(names[1], LEAVES, together(*crown), leaf_look, tree),
    ]


@style()
def atlas_palette(rng):
    image = palette([brown(rng), green(rng), (200, 60, 40), green(rng)])
    return lowpoly(
        rng,
        Look(image=image, cell=palette_cell(0)),
        Look(image=image, cell=palette_cell(1)),
        ("pack", "pack"),
    )


@style()
def atlas_palette_two_greens(rng):
    image = palette([brown(rng), green(rng), green(rng), (90, 90, 95)])
    wood, middle, size = broadleaf(rng)
    crown = blobs(rng, middle, size, 6)
    looks = [Look(image=image, cell=palette_cell(k)) for k in (0, 1, 2)]
    return [
        Part("a", WOOD, together(*wood), looks[0]),
        Part("a", LEAVES, together(*crown[:3]), looks[1]),
        Part("a", LEAVES, together(*crown[3:]), looks[2]),
    ]


@style()
def atlas_photo(rng):
    image = atlas(rng)
    wood, middle, size = broadleaf(rng)
    leaf = cards(rng, in_ball(rng, middle, size, 160), 0.12 * size)
    return [
        Part("m", WOOD, together(*wood), Look(image=image, alpha_mode="MASK", cell=BARK_HALF)),
        Part("m", LEAVES, leaf, Look(image=image, alpha_mode="MASK", cell=LEAF_HALF)),
    ]


@style()
def opaque_alpha(rng):
    wood, middle, size = broadleaf(rng)
    leaf = crossed(rng, in_ball(rng, middle, size, 80), 0.25 * size)
    return [
        Part("Material.001", WOOD, together(*wood), Look(image=png(bark_pixels(rng)), alpha_mode="OPAQUE")),
        Part("Material.002", LEAVES, leaf, Look(image=png(leaf_pixels(rng)), alpha_mode="OPAQUE")),
    ]


@style()
def blend_alpha_autumn(rng):
    wood, middle, size = broadleaf(rng)
    leaf = cards(rng, in_ball(rng, middle, size, 200), 0.2 * size)
    image = png(leaf_pixels(rng, base=(200, 120, 30)))
    return [
        Part("", WOOD, together(*wood), Look(image=png(bark_pixels(rng)))),
        Part("", LEAVES, leaf, Look(image=image, alpha_mode="BLEND")),
    ]


@style()
def vertex_colours(rng):
    return lowpoly(
        rng, Look(vertex_colour=linear(brown(rng))), Look(vertex_colour=linear(green(rng))), ("v", "v")
    )


@style()
def vertex_colours_welded(rng):
    """Trunk and crown are one connected surface; only the colours tell them apart."""
    height = rng.uniform(4, 9)
    stem = trunk(rng, 0.5 * height, sides=10, closed=False)
    rings = [(0.5, 0.0), (0.52, 0.25), (0.68, 0.34), (0.85, 0.25), (0.97, 0.08)]
    path = np.array([[0, y * height, 0] for y, _ in rings])
    crown = tube(path, np.array([max(r, 0.02) * height for _, r in rings]), 10)
    crown.vertices[:10] = stem.vertices[-10:]
    return [
        Part("v", WOOD, stem, Look(vertex_colour=linear(brown(rng)))),
        Part("v", LEAVES, crown, Look(vertex_colour=linear(green(rng)))),
    ]


@style()
def factor_colours(rng):
    return lowpoly(rng, Look(factor=linear(brown(rng))), Look(factor=linear(green(rng))), ("Mat1", "Mat2"))


@style()
def autumn_crown(rng):
    colour = (int(rng.integers(180, 230)), int(rng.integers(60, 130)), 30)
    return lowpoly(rng, Look(factor=linear(brown(rng))), Look(factor=linear(colour)), ("a", "b"))


@style()
def blossom_crown(rng):
    return lowpoly(rng, Look(factor=linear(brown(rng))), Look(factor=linear((240, 170, 190))), ("a", "b"))


@style()
def snowy_crown(rng):
    return lowpoly(rng, Look(factor=linear(brown(rng))), Look(factor=linear((235, 240, 245))), ("a", "b"))


@style()
def purple_fantasy(rng):
    return lowpoly(rng, Look(factor=linear((70, 60, 90))), Look(factor=linear((150, 60, 190))), ("a", "b"))


@style()
def white_birch(rng):
    return lowpoly(rng, Look(factor=linear((230, 228, 220))), Look(factor=linear(green(rng))), ("x", "y"))


@style("obj")
def cards_without_materials(rng):
    wood, middle, size = broadleaf(rng)
    return [
        Part("", WOOD, together(*wood)),
        Part("", LEAVES, cards(rng, in_ball(rng, middle, size, 200), 0.1 * size)),
    ]


@style("ply", "z")
def crossed_cards_z_up(rng):
    wood, middle, size = broadleaf(rng)
    return [
        Part("", WOOD, together(*wood)),
        Part("", LEAVES, crossed(rng, in_ball(rng, middle, size, 90), 0.2 * size)),
    ]


@style("obj")
def modelled_leaves(rng):
    wood, middle, size = broadleaf(rng)
    return [
        Part("", WOOD, together(*wood)),
        Part("", LEAVES, leaves(rng, in_ball(rng, middle, size, 120), 0.15 * size)),
    ]


@style("ply")
def merged_without_materials(rng):
    return lowpoly(rng, Look(), Look())


def closed_crown(rng, wood=None, leaf=None, slim=1.0):
    height = rng.uniform(4, 10)
    radius = 0.3 * height * slim
    crown = ball(rng, (0, 0.62 * height, 0), (radius, 0.38 * height, radius), 0.06, 3)
    return [
        Part("m1", WOOD, trunk(rng, 0.45 * height), wood or Look()),
        Part("m2", LEAVES, crown, leaf or Look()),
    ]


@style()
def closed_crown_coloured(rng):
    return closed_crown(rng, Look(factor=linear(brown(rng))), Look(factor=linear(green(rng))))


@style("obj")
def closed_crown_plain(rng):
    return closed_crown(rng)


@style("stl", "z")
def closed_crown_stl_z_up(rng):
    return closed_crown(rng)


@style("obj")
def columnar_crown_plain(rng):
    return closed_crown(rng, slim=0.5)


@style("obj", "z")
def stub_trunk_ball(rng):
    """A stylised tree: a short thick trunk under one ball."""
    height = rng.uniform(2, 5)
    r = 0.38 * height
    stem = tube(
        [(0, 0, 0), (0, 0.15 * height, 0), (0, 0.35 * height, 0)],
        (0.09 * height, 0.07 * height, 0.06 * height),
        6,
    )
    return [Part("", WOOD, stem), Part("", LEAVES, ball(rng, (0, 0.62 * height, 0), r, 0.1, 2))]


def conifer(rng, gap, wood=None, leaf=None, name=("", "")):
    height, count = rng.uniform(4, 12), int(rng.integers(3, 7))
    step = 0.8 * height / count
    tiers = [
        cone(
            (0, 0.2 * height + k * step, 0),
            0.28 * height * (1 - 0.8 * k / count),
            step * (1 - gap),
            int(rng.integers(6, 12)),
        )
        for k in range(count)
    ]
    stem = trunk(rng, 0.2 * height if gap > 0 else 0.35 * height, radius=0.04 * height)
    return [
        Part(name[0], WOOD, stem, wood or Look()),
        Part(name[1], LEAVES, together(*tiers), leaf or Look()),
    ]


@style()
def conifer_tiers(rng):
    return conifer(rng, -0.3, Look(factor=linear(brown(rng))), Look(factor=linear(green(rng))), ("a", "b"))


@style()
def conifer_spaced_tiers(rng):
    return conifer(rng, 0.25, Look(factor=linear(brown(rng))), Look(factor=linear(green(rng))), ("a", "b"))


@style("obj")
def conifer_spaced_tiers_plain(rng):
    return conifer(rng, 0.2)


def palm(rng, thick, wood=None, leaf=None):
    height = rng.uniform(5, 12)
    path = curve(rng, (0, 0, 0), (rng.normal(0, 0.08 * height), height, 0), 0.06, 9)
    count = int(rng.integers(7, 12))
    fronds = [
        frond(
            rng,
            path[-1],
            k * 2 * np.pi / count,
            0.35 * height * rng.uniform(0.8, 1.1),
            0.08 * height,
            thick * height,
        )
        for k in range(count)
    ]
    stem = tube(path, np.linspace(0.035, 0.025, 9) * height, 8)
    return [Part("p1", WOOD, stem, wood or Look()), Part("p2", LEAVES, together(*fronds), leaf or Look())]


@style()
def palm_coloured(rng):
    return palm(rng, 0.0, Look(factor=linear(brown(rng))), Look(factor=linear(green(rng))))


@style("obj")
def palm_plain(rng):
    return palm(rng, 0.0)


@style()
def palm_thick_fronds(rng):
    return palm(rng, 0.006, Look(factor=linear((150, 120, 85))), Look(factor=linear(green(rng))))


@style("ply")
def palm_thick_fronds_plain(rng):
    return palm(rng, 0.005)


def stems(rng, height, count):
    return [
        tube(
            curve(
                rng,
                (0.04 * height * np.cos(a), 0, 0.04 * height * np.sin(a)),
                (0.35 * height * np.cos(a), 0.75 * height, 0.35 * height * np.sin(a)),
                0.05,
            ),
            np.linspace(0.025, 0.01, 6) * height,
            6,
        )
        for a in np.arange(count) * 2 * np.pi / count
    ]


@style()
def bush_balls(rng):
    height = rng.uniform(1.5, 3)
    crown = blobs(rng, (0, 0.6 * height, 0), 0.55 * height, 6)
    return [
        Part("b1", WOOD, together(*stems(rng, height, 5)), Look(factor=linear(brown(rng)))),
        Part("b2", LEAVES, together(*crown), Look(factor=linear(green(rng)))),
    ]


@style("obj")
def bush_cards(rng):
    height = rng.uniform(1.5, 3)
    points = in_ball(rng, (0, 0.55 * height, 0), 0.45 * height, 150)
    return [
        Part("", WOOD, together(*stems(rng, height, 6))),
        Part("", LEAVES, cards(rng, points, 0.12 * height)),
    ]


@style("obj", "z")
def orchard_cylinders(rng):
    """Separate closed cylinders, as quantitative structure models are exported, with round fruit."""
    height = rng.uniform(2, 4)
    wood, ends = [], []
    for k in range(9):
        path = curve(
            rng,
            (0, 0.1 * k, 0),
            (0.4 * height * np.cos(2.4 * k), height * rng.uniform(0.6, 1), 0.4 * height * np.sin(2.4 * k)),
            0.08,
            7,
        )
        path[0] = (0, 0, 0) if k == 0 else path[0]
        wood += [tube(path[i : i + 2], 0.02 * height * (1 - 0.11 * i), 8) for i in range(6)]
        ends.append(path[-2])
    wood.append(tube([(0, 0, 0), (0, 0.3 * height, 0)], 0.035 * height, 8))
    fruit = [ball(rng, e - (0, 0.05 * height, 0), 0.018 * height, 0.0, 2) for e in ends]
    return [Part("", WOOD, together(*wood)), Part("", LEAVES, together(*fruit))]


def bare(rng):
    wood, _, size = broadleaf(rng)
    height = size / 0.3
    return [
        Part(
            "", WOOD, together(*wood, *branches(rng, 0.6 * height, 6, 0.2 * height, 0.01 * height, first=0.6))
        )
    ]


@style("stl")
def dead_tree(rng):
    return bare(rng)


@style("stl", "z")
def dead_tree_z_up(rng):
    return bare(rng)


@style("obj", "x")
def dead_tree_x_up(rng):
    return bare(rng)


def colours(rng):
    return Look(factor=linear(brown(rng))), Look(factor=linear(green(rng)))


@style()
def ground_plane(rng):
    parts = lowpoly(rng, *colours(rng), ("w", "l"))
    ground = terrain(rng, rng.uniform(3, 8), 0.0, 1)
    return [*parts, Part("g", OTHER, ground, Look(factor=linear((90, 140, 60))))]


@style("obj")
def bumpy_ground_plain(rng):
    return [*lowpoly(rng, Look(), Look(), height=8), Part("", OTHER, terrain(rng, 6, 0.15))]


@style()
def island(rng):
    parts = lowpoly(rng, *colours(rng), ("w", "l"), height=5)
    under = cone((0, 0, 0), 2.2, -2.5, 9)
    top = tube([(0, -0.1, 0), (0, 0.05, 0)], 2.25, 9)
    return [
        *parts,
        Part("s", OTHER, under, Look(factor=linear((110, 90, 70)))),
        Part("t", OTHER, top, Look(factor=linear((100, 160, 60)))),
    ]


@style()
def pot(rng):
    height = rng.uniform(1.5, 3)
    parts = lowpoly(rng, *colours(rng), ("w", "l"), height=height)
    r = 0.13 * height
    vessel = tube([(0, -0.12 * height, 0), (0, 0, 0), (0, 0.1 * height, 0)], (0.7 * r, 0.9 * r, r), 12)
    return [*parts, Part("c", OTHER, vessel, Look(factor=linear((180, 90, 60))))]


@style("obj")
def pot_plain(rng):
    parts = lowpoly(rng, Look(), Look(), height=2)
    vessel = tube([(0, -0.25, 0), (0, 0, 0), (0, 0.2, 0)], (0.2, 0.26, 0.3), 12)
    return [*parts, Part("", OTHER, vessel)]


def rocks_around(rng, count, height):
    return together(
        *[
            ball(
                rng, (np.cos(a) * d, 0.02 * height, np.sin(a) * d), height * rng.uniform(0.03, 0.07), 0.25, 2
            )
            for a, d in zip(rng.uniform(0, 6.28, count), height * rng.uniform(0.15, 0.5, count), strict=True)
        ]
    )


@style()
def rocks(rng):
    parts = lowpoly(rng, *colours(rng), ("w", "l"), height=6)
    return [*parts, Part("r", OTHER, rocks_around(rng, 6, 6), Look(factor=linear((125, 122, 118))))]


@style("obj")
def rocks_plain(rng):
    return [*closed_crown(rng), Part("", OTHER, rocks_around(rng, 4, 6))]


def fence_beside(rng, x=1.9):
    posts = [box((x - 0.05, 0, z - 0.05), (x + 0.05, 1.0, z + 0.05)) for z in np.linspace(-2, 2, 6)]
    rails = [box((x - 0.02, y, -2.1), (x + 0.02, y + 0.1, 2.1)) for y in (0.4, 0.8)]
    return together(*posts, *rails)


@style()
def fence(rng):
    parts = lowpoly(rng, *colours(rng), ("w", "l"), height=7)
    return [*parts, Part("f", OTHER, fence_beside(rng), Look(factor=linear((130, 95, 60))))]


@style("obj")
def fence_and_ground_plain(rng):
    return [
        *lowpoly(rng, Look(), Look(), height=7),
        Part("", OTHER, together(fence_beside(rng), terrain(rng, 4, 0.05))),
    ]


@style()
def grass_tufts(rng):
    parts = lowpoly(rng, *colours(rng), ("w", "l"), height=7)
    spots = np.column_stack([rng.uniform(-2, 2, 60), np.zeros(60), rng.uniform(-2, 2, 60)])
    return [*parts, Part("q", OTHER, crossed(rng, spots, 0.35), Look(factor=linear((80, 150, 50))))]


def several(rng, places, heights, looks):
    found = []
    order = np.argsort(-np.array(heights))
    for number, k in enumerate(order, 1):
        made = lowpoly(
            rng,
            looks[0],
            looks[1],
            ("w", "l"),
            height=heights[k],
            at=(places[k][0], 0, places[k][1]),
            tree=number,
        )
        found += [Part(p.name, p.label if number == 1 else OTHER, p.shape, p.look, number) for p in made]
    return found


@style()
def two_trees(rng):
    return several(rng, [(0, 0), (8, 1)], [8, 6], colours(rng))


@style("obj")
def three_trees_plain(rng):
    return several(rng, [(0, 0), (9, 0), (18, 0)], [6.0, 8.0, 7.0], (Look(), Look()))


@style()
def touching_crowns(rng):
    return several(rng, [(0, 0), (4.6, 0.3)], [8, 7], colours(rng))


def named(rng, wood, leaf):
    """Names without colours: crowns of cards."""
    shapes, middle, size = broadleaf(rng)
    return [
        Part(wood, WOOD, together(*shapes)),
        Part(leaf, LEAVES, cards(rng, in_ball(rng, middle, size, 150), 0.1 * size)),
    ]


@style()
def names_german(rng):
    return named(rng, "Rinde", "Blätter")


@style()
def names_russian(rng):
    return named(rng, "Кора", "Листья")


@style()
def names_chinese(rng):
    return named(rng, "树皮", "树叶")


@style()
def names_french(rng):
    return named(rng, "écorce", "feuillage")


@style()
def names_swapped(rng):
    """Materials that are named wrongly, but coloured rightly."""
    return lowpoly(rng, *colours(rng), ("leaf_mat", "bark_mat"))


@style()
def one_name_for_all(rng):
    return lowpoly(
        rng,
        Look(factor=linear(brown(rng))),
        Look(factor=linear(green(rng))),
        ("OakWood_LOD0", "OakWood_LOD0"),
    )


@style("glb", "z")
def glb_exported_z_up(rng):
    return lowpoly(rng, *colours(rng), ("w", "l"))


@style()
def willow_strips(rng):
    wood, middle, size = broadleaf(rng)
    tops = in_ball(rng, middle, size, 70)
    strips = [frond(rng, p, rng.uniform(0, 6.28), 0.0 + 0.5 * size, 0.05 * size, points=5) for p in tops]
    return [
        Part("1", WOOD, together(*wood), Look(factor=linear(brown(rng)))),
        Part("2", LEAVES, together(*strips), Look(factor=linear(green(rng)))),
    ]


@style("obj")
def multi_stem(rng):
    height = rng.uniform(4, 7)
    crown = blobs(rng, (0, 0.75 * height, 0), 0.4 * height, 7)
    return [Part("", WOOD, together(*stems(rng, height, 3))), Part("", LEAVES, together(*crown))]


@style("ply")
def thin_open_branches(rng):
    """Strongly bent, open branches of few sides that taper to a point, with cards."""
    height = rng.uniform(5, 15)
    wood = [trunk(rng, height, closed=False, sides=5)]
    tips = []
    for k in range(24):
        a, y, reach = k * 2.4, height * (0.2 + 0.03 * k), height * (0.3 - 0.008 * k)
        end = np.array([np.cos(a) * reach, y + reach * rng.uniform(-0.2, 0.6), np.sin(a) * reach])
        radii = np.linspace(0.008, 0.001 if k % 2 else 0.004, 7) * height
        wood.append(tube(curve(rng, (0, y, 0), end, 0.12, 7), radii, int(rng.integers(4, 7)), closed=False))
        tips += [end, 0.6 * end + 0.4 * np.array([0, y, 0])]
    return [
        Part("", WOOD, together(*wood)),
        Part("", LEAVES, cards(rng, np.repeat(tips, 6, axis=0), 0.05 * height)),
    ]


def scan(rng, crown: bool):
    """One connected surface of ground, trunk and crown, as photogrammetry gives it, with a bumpy surface."""
    height, sides = rng.uniform(5, 12), 48
    foot = 0.05 * height
    rings = [(r, 0.01 * height * rng.normal()) for r in np.linspace(0.6 * height, 1.6 * foot, 24)]
    rings += [(1.2 * foot, 0.03 * height), (foot, 0.08 * height)]
    first_wood = len(rings) - 1
    rings += [(foot * (1 - 0.02 * k), (0.1 + 0.02 * k) * height) for k in range(16)]
    first_crown = len(rings) - 1
    if crown:
        rings += [
            (0.28 * height * np.sin(a) ** 0.6, (0.7 - 0.3 * np.cos(a)) * height)
            for a in np.linspace(0.4, 3.1, 30)
        ]
    else:
        rings += [(foot * 0.6 * (1 - 0.05 * k), (0.42 + 0.028 * k) * height) for k in range(19)]
    angle = np.arange(sides) * 2 * np.pi / sides
    circle = np.column_stack([np.cos(angle), np.zeros(sides), np.sin(angle)])
    vertices = np.concatenate([circle * r + (0, y, 0) for r, y in rings])
    vertices += rng.normal(0, 0.004 * height, vertices.shape)
    k, i = np.meshgrid(np.arange(sides), np.arange(len(rings) - 1))
    a, b = (i * sides + k).ravel(), (i * sides + (k + 1) % sides).ravel()
    faces = np.concatenate([np.column_stack([a, a + sides, b]), np.column_stack([b, a + sides, b + sides])])
    ring = np.concatenate([i.ravel(), i.ravel()])
    branch = [] if crown else branches(rng, 0.9 * height, 9, 0.3 * height, 0.02 * height)
    looks = [
        Look(vertex_colour=linear(c), noise=0.35) if crown else Look()
        for c in ((120, 110, 70), (95, 75, 55), (70, 120, 45))
    ]
    spans = (
        (0, first_wood, OTHER),
        (first_wood, first_crown, WOOD),
        (first_crown, len(rings), LEAVES if crown else WOOD),
    )
    parts = [
        Part("s", label, Shape(vertices, faces[(ring >= low) & (ring < high)].astype(np.int32)), look)
        for (low, high, label), look in zip(spans, looks, strict=True)
    ]
    return parts + ([Part("s", WOOD, together(*branch))] if branch else [])


@style()
def scan_with_ground_coloured(rng):
    return scan(rng, crown=True)


@style("ply", "z")
def scan_with_ground_bare(rng):
    return scan(rng, crown=False)


@style()
def bonsai_in_pot(rng):
    stem = tube(curve(rng, (0, 0, 0), (0.12, 0.35, 0.03), 0.12, 9), np.linspace(0.04, 0.015, 9), 9)
    arms = [
        tube(curve(rng, (0.05, y, 0), (x, y + 0.05, z), 0.05), np.linspace(0.014, 0.006, 6), 6)
        for y, x, z in ((0.2, -0.14, 0.05), (0.27, 0.2, -0.06))
    ]
    pads = [
        ball(rng, c, (0.13, 0.05, 0.11), 0.1, 2)
        for c in ((0.12, 0.4, 0.03), (-0.15, 0.28, 0.05), (0.22, 0.35, -0.06))
    ]
    tray = box((-0.2, -0.1, -0.14), (0.2, 0.01, 0.14))
    looks = colours(rng)
    return [
        Part("1", WOOD, together(stem, *arms).moved((0, 0, 0)), looks[0]),
        Part("2", LEAVES, together(*pads), looks[1]),
        Part("3", OTHER, tray, Look(factor=linear((60, 70, 110)))),
    ]


@style("ply", "x")
def conifer_x_up(rng):
    return conifer(rng, -0.3)


def mixed(rng):
    """Any wood with any crown, look and surroundings."""
    height = rng.uniform(2, 14)
    middle, size = np.array([0, 0.7 * height, 0]), 0.3 * height
    wood = rng.choice(["branched", "trunk", "stems"])
    if wood == "branched":
        shapes, middle, size = broadleaf(rng, height)
    elif wood == "trunk":
        shapes = [trunk(rng, rng.uniform(0.45, 0.7) * height)]
    else:
        shapes = stems(rng, height, int(rng.integers(3, 7)))
    crown = rng.choice(["blobs", "cards", "crossed", "leaves", "ball", "cones"])
    points = in_ball(rng, middle, size, int(rng.integers(60, 200)))
    foliage = {
        "blobs": lambda: together(*blobs(rng, middle, size, int(rng.integers(3, 9)))),
        "cards": lambda: cards(rng, points, size * rng.uniform(0.1, 0.3)),
        "crossed": lambda: crossed(rng, points, size * rng.uniform(0.15, 0.35)),
        "leaves": lambda: leaves(rng, points, size * rng.uniform(0.1, 0.25)),
        "ball": lambda: ball(rng, middle, size * np.array([1, rng.uniform(0.8, 1.2), 1]), 0.08, 3),
        "cones": lambda: together(
            *[cone((0, (0.3 + 0.2 * k) * height, 0), (1.1 - 0.3 * k) * size, 0.3 * height) for k in range(3)]
        ),
    }[str(crown)]()
    scheme = rng.choice(["none", "factor", "palette", "vertex"])
    bark = brown(rng)
    leaf = green(rng) if rng.random() < 0.7 else (200, int(rng.integers(60, 140)), 40)
    stone = (120, 118, 112)
    image = palette([bark, leaf, stone])
    looks = {
        "none": (Look(), Look(), Look()),
        "factor": tuple(Look(factor=linear(c)) for c in (bark, leaf, stone)),
        "palette": tuple(Look(image=image, cell=palette_cell(k)) for k in range(3)),
        "vertex": tuple(Look(vertex_colour=linear(c)) for c in (bark, leaf, stone)),
    }[str(scheme)]
    parts = [Part("m", WOOD, together(*shapes), looks[0]), Part("m", LEAVES, foliage, looks[1])]
    around = rng.choice(["nothing", "nothing", "ground", "pot", "rocks", "fence"])
    if around == "ground":
        parts.append(Part("m", OTHER, terrain(rng, rng.uniform(0.5, 1.0) * height, 0.01 * height), looks[2]))
    elif around == "pot" and wood != "stems":
        r = 0.14 * height
        path = [(0, -0.1 * height, 0), (0, 0, 0), (0, 0.08 * height, 0)]
        parts.append(Part("m", OTHER, tube(path, (0.7 * r, 0.9 * r, r), 14), looks[2]))
    elif around == "rocks":
        parts.append(Part("m", OTHER, rocks_around(rng, 5, height), looks[2]))
    elif around == "fence":
        parts.append(Part("m", OTHER, fence_beside(rng, 0.45 * height), looks[2]))
    return parts


@style()
def mixed_glb(rng):
    return mixed(rng)


@style("obj")
def mixed_obj(rng):
    return mixed(rng)


@style("ply", "z")
def mixed_ply_z_up(rng):
    return mixed(rng)


@style("stl", "x")
def mixed_stl_x_up(rng):
    return mixed(rng)


# --- files ------------------------------------------------------------------------------------------------

ROTATIONS = {
    "y": np.eye(3),
    "z": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "x": np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
}


def labelled_file(name: str, seed: int) -> LabelledFile:
    """The file of a style, with random proportions."""
    make, kind, up = STYLES[name]
    rng = np.random.default_rng([seed, *name.encode()])
    parts = make(rng)
    for part in parts:
        part.shape = Shape(part.shape.vertices @ ROTATIONS[up].T, part.shape.faces, part.shape.uv)
    centres = np.concatenate([p.shape.vertices[p.shape.faces].mean(axis=1) for p in parts])
    labels = np.concatenate([np.full(len(p.shape.faces), p.label) for p in parts])
    write = {"glb": _glb, "obj": _obj, "ply": _ply, "stl": _stl}[kind]
    return LabelledFile(name, f"model.{kind}", write(parts), centres, labels, up)


def _obj(parts: list[Part]) -> bytes:
    lines, base = [], 1
    for part in parts:
        lines += [f"o {part.name}"] if part.name else []
        lines += ["v " + " ".join(f"{c:.7g}" for c in v) for v in part.shape.vertices]
        lines += ["f " + " ".join(str(i + base) for i in f) for f in part.shape.faces]
        base += len(part.shape.vertices)
    return "\n".join(lines).encode()


def _ply(parts: list[Part]) -> bytes:
    whole = together(*(p.shape for p in parts))
    coloured = any(p.look.vertex_colour for p in parts)
    bytes_rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n" if coloured else ""
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(whole.vertices)}\nproperty float x\n"
        f"property float y\nproperty float z\n{bytes_rgb}element face {len(whole.faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    face = np.zeros(len(whole.faces), dtype=[("n", "u1"), ("i", "<i4", 3)])
    face["n"], face["i"] = 3, whole.faces
    kinds = [("p", "<f4", 3)] + ([("c", "u1", 3)] if coloured else [])
    vertex = np.zeros(len(whole.vertices), dtype=kinds)
    vertex["p"] = whole.vertices
    if coloured:
        vertex["c"] = np.round(np.concatenate([_vertex_colours(p) for p in parts]) ** (1 / 2.2) * 255)
    return head.encode() + vertex.tobytes() + face.tobytes()


def _stl(parts: list[Part]) -> bytes:
    whole = together(*(p.shape for p in parts))
    record = np.zeros(len(whole.faces), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    record["v"] = whole.vertices[whole.faces]
    return b"x" * 80 + struct.pack("<I", len(record)) + record.tobytes()


def _glb(parts: list[Part]) -> bytes:
    """A GLB in which parts of the same name, image and alpha mode share one primitive."""
    blob = bytearray()
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": []}],
        "nodes": [],
        "meshes": [],
        "accessors": [],
        "bufferViews": [],
        "materials": [],
        "textures": [],
        "images": [],
    }

    def view(content: bytes) -> int:
        blob.extend(b"\0" * (-len(blob) % 4))
        document["bufferViews"].append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(content)})
        blob.extend(content)
        return len(document["bufferViews"]) - 1

    def accessor(rows, kind: str, component: int) -> int:
        document["accessors"].append(
            {"bufferView": view(rows.tobytes()), "componentType": component, "count": len(rows), "type": kind}
        )
        return len(document["accessors"]) - 1

    shared: dict[tuple[Any, ...], list[Part]] = {}
    for part in parts:
        look = part.look
        shared.setdefault((part.name, look.image, look.alpha_mode, look.factor), []).append(part)
    for (name, image, alpha_mode, factor), members in shared.items():
        whole = together(*(p.shape for p in members))
        attributes = {"POSITION": accessor(whole.vertices.astype("<f4"), "VEC3", 5126)}
        material: dict[str, Any] = {"name": name} if name else {}
        pbr: dict[str, Any] = {"metallicFactor": 0.0}
        if image is not None:
            uv = [_in_cell(p.shape.uv, p.look.cell, len(p.shape.vertices)) for p in members]
            attributes["TEXCOORD_0"] = accessor(np.concatenate(uv).astype("<f4"), "VEC2", 5126)
            document["images"].append({"bufferView": view(image), "mimeType": "image/png"})
            document["textures"].append({"source": len(document["images"]) - 1})
            pbr["baseColorTexture"] = {"index": len(document["textures"]) - 1}
        if factor is not None:
            pbr["baseColorFactor"] = [*factor, 1.0]
        if any(p.look.vertex_colour for p in members):
            colour = [_vertex_colours(p) for p in members]
            attributes["COLOR_0"] = accessor(np.concatenate(colour).astype("<f4"), "VEC3", 5126)
        material["pbrMetallicRoughness"] = pbr
        material |= {"alphaMode": alpha_mode} if alpha_mode else {}
        document["materials"].append(material)
        indices = accessor(whole.faces.astype("<u4").reshape(-1), "SCALAR", 5125)
        primitive = {"attributes": attributes, "indices": indices, "material": len(document["materials"]) - 1}
        document["meshes"].append({"primitives": [primitive]})
        document["nodes"].append({"mesh": len(document["meshes"]) - 1})
        document["scenes"][0]["nodes"].append(len(document["nodes"]) - 1)
    document["buffers"] = [{"byteLength": len(blob)}]
    text = json.dumps({k: v for k, v in document.items() if v != []}).encode()
    text += b" " * (-len(text) % 4)
    body = bytes(blob) + b"\0" * (-len(blob) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body))
    return (
        head
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(body), b"BIN\0")
        + body
    )


def _vertex_colours(part: Part) -> np.ndarray:
    rng = np.random.default_rng(len(part.shape.vertices))
    colours = np.tile(part.look.vertex_colour or (1.0, 1.0, 1.0), (len(part.shape.vertices), 1))
    return np.clip(colours * rng.uniform(1 - part.look.noise, 1 + part.look.noise, (len(colours), 1)), 0, 1)


def _in_cell(uv, cell, count):
    rows = uv if uv is not None else np.zeros((count, 2))
    if cell is None:
        return rows
    u0, v0, u1, v1 = cell
    return np.column_stack(
        [
            u0 + np.clip(rows[:, 0] % 1.0001, 0, 1) * (u1 - u0),
            v0 + np.clip(rows[:, 1] % 1.0001, 0, 1) * (v1 - v0),
        ]
    )
