"""Tetrahedral meshing of the wood: thicken, wrap, decimate, fill, restore the volume, polish, check, cache.

Thin branches are thickened to a radius the mesher resolves (the radius ratio is kept per tet); a distance
grid yields one closed surface; decimation sets the number of tets; fTetWild fills the surface, in few of its
slow passes. Then the surface is offset to restore the volume lost by decimation and meshing, long edges are
split if there are too few tets, and the vertices of the worst tets are moved.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from galewood.options import MAX_TETS, MIN_TETS, USUAL_TETS
from galewood.sandbox import Limits, run_limited
from galewood.solid.tets.cache import cache_key, cached_path, load_cached, store_cached
from galewood.solid.tets.polish import polished
from galewood.solid.tets.quality import (
    largest_component,
    lost_extent,
    quality_report,
    restore_volume,
    tet_volumes,
)
from galewood.solid.tets.radius_ratio import radius_ratio
from galewood.solid.tets.refine import refined
from galewood.solid.tets.thicken import Thickened, thicken
from galewood.solid.tets.wrap import decimate, whole_part, wrap
from galewood.tree import Surface, TreeMesh, volume
from galewood.util import Floats, Int32s, Ints, MeshError

MIN_RADIUS_SHARE = 2.8e-3  # smallest radius, relative to the diagonal
ENVELOPE_FLOOR_RATIO = 0.3  # fTetWild's envelope relative to the floor; a smaller one gives more tets
CELLS_PER_FLOOR, JOINED_CELLS_PER_FLOOR = 1.5, 1.0
EDGE_LENGTH = 0.08  # relative to the diagonal
STOP_ENERGY = 30.0
OPTIMISATION_PASSES = 2  # of fTetWild; more cost half a second each and gain less than polishing does
TETS_PER_FACE = 0.95
FILLED_UP = 0.7  # of the target: with fewer tets, long edges are split
POLISHED_WITHIN = 0.2  # of the floor: how far polishing slides a vertex along the surface; 0.6 softens limbs
BAD_SHAPE, BAD_WITHIN = 0.05, 0.5  # vertices of such tets may slide further
MAX_FLOOR_RAISES, FLOOR_RAISE_FACTOR = 5, 1.2
"""Raises before the shell is filled: a floor as low as possible keeps the stiffness."""
MIN_TARGET_RATIO, MAX_TARGET_RATIO = 0.55, 1.45  # relative to the target
MAX_LOST_EXTENT = 0.03
MAX_LOST_VOLUME = 1e-3  # in disconnected pieces
MAX_ATTEMPTS = 4
TETWILD_LIMITS = Limits(memory_bytes=6 << 30, cpu_s=200)


@dataclass(frozen=True)
class TetMesh:
    """vertices_m (n, 3), positive tets (m, 4), radius_ratio (m,): original over thickened radius."""

    vertices_m: Floats
    tets: Int32s
    radius_ratio: Floats
    report: dict[str, Any]


@dataclass(frozen=True)
class Recipe:
    """Parameters varied between attempts; `floor` is relative to the diagonal, `envelope` to the floor."""

    faces: int
    fewest: int  # tets; long edges are split until there are as many
    floor: float = MIN_RADIUS_SHARE
    envelope: float = ENVELOPE_FLOOR_RATIO


@dataclass(frozen=True)
class Shell:
    """The thickened wood as one closed surface, decimated, and the volume it had before."""

    floor_m: float
    raised: Thickened
    volume_m3: float
    decimated: Surface


def tetrahedralise(tree: TreeMesh, target_tets: int = USUAL_TETS, cache_dir: Path | None = None) -> TetMesh:
    """One connected solid of about `target_tets` tetrahedra. Raises MeshError if meshing fails.

    pytetwild is not deterministic, so each mesh is cached in `cache_dir` under the hash of its input.
    """
    if not MIN_TETS <= target_tets <= MAX_TETS:
        raise MeshError(
            "bad-target",
            "unsuitable",
            f"A target of {target_tets} tetrahedra is out of range.",
            f"Use {MIN_TETS} to {MAX_TETS:,}.",
        )
    key = cache_key(tree.wood_vertices_m, tree.wood_faces, target_tets)
    cached = load_cached(cache_dir, key)
    if cached is not None:
        return TetMesh(*cached)
    mesh = _attempts(Surface(tree.wood_vertices_m, tree.wood_faces), target_tets)
    store_cached(cache_dir, key, mesh.vertices_m, mesh.tets, mesh.radius_ratio, mesh.report)
    return mesh


def joined_surface(surface: Surface, faces: int) -> tuple[Surface, Floats]:
    """One closed surface around all wood, with about so many faces, and for each the ratio of thickening.

    It is coarser than that of the mesher by the ratio of the cells.
    """
    floor_m = MIN_RADIUS_SHARE * float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    raised = thicken(surface, floor_m)
    joined = decimate(wrap(raised.surface, floor_m / JOINED_CELLS_PER_FLOOR), faces)
    centre = joined.vertices[joined.faces].mean(axis=1)
    return joined, raised.sample_ratio[KDTree(raised.sample_points).query(centre)[1]]


def cached_tetrahedra_path(tree: TreeMesh, target_tets: int, cache_dir: Path) -> Path:
    """The file in which `tetrahedralise` caches its mesh; other machines copy it to use the same mesh."""
    return cached_path(cache_dir, cache_key(tree.wood_vertices_m, tree.wood_faces, target_tets))


def _attempts(surface: Surface, target_tets: int) -> TetMesh:
    recipe = Recipe(faces=round(target_tets / TETS_PER_FACE), fewest=round(FILLED_UP * target_tets))
    tried: list[str] = []
    best: TetMesh | None = None
    for _ in range(MAX_ATTEMPTS):
        recipe, shell = _connected_shell(surface, recipe)
        mesh = _attempt(surface, shell, recipe)
        count, lost = len(mesh.tets), mesh.report["lost_extent"]
        tried.append(f"floor {recipe.floor:.4f}, {recipe.faces} faces: {count} tets, {lost:.1%} lost")
        if best is None or _penalty(mesh, target_tets) < _penalty(best, target_tets):
            best = mesh
        if _penalty(mesh, target_tets) == 0:
            break
        if lost > MAX_LOST_EXTENT:
            recipe = replace(recipe, floor=recipe.floor * 1.4)
        elif mesh.report["lost_volume"] > MAX_LOST_VOLUME:
            recipe = replace(recipe, floor=recipe.floor * 1.2)
        else:
            recipe = _adjusted(recipe, target_tets / count)
    assert best is not None
    if best.report["lost_extent"] > 3 * MAX_LOST_EXTENT:
        raise MeshError(
            "not-meshable", "unsuitable", f"Meshing lost {best.report['lost_extent']:.0%} of the wood.",
            "The branches may not be connected to the trunk. Join them and try again.",
        )  # fmt: skip
    best.report["attempts"] = tried
    if best.report["lost_extent"] > MAX_LOST_EXTENT:
        best.report["warnings"].append(f"Meshing lost {best.report['lost_extent']:.1%} of the wood's extent.")
    return best


def _adjusted(recipe: Recipe, wanted: float) -> Recipe:
    """The recipe for `wanted` times as many tets.

    The envelope is reduced first, because extra faces alone would be collapsed again.
    """
    faces = round(recipe.faces * float(np.clip(wanted, 0.4, 1.3)))
    return replace(recipe, faces=faces, envelope=recipe.envelope * (0.5 if wanted > 1 else 1.2))


def _penalty(mesh: TetMesh, target_tets: int) -> float:
    """0 for an acceptable mesh, otherwise its distance from the limits."""
    share = len(mesh.tets) / target_tets
    off = max(MIN_TARGET_RATIO - share, share - MAX_TARGET_RATIO, 0.0)
    off += 10.0 * max(mesh.report["lost_volume"] - MAX_LOST_VOLUME, 0.0)
    return off + 10.0 * max(mesh.report["lost_extent"] - MAX_LOST_EXTENT, 0.0)


def _connected_shell(surface: Surface, recipe: Recipe) -> tuple[Recipe, Shell]:
    """The shell to fill, at the lowest floor at which decimation leaves it in one piece.

    Such a floor may not exist, for instance if the input itself is in pieces; then the last floor is used.
    """
    shell = _shell(surface, recipe)
    for _ in range(MAX_FLOOR_RAISES):
        vertices, share = whole_part(shell.decimated)
        lost = lost_extent(surface.vertices, vertices)
        if share >= 1.0 - MAX_LOST_VOLUME and lost <= MAX_LOST_EXTENT:
            break
        recipe = replace(recipe, floor=recipe.floor * FLOOR_RAISE_FACTOR)
        shell = _shell(surface, recipe)
    return recipe, shell


def _shell(surface: Surface, recipe: Recipe) -> Shell:
    floor_m = recipe.floor * float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    raised = thicken(surface, floor_m)
    solid = wrap(raised.surface, floor_m / CELLS_PER_FLOOR)
    return Shell(floor_m, raised, volume(solid), decimate(solid, recipe.faces))


def _attempt(surface: Surface, shell: Shell, recipe: Recipe) -> TetMesh:
    result = run_limited(
        "galewood.sandbox.tetwild:tetrahedralise_surface",
        {
            "vertices": shell.decimated.vertices,
            "faces": shell.decimated.faces,
            "epsilon": np.array(recipe.floor * recipe.envelope),
            "edge_length": np.array(EDGE_LENGTH),
            "stop_energy": np.array(STOP_ENERGY),
            "passes": np.array(OPTIMISATION_PASSES),
        },
        TETWILD_LIMITS,
        what="Meshing the wood",
    )
    if not len(result["tets"]):
        raise MeshError(
            "not-meshable",
            "unsuitable",
            "The wood could not be meshed.",
            "Repair the mesh in a modelling program and try again.",
        )
    vertices, tets, dropped = largest_component(result["vertices"], result["tets"])
    meshed = float(np.abs(tet_volumes(result["vertices"], result["tets"])).sum())
    kept = float(tet_volumes(vertices, tets).sum())
    vertices, tets = _finished(vertices, tets, shell, recipe.fewest)
    ratio = radius_ratio(shell.raised, vertices, tets, shell.floor_m)
    report: dict[str, Any] = quality_report(vertices, tets) | {
        "components_dropped": dropped,
        "lost_volume": 1.0 - kept / meshed,
        "floor_radius_m": shell.floor_m,
        "thickened_share": float((ratio < 1).mean()),
        "lost_extent": lost_extent(surface.vertices, vertices),
        "surface_faces": len(shell.decimated.faces),
    }
    warnings: list[str] = []
    if dropped:
        share = report["lost_volume"]
        warnings.append(f"Meshing dropped {dropped} disconnected pieces ({share:.2%} of the wood).")
    report["warnings"] = warnings
    return TetMesh(vertices, np.ascontiguousarray(tets, dtype=np.int32), ratio, report)


def _finished(vertices: Floats, tets: Ints, shell: Shell, fewest: int) -> tuple[Floats, Ints]:
    """Restore the volume, split long edges if there are too few tets, and improve the worst tets."""
    vertices = restore_volume(vertices, tets, shell.volume_m3)
    vertices, tets = refined(vertices, tets, fewest)
    vertices = polished(vertices, tets, POLISHED_WITHIN * shell.floor_m)
    vertices = polished(vertices, tets, BAD_WITHIN * shell.floor_m, BAD_SHAPE)
    return restore_volume(vertices, tets, shell.volume_m3), tets
