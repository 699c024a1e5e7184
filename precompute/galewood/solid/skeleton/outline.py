"""Branches of a tree from the surface of its wood alone, within a second and before it is meshed.

The same level sets as of the solid (`extraction.py`), cut through the surface. Limbs that are separate closed
surfaces are connected to the limb that they grow from.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from galewood.solid.skeleton.bridges import bridges
from galewood.solid.skeleton.centre import branch_lines
from galewood.solid.skeleton.levels import (
    EDGES_OF_TRIANGLE,
    Sections,
    cut_sections,
    distance_along,
    inner_faces,
)
from galewood.solid.skeleton.roots import root_vertices
from galewood.solid.skeleton.tree import Tree, branches, linked_tree, section_radii, without_spurs
from galewood.util import Floats, Int32s, Ints

STEPS_PER_HEIGHT = 60
MIN_RADIUS_RATIO = 0.2
"""Smallest radius of a section, relative to the median of its branch."""
PINCHED_SHARE = 0.5
"""Two sections in a row, thinner than this share of those on both sides, are where two closed pieces of one
limb meet: the level cuts their caps. A beam so thin would bend like a hinge.
"""


@dataclass(frozen=True)
class Outline:
    """Branches of a tree: points_m (p, 3), parent (p,) with −1 at the root, radius_m (p,), branch (p,)."""

    points_m: Floats
    parent: Int32s
    radius_m: Floats
    branch: Int32s


@dataclass(frozen=True)
class TracedSurface:
    """An outline with what it was made from: sections, the linked tree, and the points that replace spurs."""

    outline: Outline
    sections: Sections
    tree: Tree
    replacement: Ints


def outline_of(vertices_m: Floats, faces: Ints) -> Outline:
    """The branches inside a closed surface of triangles; the y axis points up."""
    return trace(vertices_m, faces).outline


def trace(vertices_m: Floats, faces: Ints) -> TracedSurface:
    """The branches inside a closed surface, with what they were made from."""
    step_m = float(np.ptp(vertices_m[:, 1])) / STEPS_PER_HEIGHT
    roots = root_vertices(vertices_m, faces)
    edges = faces[:, EDGES_OF_TRIANGLE].reshape(-1, 2)
    pairs = np.concatenate([edges, bridges(vertices_m, faces)])
    distance = distance_along(vertices_m, pairs, roots)
    sections = cut_sections(vertices_m, faces, distance, inner_faces(faces), step_m)
    tree = linked_tree(sections, vertices_m, faces, distance, vertices_m[roots].mean(axis=0))
    tree, replacement = without_spurs(tree, section_radii(tree, tree.points_m))
    branch = branches(tree.points_m, tree.parent).astype(np.int32)
    radius = _smoothed(section_radii(tree, tree.points_m), branch)
    outline = Outline(tree.points_m, tree.parent.astype(np.int32), radius, branch)
    return TracedSurface(outline, sections, tree, replacement)


def _smoothed(radius_m: Floats, branch: Ints) -> Floats:
    """Running median along each branch: a level may cut the end of a closed limb, or a fork, obliquely."""
    result = radius_m.copy()
    for line in branch_lines(branch):
        own = radius_m[line]
        if len(own) >= 3:
            inner = np.median(sliding_window_view(_without_pinches(own), 3), axis=1)
            result[line] = np.concatenate([inner[:1], inner, [min(own[-1], inner[-1])]])
        result[line] = np.maximum(result[line], MIN_RADIUS_RATIO * np.median(own))
    return result


def _without_pinches(radius_m: Floats) -> Floats:
    """Radii (n,) along a branch; two pinched sections in a row have the smaller radius of those around them.

    A single one is left to the median.
    """
    from scipy.ndimage import grey_closing  # slow to load

    closed = np.asarray(grey_closing(radius_m, size=3), np.float64)
    thin = radius_m < PINCHED_SHARE * closed
    thin[[0, -1]] = False  # a tip, and the base of a limb in the bark of its parent
    both = thin[1:] & thin[:-1]
    return np.where(np.append(both, False) | np.append(False, both), closed, radius_m)
