"""Impostors: the written pictures are held against rays that are traced through the mesh one by one."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.io.cli.commands import app
from galewood.io.export import ExportError, ExportOptions, write_export
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.impostor.export import RAYS_PER_SIDE, seen_from, sphere_of
from galewood.io.export.impostor.layout import (
    VIEWS_PER_SIDE,
    directions_at,
    squares_at,
    view_axes,
    view_directions,
)
from galewood.io.export.impostor.raster import NOTHING_M
from galewood.io.export.impostor.surfaces import Surface, surfaces_of
from galewood.table import Table, decode
from PIL import Image
from typer.testing import CliRunner

SHIPPED = Path(__file__).parents[4] / "assets/species/shipped/apricot-forest.table"
PIXELS = 512
SEED = 20261127


@dataclass(frozen=True)
class Impostor:
    """The files of one tree, and what they should show."""

    folder: Path
    told: dict[str, Any]
    surfaces: list[Surface]

    def picture(self, use: str) -> Any:
        """(h, w, 4) 0 to 1"""
        return np.asarray(Image.open(self.folder / self.told[use]), np.float64) / 255


def table_and_mesh(foliage: str = "") -> tuple[Table, bytes]:
    table = decode(SHIPPED.with_suffix(f"{foliage}.table").read_bytes())
    return table, SHIPPED.with_suffix(".glb").read_bytes()


@pytest.fixture(scope="module")
def impostor(tmp_path_factory: pytest.TempPathFactory) -> Impostor:
    folder = tmp_path_factory.mktemp("impostor")
    table, glb = table_and_mesh()
    told = write_export(table, glb, "impostor", folder, "oak", ExportOptions(pixels=PIXELS))
    return Impostor(folder, told, surfaces_of(GltfFile(glb, table), table))


def test_the_files_are_those_that_the_description_names(impostor: Impostor) -> None:
    assert sorted(path.name for path in impostor.folder.iterdir()) == [
        "oak.json",
        "oak_base_color.png",
        "oak_normal_depth.png",
    ]
    assert json.loads((impostor.folder / "oak.json").read_text()) == impostor.told
    for use in ("base_color", "normal_depth"):
        assert impostor.picture(use).shape == (PIXELS, PIXELS, 4)
    assert impostor.told["view_pixels"] * impostor.told["views_per_side"] == PIXELS


def test_the_square_and_the_hemisphere_are_the_same() -> None:
    print(f"seed {SEED}")
    rng = np.random.default_rng(SEED)
    square = rng.uniform(-1, 1, (500, 2))
    directions = directions_at(square)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    assert (directions[:, 1] >= 0).all()
    assert np.abs(squares_at(directions) - square).max() < 1e-12
    random = rng.normal(size=(500, 3))
    random[:, 1] = np.abs(random[:, 1])
    random /= np.linalg.norm(random, axis=1, keepdims=True)
    assert np.abs(directions_at(squares_at(random)) - random).max() < 1e-12


def test_the_views_cover_the_hemisphere_and_are_upright() -> None:
    views = view_directions()
    assert len(np.unique(np.round(views, 9), axis=0)) == VIEWS_PER_SIDE**2
    rng = np.random.default_rng(SEED)
    random = rng.normal(size=(4000, 3))
    random[:, 1] = np.abs(random[:, 1])
    random /= np.linalg.norm(random, axis=1, keepdims=True)
    nearest_deg = np.degrees(np.arccos(np.clip((random @ views.T).max(axis=1), -1, 1)))
    assert nearest_deg.max() < 19
    for view in views:
        axes = view_axes(view)
        assert np.allclose(axes @ axes.T, np.eye(3))
        assert np.linalg.det(axes) == pytest.approx(1)
        assert axes[0, 1] == 0
        assert axes[1, 1] >= 0


def told_direction(column: int, row: int, per_side: int) -> Any:
    """The direction of a view by the words of the description."""
    s, t = (2 * place / (per_side - 1) - 1 for place in (column, row))
    x, z = (s + t) / 2, (s - t) / 2
    found = np.array([x, 1 - abs(x) - abs(z), z])
    return found / np.linalg.norm(found)


@dataclass(frozen=True)
class Hit:
    """What a ray meets first."""

    depth_m: float
    colour: Any
    normal: Any


def traced(surfaces: list[Surface], origin_m: Any, towards: Any) -> Hit | None:
    """The first hit of a ray from far in front, by the method of Möller and Trumbore.

    ``origin_m`` (3,) a place in the plane through the centre; ``towards`` (3,) the direction to the eye.
    """
    best: Hit | None = None
    for surface in surfaces:
        corner = surface.corner_m
        first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        p = np.cross(-towards, second)
        size = (first * p).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):  # of triangles on edge
            arm = origin_m - corner[:, 0]
            b = (arm * p).sum(axis=1) / size
            q = np.cross(arm, first)
            c = (q @ -towards) / size
            depth = -(second * q).sum(axis=1) / size
            hit = np.flatnonzero((b >= 0) & (c >= 0) & (b + c <= 1) & np.isfinite(depth))
        for k in hit[np.argsort(-depth[hit])]:
            front = np.cross(first[k], second[k]) @ towards > 0
            if best is not None and depth[k] <= best.depth_m:
                break
            if not front and not surface.both_sides:
                continue
            share = np.array([1 - b[k] - c[k], b[k], c[k]])
            u, v = share @ surface.uv[k]
            height, width, _ = surface.picture.shape
            texel = surface.picture[int(np.floor(v * height)) % height, int(np.floor(u * width)) % width]
            if texel[3] < surface.cutoff:
                continue
            normal = share @ surface.normal[k]
            best = Hit(float(depth[k]), texel[:3], normal if front else -normal)
            break
    return best


def test_texels_are_what_rays_meet(impostor: Impostor) -> None:
    """Coverage, colour, normal and depth of random texels at the edge of the tree and within it."""
    print(f"seed {SEED}")
    rng, told = np.random.default_rng(SEED), impostor.told
    colour, surface = impostor.picture("base_color"), impostor.picture("normal_depth")
    side, per_side = told["view_pixels"], told["views_per_side"]
    centre, radius = np.array(told["centre_m"]), told["radius_m"]
    places = np.argwhere(colour[..., 3] > 0)
    off = {name: list[float]() for name in ("coverage", "colour", "normal", "depth")}
    for row, column in places[rng.choice(len(places), 60, replace=False)]:
        view_row, view_column = row // side, column // side
        towards = told_direction(view_column, view_row, per_side)
        right = np.cross([0, 1, 0], towards)
        right /= np.linalg.norm(right)
        up, hits = np.cross(towards, right), list[Hit]()
        for sample in range(RAYS_PER_SIDE**2):
            at = np.array(divmod(sample, RAYS_PER_SIDE)) + 0.5
            y, x = (np.array([row, column]) % side + at / RAYS_PER_SIDE) * 2 * radius / side - radius
            hit = traced(impostor.surfaces, centre + x * right - y * up, towards)
            hits += [hit] if hit else []
        texel, coverage = surface[row, column], len(hits) / RAYS_PER_SIDE**2
        off["coverage"].append(abs(coverage - colour[row, column, 3]))
        if abs(coverage - colour[row, column, 3]) > 0.5 / 255 + 1e-9:
            continue  # a ray through an edge: counted above
        linear = np.mean([hit.colour for hit in hits], axis=0)
        srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        off["colour"].append(float(np.abs(srgb - colour[row, column, :3]).max()))
        normal = np.mean([hit.normal for hit in hits], axis=0)
        normal /= np.linalg.norm(normal)
        off["normal"].append(float(np.abs(0.5 + 0.5 * normal - texel[:3]).max()))
        depth = np.mean([hit.depth_m for hit in hits])
        off["depth"].append(abs((2 * texel[3] - 1) * radius - float(depth)) / radius)
    assert len(off["depth"]) > 55
    assert max(off["coverage"]) <= 1.1 / RAYS_PER_SIDE**2
    assert max(off["colour"]) < 0.51 / 255
    assert max(off["normal"]) < 0.51 / 255
    assert max(off["depth"]) < 1.01 / 255


def test_no_vertex_of_the_wood_is_in_front_of_what_is_seen(impostor: Impostor) -> None:
    """Random vertices, in random views: known places, whatever the triangles around them are."""
    print(f"seed {SEED}")
    rng = np.random.default_rng(SEED)
    (centre, radius), rays = sphere_of(impostor.surfaces, PIXELS // VIEWS_PER_SIDE), 2048
    wood = impostor.surfaces[0].corner_m.reshape(-1, 3)
    views, found = view_directions(), 0
    for view in rng.choice(len(views), 4, replace=False):
        seen, axes = seen_from(impostor.surfaces, views[view], centre, radius, rays), view_axes(views[view])
        at = (wood[rng.choice(len(wood), 200)] - centre) @ axes.T
        column = np.floor((at[:, 0] / radius + 1) * rays / 2).astype(int)
        row = np.floor((1 - at[:, 1] / radius) * rays / 2).astype(int)
        # the vertex need not be in the middle of its pixel: look at those around it too
        around = [seen.depth_m[row + i, column + j] for i in (-1, 0, 1) for j in (-1, 0, 1)]
        depth = np.max(around, axis=0)
        assert (depth > NOTHING_M).all()
        assert (depth > at[:, 2] - 0.02).all()
        found += int((np.abs(depth - at[:, 2]) < 0.02).sum())
    assert found > 50  # many are seen themselves


def test_a_card_covers_the_area_that_it_turns_to_the_eye(tmp_path: Path) -> None:
    """A sheet of 1 m² in the plane of x and z at a height, its upper side seen; half of it is a hole."""
    corner = np.array([[-0.5, 2, -0.5], [-0.5, 2, 0.5], [0.5, 2, 0.5], [0.5, 2, -0.5]])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    uv = np.array([[0.0, 0], [0, 1], [1, 1], [1, 0]])
    picture = np.full((1, 2, 4), 0.5, np.float32)
    picture[0, 0, 3] = 0.0
    normal = np.tile([0.0, 1, 0], (2, 3, 1))
    centre, radius, rays = np.array([0.0, 2, 0]), 1.0, 512
    for both_sides in (True, False):
        card = Surface(corner[faces], normal, uv[faces], picture, 0.4, both_sides)
        for direction in view_directions()[[0, 9, 27, 36]]:
            for towards in (direction, -direction):
                seen = seen_from([card], towards, centre, radius, rays)
                area = (seen.depth_m > NOTHING_M).sum() * (2 * radius / rays) ** 2
                shown = both_sides or towards[1] > 0
                assert area == pytest.approx(0.5 * abs(towards[1]) * shown, abs=0.006)
                if shown and abs(towards[1]) > 0.1:
                    facing = seen.look[seen.depth_m > NOTHING_M][:, 3:]
                    assert np.allclose(facing, [0, np.sign(towards[1]), 0])


def test_empty_texels_repeat_the_nearest_colour(impostor: Impostor) -> None:
    colour, side = impostor.picture("base_color"), impostor.told["view_pixels"]
    tile = colour[:side, :side]
    empty, shown = tile[tile[..., 3] == 0][:, :3], tile[tile[..., 3] > 0][:, :3]
    assert len(empty) > 0.2 * side**2
    assert {tuple(row) for row in empty} <= {tuple(row) for row in shown}
    assert not np.any(tile[[0, -1]][..., 3]) and not np.any(tile[:, [0, -1], 3])


def test_a_tree_without_leaves_is_drawn_without_them(tmp_path: Path) -> None:
    (leafy, glb), (bare, _) = table_and_mesh(), table_and_mesh(".bare")
    file = GltfFile(glb, leafy)
    assert [len(surfaces_of(file, table)) for table in (leafy, bare)] == [3, 2]
    told = write_export(bare, glb, "impostor", tmp_path, "bare", ExportOptions(pixels=256))
    assert told["view_pixels"] == 32


def test_what_an_impostor_has_not_is_said(tmp_path: Path) -> None:
    table, glb = table_and_mesh()
    with pytest.raises(ExportError, match="one level of detail"):
        write_export(table, glb, "impostor", tmp_path, "oak", ExportOptions(levels=2))
    with pytest.raises(ExportError, match="not a GLB"):
        write_export(table, b"", "impostor", tmp_path, "oak", ExportOptions())


def test_the_command_writes_it(tmp_path: Path) -> None:
    out = str(tmp_path / "far")
    asked = ["export", str(SHIPPED), "--to", "impostor", "--out", out, "--name", "far", "--pixels", "256"]
    result = CliRunner().invoke(app, asked)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "far" / "far_base_color.png").is_file()
