"""``galewood paper``: repeats the experiments of the paper and sets the results beside its figures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from galewood.check.evaluation import (
    Source,
    error_figure,
    evaluate_in_gusts,
    evaluate_table,
    play_beyond_range,
    recorded_runs,
    samples_of,
    source_of,
)
from galewood.check.paper.gestures import Fig3, Fig5, paper_directions, paper_gestures
from galewood.check.paper.pictures import (
    draw_directions,
    draw_elements,
    draw_gestures,
    draw_winds,
    save_small,
)
from galewood.check.paper.plan import Notes, OnProgress, Plan, built
from galewood.check.paper.search import against_brute_force
from galewood.check.paper.speed import by_elements, forests, memory
from galewood.check.paper.text import write_text
from galewood.options import EVALUATION_PEAK_RATIO, EvaluationOptions
from galewood.pipeline.stages import BuiltinMesh
from galewood.table import Table


@dataclass(frozen=True)
class Tree:
    """A tree's table and its source; ``content`` identifies the table in the cache."""

    table: Table
    table_bytes: int
    source: Source
    content: str


def run_paper(plan: Plan, out: Path, on_progress: OnProgress) -> dict[str, Any]:
    """Run all experiments and write ``out`` (Markdown) with its pictures beside it.

    Returns the figures, JSON-able. Timings are measured anew in every run; the other figures may come from
    the cache.
    """
    notes = Notes(plan)
    trees: dict[str, Tree] = {}
    figures: dict[str, Any] = {"trees": {}, "plan": _plan_figures(plan)}
    steps = len(plan.meshes)
    for k, mesh in enumerate(plan.meshes):
        name = mesh.name
        sub_progress = _part(on_progress, 0.9 * k / steps, 0.9 * (k + 1) / steps, name)
        trees[name] = _ready(plan, notes, mesh, _part(sub_progress, 0.0, 0.3))
        figures["trees"][name] = _measure(plan, notes, name, trees[name], out, _part(sub_progress, 0.3, 1.0))
    on_progress(0.9, "Forests of many trees")
    tables = {name: tree.table for name, tree in trees.items()}
    figures["forests"] = forests(plan, tables)
    folder = out.with_suffix("")
    draw_winds(next(iter(tables.values())), plan, folder / "winds.svg")
    elements = {name: found["elements"] for name, found in figures["trees"].items()}
    draw_elements(elements, plan.elements, folder / "elements.svg")
    write_text(figures, plan, out)
    on_progress(1.0, "Done")
    return figures


def _plan_figures(plan: Plan) -> dict[str, Any]:
    return {
        "frames": plan.frames,
        "record_frames": plan.record_frames,
        "elements": list(plan.elements),
        "element_frames": plan.element_frames,
        "trees": list(plan.trees),
        "queries": plan.queries,
        "seed": plan.seed,
        "strength": EVALUATION_PEAK_RATIO,
        "quick": plan.quick,
    }


def _ready(plan: Plan, notes: Notes, mesh: BuiltinMesh, on_progress: OnProgress) -> Tree:
    table, path, render_glb = built(plan, notes, mesh, _part(on_progress, 0.0, 0.8))
    source = source_of(table, render_glb, plan.cache_dir, _part(on_progress, 0.8, 1.0), workers=plan.workers)
    return Tree(table, path.stat().st_size, source, path.stem)


def _measure(
    plan: Plan, notes: Notes, name: str, tree: Tree, out: Path, on_progress: OnProgress
) -> dict[str, Any]:
    table, source, folder = tree.table, tree.source, out.with_suffix("")
    on_progress(0.0, "Fig. 3 and 5: gestures")
    gestures: Fig3 = paper_gestures(plan, table, source)
    directions: Fig5 = paper_directions(plan, table, source)
    draw_gestures(gestures, table, source, folder / f"gestures-{name}.png")
    if name == plan.meshes[0].name:
        draw_directions(directions, table, source, folder / f"directions-{name}.png")
    in_gusts = notes.kept("gusts", tree.content, lambda: _gusts(plan, tree, _part(on_progress, 0.1, 0.3)))
    winds = notes.kept("winds", tree.content, lambda: _unseen(plan, tree, _part(on_progress, 0.3, 0.5)))
    save_small(error_figure(winds), folder / f"errors-{name}.png")
    elements = by_elements(notes, table, source, tree.content, _part(on_progress, 0.5, 0.8))
    search = notes.kept(
        "search", tree.content, lambda: _search_differences(plan, tree, _part(on_progress, 0.8, 1.0))
    )
    return {
        "height_m": table.metadata["height_m"],
        "design_speed_m_s": table.metadata["design_speed_m_s"],
        "tetrahedra": len(source.mesh.tets),
        "modes": source.subspace.modes,
        "gestures": gestures.figures,
        "directions": directions.figures,
        "gusts": in_gusts,
        "winds": winds,
        "elements": elements,
        "search": search,
        "memory": memory(table, tree.table_bytes, source),
        "beyond": play_beyond_range(table, source, frames=1800 if not plan.quick else 200),
    }


def _gusts(plan: Plan, tree: Tree, on_progress: OnProgress) -> dict[str, Any]:
    options = EvaluationOptions(frames=plan.frames, seed=plan.seed, workers=plan.workers)
    return evaluate_in_gusts(tree.table, tree.source, options, plan.cache_dir, on_progress)


def _unseen(plan: Plan, tree: Tree, on_progress: OnProgress) -> dict[str, Any]:
    options = EvaluationOptions(
        frames=plan.frames, strength=EVALUATION_PEAK_RATIO, seed=plan.seed, workers=plan.workers
    )
    return evaluate_table(tree.table, tree.source, options, plan.cache_dir, on_progress)


def _search_differences(plan: Plan, tree: Tree, on_progress: OnProgress) -> dict[str, int]:
    source = tree.source
    samples = samples_of(tree.table, source.model, source.mesh, plan.cache_dir, plan.workers)
    return against_brute_force(plan, tree.table, recorded_runs(samples, plan.workers), on_progress)


def _part(on_progress: OnProgress, first: float, last: float, name: str = "") -> OnProgress:
    """Map progress 0..1 to ``first``..``last`` of the whole and prefix its messages with a name."""
    prefix = f"{name}: " if name else ""
    return lambda fraction, message: on_progress(
        first + (last - first) * fraction,
        message if message.startswith(prefix) else prefix + message,
    )
