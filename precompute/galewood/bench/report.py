"""The figures of ``galewood bench`` in words."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Figures = dict[str, Any]


def sentences(figures: Figures) -> list[str]:
    """A few lines for each part that was measured."""
    return [line for part, report in SENTENCES.items() if part in figures for line in report(figures[part])]


def _fem(f: Figures) -> list[str]:
    return [
        f"FEM step of {f['elements']:,} elements: {f['step_ms']:.2f} ms, with splu {f['step_splu_ms']:.1f} "
        f"ms ({f['faster_than_splu']:.1f} times); by the default scheme {f['default_step_ms']:.2f} ms"
    ]


def _samples(f: Figures) -> list[str]:
    return [
        f"{f['samples']:,} samples of {f['tree']}: {f['fast_cpu_s']:.1f} CPU seconds "
        f"({f['fast_samples_run']:,} were run)",
        f"  by the reference, quadratic elements: {f['reference_cpu_s']:.0f} CPU seconds "
        f"({f['reference_samples_run']} were run), {f['faster']:.0f} times as long",
    ]


def _build(f: Figures) -> list[str]:
    wall, cpu, peak, table = f["wall_s"], f["cpu_s"], f["peak_memory_mb"], f["table"]
    stages = ", ".join(f"{name} {wall[name]:.1f} ({cpu[name]:.1f})" for name in wall if name != "total")
    preliminary = ", ".join(f"{name} after {s:.0f} s" for name, s in f["handed_out_after_s"].items())
    return [
        f"Build of {f['tree']}: {wall['total']:.1f} s, {cpu['total']:.1f} CPU seconds",
        f"  by stages, seconds (CPU seconds): {stages}",
        f"  on the way: {preliminary}",
        f"  memory at most: {peak['parent']:.0f} MB in the build, {peak['largest_worker']:.0f} MB in a "
        f"worker, {peak['all_at_the_same_time']:.0f} MB in all at the same time",
        f"  table: {table['bytes'] / 1e6:.2f} MB, deflated {table['deflated_bytes'] / 1e6:.2f} MB, "
        f"zstd {table['zstd_bytes'] / 1e6:.2f} MB; raw Δu of its {table['records']:,} records "
        f"{table['raw_displacement_bytes'] / 1e6:.0f} MB",
    ]


def _lookup(f: Figures) -> list[str]:
    few, many = f["35"], f["435"]
    return [
        f"The paper's search, {f['frames_per_wind']} frames a wind in both tables: "
        f"{few['us_per_tree_step']:.2f} µs a tree with 35 sampled elements, "
        f"{many['us_per_tree_step']:.2f} µs with 435"
    ]


def _modal(f: Figures) -> list[str]:
    return [
        f"A step of {f['trees']:,} trees: {f['drift_free']['ms']:.1f} ms drift-free, "
        f"{f['paper']['ms']:.1f} ms by the paper's search"
    ]


def _wind(f: Figures) -> list[str]:
    models = ", ".join(f"{m} {of['median_ms']:.1f}" for m, of in f.items() if isinstance(of, dict))
    return [f"Wind at {f['trees']:,} trees, ms: {models}"]


SENTENCES: dict[str, Callable[[Figures], list[str]]] = {
    "fem": _fem,
    "samples": _samples,
    "build": _build,
    "lookup": _lookup,
    "modal": _modal,
    "wind": _wind,
}
