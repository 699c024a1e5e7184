"""A tree in winter."""

from __future__ import annotations

from dataclasses import replace

from galewood.mesh import TreeMesh


def without_leaves(tree: TreeMesh) -> TreeMesh:
    """The tree without the primitives of its leaves: only its wood weighs something and catches the wind."""
    return replace(tree, primitives=[part for part in tree.primitives if part.kind != "leaves"])
