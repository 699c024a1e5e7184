"""Errors of the shipped tables in gusts and in uniform winds: the table of docs/physics.md.

Run from the repository: ``python docs/examples/accuracy.py docs/physics.md data/cache build/accuracy``, with
the names of trees to evaluate only these. The last folder keeps the report of each tree; one with a report is
not evaluated again, and one without keeps its lines in the page. Takes minutes per tree.
"""

import json
import sys
from pathlib import Path
from typing import Any

from galewood.check.evaluation import run_evaluation
from galewood.options import EvaluationOptions
from galewood.packaged import species_folder
from galewood.pipeline.stages import BuiltinMesh, builtin_meshes, unpacked

BEGIN, END = "<!-- accuracy: written by docs/examples/accuracy.py -->", "<!-- end of accuracy -->"
GUSTS = ("7 m/s", "18 m/s", "10 % sway", "20 % sway")
HEAD = (
    "tree",
    "in gusts",
    "mean speed, m/s",
    "sway",
    "error, RMS",
    "error, largest",
    "branches",
    "uniform wind: largest",
)


def evaluate(mesh: BuiltinMesh, cache_dir: Path, kept: Path) -> None:
    """Write the report of a shipped tree's evaluation."""
    table = unpacked(mesh, species_folder(), cache_dir)
    options = EvaluationOptions(workers=1)
    found = run_evaluation(table, mesh.path, None, options, cache_dir, lambda done, what: None, plot=None)
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(found, default=float))


def rows_of(name: str, report: dict[str, Any]) -> list[str]:
    """The lines of the table for one tree; the last column is the worst of the seven uniform winds."""
    worst = max(
        (methods["modal"]["max_error"] for methods in report.get("uniform", {}).values()), default=None
    )
    lines: list[str] = []
    for k, wind in enumerate(GUSTS):
        case = report["gusts"][wind]
        modal = case["modal"]
        cells = (
            name if k == 0 else "", wind, f"{case['mean_speed_m_s']:.1f}",
            f"{100 * case['reference_sway']:.1f} %", f"{100 * modal['rms_error_of_rms_sway']:.0f} %",
            f"{100 * modal['max_error']:.1f} %", f"{modal['branches']:.2f}",
            "" if k else "to be measured" if worst is None else f"{100 * worst:.2f} %",
        )  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def lines_by_tree(table: str) -> dict[str, list[str]]:
    """The lines of the present table by tree, each of which has several."""
    found: dict[str, list[str]] = {}
    name = ""
    for line in table.strip().splitlines()[2:]:
        name = line.split("|")[1].strip() or name
        found.setdefault(name, []).append(line)
    return found


page, cache, reports = (Path(argument) for argument in sys.argv[1:4])
text = page.read_text(encoding="utf-8")
before, rest = text.split(BEGIN)
present, after = rest.split(END)
known = lines_by_tree(present)
names, lines = sys.argv[4:], [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
for tree in builtin_meshes(species_folder()):
    report = reports / f"{tree.name}.json"
    if not report.exists() and (tree.name in names or not names):
        evaluate(tree, cache, report)
    if report.exists():
        lines += rows_of(tree.name, json.loads(report.read_text()))
        print("\n".join(lines[-len(GUSTS) :]), flush=True)
    else:
        lines += known.get(tree.name, [f"| {tree.name} | to be measured |" + " |" * (len(HEAD) - 2)])
table = "\n".join(lines)
page.write_text(f"{before}{BEGIN}\n{table}\n{END}{after}", encoding="utf-8")
