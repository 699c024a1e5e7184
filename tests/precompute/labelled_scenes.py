"""Styles of generated files with surroundings or several trees, and of wood alone."""

import numpy as np

from tests.precompute.labelled_crowns import closed_crown
from tests.precompute.labelled_looks import LEAVES, OTHER, WOOD, Look, Part, colours, linear
from tests.precompute.labelled_parts import branches, broadleaf, fence_beside, lowpoly, rocks_around, style
from tests.precompute.labelled_shapes import ball, cone, crossed, curve, terrain, together, tube


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


@style()
def rocks(rng):
    parts = lowpoly(rng, *colours(rng), ("w", "l"), height=6)
    return [*parts, Part("r", OTHER, rocks_around(rng, 6, 6), Look(factor=linear((125, 122, 118))))]


@style("obj")
def rocks_plain(rng):
    return [*closed_crown(rng), Part("", OTHER, rocks_around(rng, 4, 6))]


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
