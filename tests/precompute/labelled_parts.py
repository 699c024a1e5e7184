"""Parts that several styles of generated trees share, and the register of styles."""

from collections.abc import Callable

import numpy as np

from tests.precompute.labelled_looks import LEAVES, WOOD, Look, Part
from tests.precompute.labelled_shapes import Rng, Shape, ball, box, curve, in_ball, together, tube


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


def rocks_around(rng, count, height):
    return together(
        *[
            ball(
                rng, (np.cos(a) * d, 0.02 * height, np.sin(a) * d), height * rng.uniform(0.03, 0.07), 0.25, 2
            )
            for a, d in zip(rng.uniform(0, 6.28, count), height * rng.uniform(0.15, 0.5, count), strict=True)
        ]
    )


def fence_beside(rng, x=1.9):
    posts = [box((x - 0.05, 0, z - 0.05), (x + 0.05, 1.0, z + 0.05)) for z in np.linspace(-2, 2, 6)]
    rails = [box((x - 0.02, y, -2.1), (x + 0.02, y + 0.1, 2.1)) for y in (0.4, 0.8)]
    return together(*posts, *rails)


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
