"""Wood that is added where foliage has none: its reach, its radii, and how the foliage then moves."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from galewood.formats.types import RawPart
from galewood.options import ImportRequest
from galewood.pipeline.pictures.thumbnail import draw
from galewood.solid.fem import LEAST_PROFILE
from galewood.solid.model import beam_model, in_added_wood
from galewood.solid.model.beam_tree import frame_of
from galewood.solid.model.foliage import LEAF_MASS_KG_M2
from galewood.solid.skeleton import outline_of
from galewood.solid.skinning import Distortion, axis_of_frame, vertex_bindings
from galewood.tree.importer import read_tree
from galewood.tree.missing.added_lines import Load, pipe_radius
from galewood.tree.missing.missing_wood import Completed, complete_wood
from galewood.tree.missing.sections import edge_samples, sections_at
from galewood.tree.render_mesh import render_glb
from galewood.tree.repair import Surface
from galewood.tree.sandboxed import pack_tree, unpack_tree
from galewood.tree.types import TreeMesh
from galewood.util import Floats, MeshError
from galewood.wood import wood_of_species
from PIL import Image

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.labelled import shapes as shapes

SEED = 7
HEIGHT_M, STUB_M, RADIUS_M, CROWN_M = 10.0, 4.5, 0.18, 3.4


def sphere(centre: Any, radius: Any, level: int = 3) -> Surface:
    ball = shapes.ball(np.random.default_rng(SEED), centre, radius, 0.0, level)
    return Surface(ball.vertices, ball.faces)


def stub() -> Surface:
    return make.tube((0, 0, 0), (0, STUB_M, 0), RADIUS_M, RADIUS_M, sides=16, rings=12)


def named_glb(wood: Surface | None, leaves: Surface) -> bytes:
    """A GLB as Galewood writes it, whose parts are taken as named."""
    tree = make.as_tree(wood or leaves, leaves)
    kept = tree.primitives if wood else tree.primitives[1:]
    return render_glb(TreeMesh(kept, tree.wood_vertices_m, tree.wood_faces, tree.height_m, None, {}))


def read(
    wood: Surface | None, leaves: Surface, complete: bool | None = None, height_m: float = HEIGHT_M
) -> TreeMesh:
    options = ImportRequest(height_m=height_m, up_axis="y", complete=complete)
    return read_tree(named_glb(wood, leaves), "tree.glb", options)


@pytest.fixture(scope="module")
def lollipop() -> TreeMesh:
    """A closed crown of 10 m on a stub of 4.5 m that ends in its lower part."""
    return read(stub(), sphere((0, HEIGHT_M - CROWN_M, 0), CROWN_M))


def completed(wood: Surface, *crowns: Surface, asked: bool | None = None) -> Completed:
    return complete_wood(wood, [RawPart(("leaves",), c.vertices, c.faces) for c in crowns], asked)


def sections_area(surface: Surface, height: float) -> float:
    return sum(section.area for section in sections_at(surface, height))


def test_sections_have_the_area_and_centre_of_the_polygon():
    sides, radius = 10, 0.3
    tube = make.tube((1, 0, 2), (1, 2, 2), radius, radius, sides=sides)
    both = make.joined(tube, make.tube((4, 0.5, 0), (4, 2, 0), 0.1, 0.1, sides=sides))
    found = sections_at(both, 1.23)
    polygon = sides / 2 * np.sin(2 * np.pi / sides)
    assert [s.area for s in found] == pytest.approx([polygon * radius**2, polygon * 0.1**2], rel=1e-12)
    np.testing.assert_allclose(found[0].centre, (1, 1.23, 2), atol=1e-12)
    assert sections_at(both, 2.5) == []


def test_cross_sections_add_up_at_forks():
    load = Load(np.array([1.0, 2.0, 2.0, 3.0]), np.array([4.0, 1.0, 2.0, 3.0]))
    below, above = np.pi * pipe_radius(load, np.array([2.0 - 1e-9, 2.0 + 1e-9]), 0.5) ** 2
    assert below - above == pytest.approx(0.5 * 3.0 / 10.0, rel=1e-12)  # what leaves the stem at this fork
    assert np.pi * pipe_radius(load, np.array([0.0]), 0.5)[0] ** 2 == pytest.approx(0.5, rel=1e-12)


def test_branches_and_stem_share_the_cross_section_as_the_leaves():
    high, left, right = (sphere(c, r, 2) for c, r in (((0, 8, 0), 1.5), ((3, 6, 0), 1), ((-3, 6, 0), 0.8)))
    found = completed(stub(), high, left, right)
    assert [line.kind for line in found.lines] == ["stem", "branch", "branch"]
    area = [np.pi * line.radius_m[0] ** 2 for line in found.lines]
    leaves = [4 * np.pi * r**2 for r in (1.5, 1, 0.8)]
    ends = np.array([line.points_m[-1] for line in found.lines[1:]])
    order = np.argsort(-ends[:, 0])
    branches = np.array(area[1:])[order]
    np.testing.assert_allclose(ends[order], [(3, 6, 0), (-3, 6, 0)], atol=0.05)
    np.testing.assert_allclose(branches / area[0], np.array(leaves[1:]) / sum(leaves), rtol=0.02)
    assert branches[0] / branches[1] == pytest.approx(1 / 0.8**2, rel=1e-6)
    assert area[0] == pytest.approx(sections_area(stub(), 4.0), rel=1e-6), (
        "the stem begins as thick as the stub"
    )


def test_a_closed_crown_on_a_stub_gets_a_stem(lollipop: TreeMesh):
    assert lollipop.wood_vertices_m[:, 1].max() > 0.9 * HEIGHT_M
    assert 4.5 < lollipop.report["added_wood"]["stems_m"][0] < 6.0
    warning = next(w for w in lollipop.report["warnings"] if "A stem of" in w)
    assert "the wood ends at 45% of the height" in warning
    assert "--no-complete" in warning


def test_what_is_drawn_does_not_change(lollipop: TreeMesh):
    plain = read(stub(), sphere((0, HEIGHT_M - CROWN_M, 0), CROWN_M), complete=False)
    assert plain.added_faces == 0
    assert any("The wood ends at" in w for w in plain.report["warnings"])
    assert render_glb(plain) == render_glb(lollipop)
    drawn = lollipop.drawn_wood()
    assert sections_area(Surface(drawn.positions_m, drawn.faces), 2.0) == pytest.approx(
        sections_area(Surface(plain.wood_vertices_m, plain.wood_faces), 2.0), rel=1e-9
    )
    wood = wood_of_species("default")
    more = beam_model(lollipop, wood).mass_kg.sum() - beam_model(plain, wood).mass_kg.sum()
    added_kg = lollipop.report["added_wood"]["volume_m3"] * wood.density_kg_m3
    assert more == pytest.approx(added_kg, rel=0.1), "leaves and twigs weigh what they did"


def cantilever(tree: TreeMesh, lines: Completed) -> tuple[float, Floats, Floats]:
    """First frequency, Hz, heights and shape of the trunk as an Euler-Bernoulli beam, by its flexibility."""
    wood = wood_of_species("default")
    height = np.linspace(0, lines.lines[0].points_m[-1, 1], 241)[1:]
    step = height[0]
    stem = lines.lines[0]
    drawn_m = np.sqrt(sections_area(stub(), 1.0) / np.pi)
    radius = np.interp(height, stem.points_m[:, 1], stem.radius_m)
    radius = np.where(height < stem.points_m[0, 1], drawn_m, radius)
    mass = wood.density_kg_m3 * np.pi * radius**2 * step
    crown = next(p for p in tree.primitives if p.kind == "leaves")
    corners = crown.positions_m[crown.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    at = np.clip(np.searchsorted(height, corners.mean(axis=1)[:, 1]), 0, len(height) - 1)
    mass = mass + LEAF_MASS_KG_M2 * np.bincount(at, area, len(height))
    bending = wood.young_longitudinal_pa * np.pi / 4 * radius**4
    arm = np.maximum(height[:, None] - (height - step / 2)[None], 0.0)
    flexibility = (arm / bending * step) @ arm.T
    root = np.sqrt(mass)
    value, shape = np.linalg.eigh(root[:, None] * flexibility * root)
    return float(1 / (2 * np.pi * np.sqrt(value[-1]))), height, shape[:, -1] / root


def test_the_crown_moves_as_a_beam_does(lollipop: TreeMesh):
    lines = completed(stub(), sphere((0, HEIGHT_M - CROWN_M, 0), CROWN_M))
    first_hz, height, shape = cantilever(lollipop, lines)
    model = beam_model(lollipop, wood_of_species("default"))
    assert model.frequencies_hz[0] == pytest.approx(first_hz, rel=0.06)
    bindings = vertex_bindings(lollipop, model.axis)
    mode = np.moveaxis(model.shapes[:1], 0, -1)
    moved, turned = model.axis.displacement(mode)[..., 0], model.axis.rotation(mode)[..., 0]
    places = np.concatenate([p.positions_m for p in lollipop.primitives])
    up = model.axis.parent[bindings.child]
    share = bindings.share[:, None]
    here = (1 - share) * moved[up] + share * moved[bindings.child]
    spin = (1 - share) * turned[up] + share * turned[bindings.child]
    drawn = here + np.cross(spin, places - bindings.at_m)
    way = moved[int(np.abs(moved[:, [0, 2]]).sum(axis=1).argmax())] * (1, 0, 1)
    way /= np.linalg.norm(way)
    crown = places[:, 1] > STUB_M
    chosen = crown & (places[:, 1] < height[-1])  # beside the axis the rotation lifts, but does not push
    expected = np.interp(places[chosen, 1], height, shape)
    found = drawn[chosen] @ way
    scale = float(found @ expected / (expected @ expected))
    assert chosen.sum() > 20
    np.testing.assert_allclose(found, scale * expected, atol=0.1 * abs(scale) * np.abs(expected).max())


FRONDS, FROND_M = 7, 2.6


def palm(thick: float = 0.0) -> tuple[Surface, Surface]:
    """A trunk of 7 m and fronds that are joined where they grow."""
    rng = np.random.default_rng(SEED)
    trunk = make.tube((0, 0, 0), (0, 7, 0), 0.2, 0.15, sides=12, rings=12)
    fronds = [
        shapes.frond(rng, (0, 7, 0), k * 2 * np.pi / FRONDS, FROND_M, 0.5, thick, 9) for k in range(FRONDS)
    ]
    leaves = shapes.together(*fronds)
    return trunk, Surface(leaves.vertices, leaves.faces)


@pytest.mark.parametrize("thick", [0.0, 0.04])
def test_every_frond_of_a_palm_gets_a_rib_and_bends_along_it(thick: float):
    tree = read(*palm(thick))
    added = tree.report["added_wood"]
    assert (added["fronds"], added["branches"], added["stems_m"]) == (FRONDS, 0, [])
    frame = frame_of(outline_of(tree.wood_vertices_m, tree.wood_faces))
    bindings = vertex_bindings(tree, axis_of_frame(frame, 0.1))
    leaves = np.arange(len(bindings.child)) >= len(tree.primitives[0].positions_m)
    places = np.concatenate([p.positions_m for p in tree.primitives])
    apart = np.linalg.norm(places - bindings.at_m, axis=1)[leaves]
    unit = tree.height_m / np.ptp(np.concatenate([p.vertices for p in palm(thick)])[:, 1])
    assert np.percentile(apart, 95) < 0.3 * FROND_M * unit, (
        "fronds are held along their ribs, not at the trunk"
    )


def bush(count: int = 120) -> Surface:
    rng = np.random.default_rng(SEED)
    points = shapes.in_ball(rng, (0, 1.0, 0), np.array([1.2, 0.8, 1.2]), count)
    leaves = shapes.cards(rng, points, 0.2)
    return Surface(leaves.vertices, leaves.faces)


def test_a_bush_of_leaves_alone_gets_stems_from_the_ground():
    tree = read(None, bush(), height_m=2.0)
    added = tree.report["added_wood"]
    assert len(added["stems_m"]) >= 3
    assert added["reason"] == "the file draws no wood"
    assert tree.wood_vertices_m[:, 1].min() == pytest.approx(0.0, abs=1e-9)
    assert [p.kind for p in tree.primitives] == ["leaves"]
    assert len(tree.drawn_wood().faces) == 0
    near = edge_samples(Surface(tree.wood_vertices_m, tree.wood_faces), 0.1)
    centre = tree.primitives[0].positions_m.mean(axis=0)
    assert np.linalg.norm(near - centre, axis=1).min() < 0.3 * tree.height_m
    model = beam_model(tree, wood_of_species("default"))
    assert 0.1 < model.frequencies_hz[0] < 10
    assert model.wind_profile.min() >= LEAST_PROFILE
    rest = np.concatenate([p.positions_m for p in tree.primitives])
    assert "wood_stretch" not in Distortion(tree).between(rest, rest)


def test_a_fern_of_fronds_alone_gets_their_ribs():
    _, fronds = palm(0.02)
    tree = read(None, fronds)
    assert tree.report["added_wood"]["fronds"] == FRONDS
    assert tree.report["added_wood"]["stems_m"] == []


def test_a_tall_crown_alone_gets_one_stem():
    tree = read(None, sphere((0, 2, 0), np.array([0.8, 2.0, 0.8])))
    assert len(tree.report["added_wood"]["stems_m"]) == 1
    assert tree.wood_vertices_m[:, 1].max() > 0.85 * tree.height_m


def test_leaves_alone_are_refused_if_nothing_may_be_added():
    with pytest.raises(MeshError, match="No wood was found"):
        read(None, bush(), complete=False)


def test_a_picture_of_a_tree_on_cards_is_refused():
    sheet = make.cards([(0, 0, 0)], 3.0)
    turned = Surface(sheet.vertices[:, [2, 1, 0]], sheet.faces)
    with pytest.raises(MeshError, match="cards as large as a tree"):
        read(None, make.joined(sheet, turned))


def test_a_branched_tree_is_left_alone():
    wood = make.y_tree()
    ends = np.array([(1.6, 4.5, 0), (-1.5, 4.8, 0.4), (0.8, 3.5, 0), (-0.7, 3.6, 0.2)])
    tree = read(wood, make.cards(ends, 0.3))
    assert tree.added_faces == 0
    assert "added_wood" not in tree.report
    assert not tree.report["warnings"] or not any("added" in w for w in tree.report["warnings"])


def test_the_added_wood_passes_through_the_sandbox(lollipop: TreeMesh):
    again = unpack_tree(pack_tree(lollipop))
    assert again.added_faces == lollipop.added_faces > 0
    added = again.added_wood()
    assert added is not None
    assert added.positions_m[:, 1].min() > 0.8 * STUB_M


def test_pictures_show_the_added_wood(lollipop: TreeMesh):
    points = np.array([(0, 1.0, 0), (0, 4.0, 0), (0, 5.5, 0), (0, 9.0, 0)])
    assert in_added_wood(lollipop, points).tolist() == [False, False, True, True]
    added = lollipop.added_wood()
    assert added is not None
    parts = [RawPart((p.kind,), p.positions_m, p.faces) for p in lollipop.primitives]
    shares: list[float] = []
    for over in (None, added.positions_m[added.faces]):
        pixels = np.asarray(Image.open(io.BytesIO(draw(parts, 64, over))).convert("RGB")).astype(int)
        shares.append(float((pixels[..., 2] > pixels[..., 0] + 20).mean()))
    assert shares[0] == 0.0
    assert shares[1] > 0.005
