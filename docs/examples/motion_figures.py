"""How far stems, branches and grass move in the winds of the page: a table of docs/design/0004-wind.md.

Run from the repository: ``python docs/examples/motion_figures.py docs/design/0004-wind.md``; a minute. The
last row is that of ``npm run --silent grass-motion`` in ``web``, which this script runs.
"""

import subprocess
import sys
from pathlib import Path

import galewood
import numpy as np
from galewood.check.evaluation.branches import outer_nodes, relative_to_trunk, trunk_nodes
from galewood.motion.wind import PRESETS, Wind, parse_wind
from galewood.packaged import species_folder
from galewood.util import Floats

RATE_HZ, LEAD_S, SPAN_S = 30.0, 10.0, 40.0
FAST_HZ = 1.0
TREES = 6
"""Of each kind, at places of their own; the table has their mean."""
LINES_PX, FIELD_DEG, AWAY_M = 720, 46.0, 15.0
PX_PER_CM = 0.01 * LINES_PX / (2.0 * AWAY_M * np.tan(np.radians(FIELD_DEG / 2.0)))
KINDS = ("poplar", "maple", "apricot", "poplar-forest", "maple-forest", "apricot-forest")
OPENING = parse_wind(
    {
        "version": 1,
        "model": "spectral",
        "length_scale_m": PRESETS["still"].length_scale_m,
        "convection_speed_m_s": 8.0,
        "mean_speed_m_s": 8.0,
        "direction_deg": 30.0,
        "gustiness": 0.7,
        "seed": 1,
    }
)
"""`DEFAULTS.wind` of web/src/page/settings/settings.ts."""
WINDS: dict[str, Wind] = {
    "opening view, 8 m/s": OPENING,
    "Breeze, 4 m/s": PRESETS["breeze"],
    "Gusts, 9 m/s": PRESETS["autumn-gusts"],
    "Storm front, 20 m/s": PRESETS["storm-front"],
}
BEGIN, END = "<!-- motion: written by docs/examples/motion_figures.py -->", "<!-- end of motion -->"


def moves_cm(track_m: Floats) -> tuple[float, float]:
    """Root mean square of (T, n, 3) about the mean, and its part above 1 Hz, cm; the median of the n points.

    The fast part is that of the spectrum of a Hann window: the ends of the track do not count as fast.
    """
    about = track_m - track_m.mean(axis=0)
    total = np.sqrt(np.square(about).sum(axis=2).mean(axis=0))
    window = np.hanning(len(about))
    power = np.square(np.abs(np.fft.rfft(about * window[:, None, None], axis=0))).sum(axis=2)
    fast = np.fft.rfftfreq(len(about), 1.0 / RATE_HZ) > FAST_HZ
    share = power[fast].sum(axis=0) / np.maximum(power[1:].sum(axis=0), 1e-30)
    return 100.0 * float(np.median(total)), 100.0 * float(np.median(total * np.sqrt(share)))


def figures(kind: str, wind: Wind) -> tuple[tuple[float, float], tuple[float, float]]:
    """Motion of the top of the stem and of the outer half of the crown relative to it, all and fast, cm."""
    table = galewood.load(species_folder() / "shipped" / f"{kind}.table")
    forest = galewood.Forest([table], galewood.grid(TREES, seed=7), wind)
    rest_m = table.table.node_rest_m.astype(np.float64)
    trunk, outer = trunk_nodes(table.table), outer_nodes(table.table)
    tracks: list[list[Floats]] = [[] for _ in range(TREES)]
    for step in range(round((LEAD_S + SPAN_S) * RATE_HZ)):
        forest.step(1.0 / RATE_HZ)
        if step >= LEAD_S * RATE_HZ:
            for tree, track in enumerate(tracks):
                track.append(forest.modal_coordinates(tree))
    stems, branches = [], []
    for track in tracks:
        track_m = np.einsum("nak,tk->tna", table.table.node_basis.astype(np.float64), np.stack(track))
        top = trunk[np.argmax(rest_m[trunk, 1])]
        stems.append(moves_cm(track_m[:, [top]]))
        branches.append(moves_cm(relative_to_trunk(rest_m, trunk, outer, track_m)))
    stem, branch = (np.mean(all_of, axis=0) for all_of in (stems, branches))
    return (float(stem[0]), float(stem[1])), (float(branch[0]), float(branch[1]))


def cell(total_cm: float, fast_cm: float) -> str:
    """Centimetres, then pixels."""
    return f"{total_cm:.1f}, {fast_cm:.2f} cm; {PX_PER_CM * total_cm:.1f}, {PX_PER_CM * fast_cm:.2f} px"


def main() -> None:
    """Write the table into the page that is named first."""
    lines = [f"| | {' | '.join(WINDS)} |", "|" + "---|" * (1 + len(WINDS))]
    for kind in KINDS:
        found = [figures(kind, wind) for wind in WINDS.values()]
        lines.append(f"| {kind}, branches | {' | '.join(cell(*branch) for _, branch in found)} |")
        lines.append(f"| {kind}, top of the stem | {' | '.join(cell(*stem) for stem, _ in found)} |")
        print("\n".join(lines[-2:]), flush=True)
    grass = subprocess.run(
        ["npm", "run", "--silent", "grass-motion"], cwd="web", check=True, capture_output=True, text=True
    )
    cells = [cell(*map(float, line.split())) for line in grass.stdout.split("\n") if line]
    lines.append(f"| tip of a blade of grass | {' | '.join(cells)} |")
    print(lines[-1])
    page = Path(sys.argv[1])
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    table = "\n".join(lines)
    page.write_text(f"{before}{BEGIN}\n{table}\n{END}{rest.split(END)[1]}", encoding="utf-8")


if __name__ == "__main__":
    main()
