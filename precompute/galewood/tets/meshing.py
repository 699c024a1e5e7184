"""A tree's wood as tetrahedra: thickened to what the mesher resolves, wrapped to one solid, meshed,
checked, kept.

Recipe: radii below a floor are raised (and the ratio remembered per tet), a distance grid gives one
closed surface,
decimation sets the number of tets, fTetWild fills it, and the surface is let out again by what the two
took away.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from galewood.mesh import Surface, TreeMesh, volume
from galewood.sandbox import Limits, run_limited
from galewood.tets.cache import cache_key, cached_path, load_cached, store_cached
from galewood.tets.quality import largest_component, lost_extent, quality_report, restore_volume, tet_volumes
from galewood.tets.radius_ratio import radius_ratio
from galewood.tets.thicken import thicken
from galewood.tets.wrap import decimate, wrap
from galewood.util import Floats, Int32s, MeshError

FLOOR = 2.8e-3  # smallest radius, of the diagonal
ENVELOPE = 0.3  # fTetWild's envelope, of the floor: a finer one keeps more tets
CELLS_PER_FLOOR = 1.5
EDGE_LENGTH = 0.05  # of the diagonal
STOP_ENERGY = 30.0
TETS_PER_FACE = 0.95
FEWEST, MOST = 0.55, 1.45  # of the target
MAX_LOST_EXTENT = 0.03
MAX_LOST_VOLUME = 1e-3  # in pieces that came loose
ATTEMPTS = 4
TETWILD_LIMITS = Limits(memory_bytes=6 << 30, cpu_s=150, wall_s=200.0)


@dataclass(frozen=True)
class TetMesh:
    """vertices_m (n, 3), tets (m, 4) of positive volume, radius_ratio (m,): original over thickened
    radius."""

    vertices_m: Floats
    tets: Int32s
    radius_ratio: Floats
    report: dict[str, Any]


@dataclass(frozen=True)
class Recipe:
    """What is turned when an attempt fails: `floor` of the diagonal, `envelope` of the floor."""

    faces: int
    floor: float = FLOOR
    envelope: float = ENVELOPE


def tetrahedralise(tree: TreeMesh, target_tets: int = 5500, cache_dir: Path | None = None) -> TetMesh:
    """One connected solid of about `target_tets` tetrahedra; MeshError 422 where none can be made.

    pytetwild is not deterministic, so a mesh once made is kept in `cache_dir` under the hash of its input.
    """
    if not 500 <= target_tets <= 60_000:
        raise MeshError(
            "bad-target", "unsuitable", f"{target_tets} tetrahedra are not offered.", "Ask for 500 to 60,000."
        )
    key = cache_key(tree.wood_vertices_m, tree.wood_faces, target_tets)
    cached = load_cached(cache_dir, key)
    if cached is not None:
        return TetMesh(*cached)
    mesh = _attempts(Surface(tree.wood_vertices_m, tree.wood_faces), target_tets)
    store_cached(cache_dir, key, mesh.vertices_m, mesh.tets, mesh.radius_ratio, mesh.report)
    return mesh


def kept_tetrahedra(tree: TreeMesh, target_tets: int, cache_dir: Path) -> Path:
    """The file in which `tetrahedralise` keeps its mesh: who has it elsewhere goes on with the same mesh."""
    return cached_path(cache_dir, cache_key(tree.wood_vertices_m, tree.wood_faces, target_tets))


def _attempts(surface: Surface, target_tets: int) -> TetMesh:
    recipe = Recipe(faces=round(target_tets / TETS_PER_FACE))
    tried: list[str] = []
    best: TetMesh | None = None
    for _ in range(ATTEMPTS):
        mesh = _attempt(surface, recipe)
        count, lost = len(mesh.tets), mesh.report["lost_extent"]
        tried.append(f"floor {recipe.floor:.4f}, {recipe.faces} faces: {count} tets, {lost:.1%} lost")
        if best is None or _badness(mesh, target_tets) < _badness(best, target_tets):
            best = mesh
        if _badness(mesh, target_tets) == 0:
            break
        if lost > MAX_LOST_EXTENT:
            recipe = replace(recipe, floor=recipe.floor * 1.4)
        elif mesh.report["lost_volume"] > MAX_LOST_VOLUME:
            recipe = replace(recipe, floor=recipe.floor * 1.2)
        else:
            recipe = _towards(recipe, target_tets / count)
    assert best is not None
    if best.report["lost_extent"] > 3 * MAX_LOST_EXTENT:
        raise MeshError(
            "not-meshable", "unsuitable", f"Meshing loses {best.report['lost_extent']:.0%} of the wood.",
            "The branches may not touch the trunk; join them and try again.",
        )  # fmt: skip
    best.report["attempts"] = tried
    if best.report["lost_extent"] > MAX_LOST_EXTENT:
        best.report["warnings"].append(
            f"{best.report['lost_extent']:.1%} of the wood's extent was lost in meshing."
        )
    return best


def _towards(recipe: Recipe, wanted: float) -> Recipe:
    """The recipe for `wanted` times as many tets: a finer envelope first, as more faces alone are
    collapsed again."""
    faces = round(recipe.faces * float(np.clip(wanted, 0.4, 1.3)))
    return replace(recipe, faces=faces, envelope=recipe.envelope * (0.5 if wanted > 1 else 1.2))


def _badness(mesh: TetMesh, target_tets: int) -> float:
    """0 where the mesh is accepted, else how far off it is."""
    share = len(mesh.tets) / target_tets
    off = max(FEWEST - share, share - MOST, 0.0)
    off += 10.0 * max(mesh.report["lost_volume"] - MAX_LOST_VOLUME, 0.0)
    return off + 10.0 * max(mesh.report["lost_extent"] - MAX_LOST_EXTENT, 0.0)


def _attempt(surface: Surface, recipe: Recipe) -> TetMesh:
    diagonal = float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    floor_m = recipe.floor * diagonal
    raised = thicken(surface, floor_m)
    solid = wrap(raised.surface, floor_m / CELLS_PER_FLOOR)
    shell = decimate(solid, recipe.faces)
    result = run_limited(
        "galewood.sandbox.tetwild:tetrahedralise_surface",
        {
            "vertices": shell.vertices,
            "faces": shell.faces,
            "epsilon": np.array(recipe.floor * recipe.envelope),
            "edge_length": np.array(EDGE_LENGTH),
            "stop_energy": np.array(STOP_ENERGY),
        },
        TETWILD_LIMITS,
        what="Meshing the wood",
    )
    if not len(result["tets"]):
        raise MeshError(
            "not-meshable", "unsuitable", "The wood could not be meshed.", "Repair the mesh and try again."
        )
    vertices, tets, dropped = largest_component(result["vertices"], result["tets"])
    meshed = float(np.abs(tet_volumes(result["vertices"], result["tets"])).sum())
    kept = float(tet_volumes(vertices, tets).sum())
    vertices = restore_volume(vertices, tets, volume(solid))
    ratio = radius_ratio(raised, vertices, tets, floor_m)
    report: dict[str, Any] = quality_report(vertices, tets) | {
        "components_dropped": dropped,
        "lost_volume": 1.0 - kept / meshed,
        "floor_radius_m": floor_m,
        "thickened_share": float((ratio < 1).mean()),
        "lost_extent": lost_extent(surface.vertices, vertices),
        "surface_faces": len(shell.faces),
    }
    warnings: list[str] = []
    if dropped:
        share = report["lost_volume"]
        warnings.append(f"{dropped} loose pieces, {share:.2%} of the wood, were dropped in meshing.")
    report["warnings"] = warnings
    return TetMesh(vertices, np.ascontiguousarray(tets, dtype=np.int32), ratio, report)
