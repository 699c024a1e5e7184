"""Errors of the shipped tables in gusts, in leaf and bare: the second table of docs/physics.md.

Run from the repository: ``python docs/examples/gust_accuracy.py docs/physics.md data/cache build/gusts``. The
last folder keeps the figures of each table; one with figures is not measured again.
"""

import json
import sys
from pathlib import Path
from typing import Any

from galewood.check.evaluation.gusts import evaluate_in_gusts, gust_cases
from galewood.check.evaluation.model_file import model_file
from galewood.check.paper import PAPER_SPECIES
from galewood.options import EvaluationOptions
from galewood.packaged import species_folder
from galewood.pipeline.results import SHIPPED_FOLDER, read_shipped
from galewood.pipeline.stages import BuiltinMesh, builtin_meshes
from galewood.table import decode

SEED = 48113
BEGIN, END = (
    "<!-- leaf and bare: written by docs/examples/gust_accuracy.py -->",
    "<!-- end of leaf and bare -->",
)
WINDS = ("7 m/s", "18 m/s")
HEAD = ("tree", "sway", "error, RMS", "floor", "error, largest", "branches")


def measured(mesh: BuiltinMesh, *, bare: bool, cache_dir: Path) -> dict[str, Any]:
    """Figures of a shipped table by wind."""
    shipped = read_shipped(species_folder() / SHIPPED_FOLDER, mesh.name, mesh.key)
    if shipped is None:
        raise FileNotFoundError(f"no shipped files for {mesh.name} and this version: run `galewood ship`")
    shipped.keep_tetrahedra(cache_dir)
    data = shipped.result.bare_table if bare else shipped.result.table
    if data is None:
        raise FileNotFoundError(f"no shipped table of the bare {mesh.name}: run `galewood ship`")
    table = decode(data)
    options = EvaluationOptions(workers=1, seed=SEED)
    cases = {wind: case for wind, case in gust_cases(options).items() if wind in WINDS}
    source = model_file(table, mesh.path, cache_dir)
    return evaluate_in_gusts(table, source, options, cache_dir, lambda done, what: None, cases)


def line_of(name: str, cases: dict[str, Any]) -> str:
    """One line of the table; each cell has the figures of both winds."""
    found = [cases[wind] for wind in WINDS]
    modal = [case["modal"] for case in found]
    cells = (
        [f"{100 * case['reference_sway']:.0f} %" for case in found],
        [f"{100 * own['rms_error_of_rms_sway']:.0f} %" for own in modal],
        [f"{100 * case['floor']['rms_error_of_rms_sway']:.0f} %" for case in found],
        [f"{100 * own['max_error']:.1f} %" for own in modal],
        [f"{own['branches']:.2f}" for own in modal],
    )
    return f"| {name} | {' | '.join(', '.join(cell) for cell in cells)} |"


page, cache, reports = (Path(argument) for argument in sys.argv[1:4])
reports.mkdir(parents=True, exist_ok=True)
lines = [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
for tree in builtin_meshes(species_folder()):
    if tree.options["species"] not in PAPER_SPECIES:
        continue
    for foliage in ("leaf", "bare"):
        report = reports / f"{tree.name}.{foliage}.json"
        if not report.exists():
            figures = measured(tree, bare=foliage == "bare", cache_dir=cache)
            report.write_text(json.dumps(figures, default=float))
        kept = json.loads(report.read_text())
        lines.append(line_of(f"{tree.name}, {'in leaf' if foliage == 'leaf' else 'bare'}", kept))
        print(lines[-1], flush=True)
text = page.read_text(encoding="utf-8")
before, rest = text.split(BEGIN)
table_lines = "\n".join(lines)
page.write_text(f"{before}{BEGIN}\n{table_lines}\n{END}{rest.split(END)[1]}", encoding="utf-8")
