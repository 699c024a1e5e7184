"""Styles of generated trees that differ in looks and crowns."""

import numpy as np

from tests.precompute.labelled_looks import (
    BARK_HALF,
    LEAF_HALF,
    LEAVES,
    WOOD,
    Look,
    Part,
    atlas,
    bark_pixels,
    brown,
    green,
    leaf_pixels,
    linear,
    palette,
    palette_cell,
    png,
)
from tests.precompute.labelled_parts import blobs, broadleaf, lowpoly, stems, style, trunk
from tests.precompute.labelled_shapes import (
    ball,
    cards,
    cone,
    crossed,
    curve,
    frond,
    in_ball,
    leaves,
    together,
    tube,
)


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
