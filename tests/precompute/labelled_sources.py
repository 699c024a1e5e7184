"""Styles of generated files after their sources: foreign names, exporters, scans, random mixtures."""

import numpy as np

from tests.precompute.labelled_crowns import conifer
from tests.precompute.labelled_looks import (
    LEAVES,
    OTHER,
    WOOD,
    Look,
    Part,
    brown,
    colours,
    green,
    linear,
    palette,
    palette_cell,
)
from tests.precompute.labelled_parts import (
    blobs,
    branches,
    broadleaf,
    fence_beside,
    lowpoly,
    rocks_around,
    stems,
    style,
    trunk,
)
from tests.precompute.labelled_shapes import (
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
