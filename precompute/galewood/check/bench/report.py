"""The results of ``galewood bench`` as sentences."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Figures = dict[str, Any]


def sentences(figures: Figures) -> list[str]:
    """A few lines for each part that was measured."""
    return [line for part, report in SENTENCES.items() if part in figures for line in report(figures[part])]


def _fem(f: Figures) -> list[str]:
    own_ms, rivals = f["factorisation_and_solve_ms"], f["rivals"]
    lines = [
        f"FEM step, {f['elements']:,} elements, {f['degrees_of_freedom']:,} degrees of freedom: "
        f"{f['step_ms']:.2f} ms with backward Euler, {f['default_step_ms']:.2f} ms with the default scheme",
        f"  factorisation and solve: {own_ms:.3f} ms",
    ]
    for name, rival in rivals.items():
        strongest = ", the fastest other solver" if name == f["strongest_rival"] else ""
        lines.append(
            f"  with {name}{strongest}: {rival['factorisation_and_solve_ms']:.2f} ms, "
            f"{rival['factorisation_and_solve_ratio']:.1f} times ours; "
            f"whole step {rival['step_ms']:.2f} ms, {rival['step_ratio']:.1f} times ours"
        )
    if f["missing_rivals"]:
        lines.append(
            f"  not compared, because not installed (requirements/dev.txt): {', '.join(f['missing_rivals'])}"
        )
    return lines


def _samples(f: Figures) -> list[str]:
    return [
        f"{f['samples']:,} samples of {f['tree']}: {f['fast_cpu_s']:.1f} CPU seconds with the fast elements "
        f"({f['fast_samples_run']:,} simulated)",
        f"  with the quadratic reference elements: {f['reference_cpu_s']:.0f} CPU seconds "
        f"({f['reference_samples_run']} simulated), {f['faster']:.0f} times as long",
    ]


def _upload(f: Figures) -> list[str]:
    return [
        f"Upload of {f['tree']}: read in {f['read_cpu_s']:.2f} CPU seconds, {f['read_ratio']:.1f} times "
        f"those of trimesh; with its first motion {f['first_motion_cpu_s']:.2f}, "
        f"{f['first_motion_ratio']:.1f} times those of trimesh"
    ]


def _build(f: Figures) -> list[str]:
    wall, cpu, peak, table = f["wall_s"], f["cpu_s"], f["peak_memory_mb"], f["table"]
    stages = ", ".join(f"{name} {wall[name]:.1f} ({cpu[name]:.1f})" for name in wall if name != "total")
    published = ", ".join(
        f"{name} after {of['wall_s']:.1f} ({of['cpu_s']:.1f})" for name, of in f["published"].items()
    )
    return [
        f"Build of {f['tree']}: {wall['total']:.1f} s, {cpu['total']:.1f} CPU seconds",
        f"  complete table after {f['complete_ratio']:.1f} times the {f['solve_cpu_s']:.1f} CPU seconds of "
        "the finite-element steps of its training runs",
        f"  by stage, seconds (CPU seconds): {stages}",
        f"  published, after seconds (CPU seconds): {published}",
        f"  peak memory: {peak['parent']:.0f} MB in the build process, {peak['largest_worker']:.0f} MB in "
        f"the largest worker, {peak['all_at_the_same_time']:.0f} MB in all processes together",
        f"  table: {table['bytes'] / 1e6:.2f} MB, deflated {table['deflated_bytes'] / 1e6:.2f} MB, "
        f"zstd {table['zstd_bytes'] / 1e6:.2f} MB; raw Δu of its {table['records']:,} records "
        f"{table['raw_displacement_bytes'] / 1e6:.0f} MB",
    ]


def _lookup(f: Figures) -> list[str]:
    few, many = f["35"], f["435"]
    return [
        f"Paper's state search, {f['frames_per_wind']} frames per wind in both tables: "
        f"{few['us_per_tree_step']:.2f} µs per tree and step with 35 sampled elements, "
        f"{many['us_per_tree_step']:.2f} µs with 435"
    ]


def _modal(f: Figures) -> list[str]:
    return [
        f"A step of {f['trees']:,} trees: {f['modal']['ms']:.1f} ms with the modal model, "
        f"{f['paper']['ms']:.1f} ms with the paper's state search"
    ]


def _wind(f: Figures) -> list[str]:
    models = ", ".join(f"{m} {of['median_ms']:.1f}" for m, of in f.items() if isinstance(of, dict))
    return [f"Wind at {f['trees']:,} trees, ms per frame: {models}"]


SENTENCES: dict[str, Callable[[Figures], list[str]]] = {
    "fem": _fem,
    "samples": _samples,
    "upload": _upload,
    "build": _build,
    "lookup": _lookup,
    "modal": _modal,
    "wind": _wind,
}
