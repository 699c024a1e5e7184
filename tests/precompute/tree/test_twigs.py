"""Drawn twigs: recognised by name, not meshed, bound in one piece, with the mass of their volume."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.formats.types import RawPart
from galewood.options import ImportRequest
from galewood.solid.model.beam_tree import beam_model
from galewood.solid.model.foliage import crown_loads
from galewood.solid.model.twigs import twig_volumes
from galewood.tree.importer import read_tree
from galewood.tree.pieces.classification import classify
from galewood.tree.render_mesh import render_glb
from galewood.tree.repair import Surface
from galewood.tree.types import RenderPrimitive
from galewood.util import Floats
from galewood.wood import wood_of_species

from tests.precompute.fixtures import tree_meshes as make

WOOD = wood_of_species("maple")


def twig(start=(0.0, 2.0, 0.0), end=(0.6, 2.4, 0.0), radius=0.008) -> Surface:
    return make.tube(start, end, radius, 0.5 * radius, sides=3, rings=3)


def primitive(surface: Surface) -> RenderPrimitive:
    return RenderPrimitive("twigs_0", "twigs", surface.vertices, surface.faces)


def tree_with_twigs() -> bytes:
    whole = make.as_tree(make.y_tree(), make.cards([end for _, end in make.BRANCHES]))
    twigs = primitive(make.joined(twig(), twig((0, 1.5, 0), (-0.5, 2.0, 0.1))))
    return render_glb(replace(whole, primitives=[whole.primitives[0], twigs, whole.primitives[1]]))


def test_named_twigs_are_drawn_but_not_meshed():
    plain = read_tree(make.glb_bytes(make.y_tree()), "tree.glb", ImportRequest())
    tree = read_tree(tree_with_twigs(), "tree.glb", ImportRequest())
    assert [p.kind for p in tree.primitives] == ["wood", "twigs", "leaves"]
    np.testing.assert_array_equal(tree.wood_faces, plain.wood_faces)
    np.testing.assert_allclose(tree.wood_vertices_m, plain.wood_vertices_m)


@pytest.mark.parametrize(
    ("labels", "kind"),
    [
        (("twigs",), "twigs"),
        (("Zweige_2",), "twigs"),
        (("branches and twigs",), "wood"),
        (("twig_leaves",), "leaves"),
        (("bark", "twigs"), "wood"),  # the material's name comes first
    ],
)
def test_names_of_twigs(labels, kind):
    surface = make.y_tree()
    trunk = RawPart(("trunk",), surface.vertices, surface.faces)
    pieces = classify([trunk, RawPart(labels, *_arrays(twig()))], ImportRequest()).parts
    assert [piece.kind for piece in pieces] == ["wood", kind]


def test_twigs_without_thicker_wood_are_the_wood():
    surface = make.y_tree()
    pieces = classify([RawPart(("twigs",), surface.vertices, surface.faces)], ImportRequest()).parts
    assert [piece.kind for piece in pieces] == ["wood"]


def test_parts_chosen_as_wood_by_the_user_are_wood_even_if_named_twigs():
    parts = [RawPart((name,), *_arrays(twig())) for name in ("twigs", "twigs thin", "crown")]
    pieces = classify(parts, ImportRequest(wood_parts=["twigs"])).parts
    assert [piece.kind for piece in pieces] == ["wood", "twigs", "leaves"]


def _arrays(surface: Surface):
    return surface.vertices, surface.faces


def test_the_volume_of_twigs_is_exact_whichever_way_they_are_wound():
    """A closed box and a pyramid apart from each other: base area times height, and a third of that."""
    box = np.array([[x, y, z] for x in (0, 2) for y in (0, 3) for z in (0, 5)], float)
    from scipy.spatial import ConvexHull

    apex = np.array([[9, 0, 0], [11, 0, 0], [9, 3, 0], [11, 3, 0], [10, 1, 4.0]])
    faces = []
    for points in (box, apex):
        hull = ConvexHull(points)
        outward = np.einsum(
            "ij,ij->i",
            np.cross(
                points[hull.simplices[:, 1]] - points[hull.simplices[:, 0]],
                points[hull.simplices[:, 2]] - points[hull.simplices[:, 0]],
            ),
            hull.equations[:, :3],
        )
        faces.append(np.where(outward[:, None] > 0, hull.simplices, hull.simplices[:, ::-1]))
    inside_out = faces[1][:, ::-1]
    surface = Surface(np.vstack([box, apex]), np.vstack([faces[0], inside_out + len(box)]).astype(np.int32))
    volumes = twig_volumes(primitive(surface))
    assert volumes[: len(box)].sum() == pytest.approx(30.0)
    assert volumes[len(box) :].sum() == pytest.approx(8.0)


def test_the_mass_of_twigs_is_their_volume_times_density_where_they_stand():
    tree = read_tree(tree_with_twigs(), "tree.glb", ImportRequest())
    heights = np.array([0.0, 2.0, 4.0])

    def spread(part: RenderPrimitive, amount: Floats) -> Floats:
        nearest = np.clip(np.rint(part.positions_m[:, 1] / 2), 0, 2).astype(int)
        return np.bincount(nearest, amount, 3).astype(np.float64)

    with_twigs = crown_loads(tree, WOOD, heights, spread, 100.0)
    bare = replace(tree, primitives=[p for p in tree.primitives if p.kind != "twigs"])
    without = crown_loads(bare, WOOD, heights, spread, 100.0)
    volume = twig_volumes(tree.primitives[1]).sum()
    assert with_twigs.report["twig_mass_kg"] == pytest.approx(volume * WOOD.density_kg_m3)
    assert without.report["twig_mass_kg"] == 0
    added = with_twigs.mass_kg - without.mass_kg
    assert added.sum() == pytest.approx(volume * WOOD.density_kg_m3)
    assert added[1] == pytest.approx(added.sum())  # both stand about 2 m above the ground


def test_a_twig_is_not_deformed_by_the_beams_it_hangs_on():
    tree = read_tree(tree_with_twigs(), "tree.glb", ImportRequest())
    model = beam_model(tree, WOOD)
    first = len(tree.primitives[0].positions_m)
    count = len(twig().vertices)
    rows = model.embedding[first : first + 2 * count].toarray()
    assert np.ptp(rows[:count], axis=0).max() < 1e-12
    assert np.ptp(rows[count:], axis=0).max() < 1e-12
    assert np.abs(rows[0] - rows[-1]).max() > 0.1
