"""Export built-in trees for MuJoCo, run them there, and print the figures as rows of Markdown tables.

python docs/examples/mujoco_figures.py [NAME ...]       for example: poplar apricot.bare
python docs/examples/mujoco_figures.py urdf [NAME ...]  the same as URDF: bodies, frequency, ring-down, files
python docs/examples/mujoco_figures.py gusts [NAME ...] a minute in gusts, against the table

The rows are those of docs/how-to/export-mujoco.md and docs/how-to/export-urdf.md, which
tests/docs/test_mujoco_figures.py holds against them.
"""

from __future__ import annotations

import sys
import tempfile
import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from galewood.io.export import write_export
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.rigid.solid import Solid
from galewood.io.export.rigid.targets import changed_by_foliage, oscillators
from galewood.motion.wind import PRESETS
from galewood.pipeline.results import read_compliance
from galewood.table import Table, decode, decode_compliance

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.precompute.fixtures.mujoco_trees import (
    Gusty,
    Linear,
    blown,
    deflection_errors,
    in_gusts,
    linearised,
    ring_down,
    sprung,
    wood_rings,
)

SHIPPED_FOLDER = Path(__file__).parents[2] / "assets/species/shipped"
POINT_COUNT, RANDOM_SEED, CHECKED_MODES, WIND_M_S, WIND_S = 50, 20261126, 5, 8, 20.0
GUSTY_WINDS = ("autumn-gusts", "storm-front")
GUSTY_S, SETTLED_S = 60.0, 20.0
TREE_NAMES = (
    "apricot",
    "apricot-forest",
    "apricot-forest.bare",
    "maple",
    "maple-forest",
    "poplar",
    "poplar-forest",
)


@dataclass(frozen=True)
class Shipped:
    """A built-in tree."""

    table: Table
    glb: bytes
    compliance: bytes | None

    @staticmethod
    def read(name: str) -> Shipped:
        """The tree of a name, which may end with .bare."""
        path = SHIPPED_FOLDER / f"{name}.table"
        glb = (SHIPPED_FOLDER / f"{name.removesuffix('.bare')}.glb").read_bytes()
        return Shipped(decode(path.read_bytes()), glb, read_compliance(path))

    @property
    def rest_m(self) -> Any:
        """(v, 3) the drawn vertices."""
        return GltfFile(self.glb, self.table).rest_m()

    def exported(self, kind: str) -> tuple[dict[str, Any], Any, float]:
        """The description of an export, MuJoCo's model of it, and the size of the files, MB."""
        with tempfile.TemporaryDirectory() as text:
            folder = Path(text)
            told = write_export(self.table, self.glb, kind, folder, "tree", compliance=self.compliance)
            size = sum(file.stat().st_size for file in folder.iterdir())
            if kind == "urdf":
                return told, sprung(folder / "tree.urdf"), size / 1e6
            return told, mujoco.MjModel.from_xml_path(str(folder / "tree.xml")), size / 1e6


def main() -> None:
    """Print rows of each tree."""
    asked = sys.argv[1:]
    kinds = {"urdf": urdf_row, "gusts": gust_rows}
    printed, asked = (kinds[asked[0]], asked[1:]) if asked and asked[0] in kinds else (row, asked)
    for name in asked or TREE_NAMES:
        print(printed(name), flush=True)


def urdf_row(name: str) -> str:
    """The figures of one tree as URDF."""
    tree = Shipped.read(name)
    told, model, size_mb = tree.exported("urdf")
    frequency, damping = modal_errors(model, linearised(model), tree.table, tree.rest_m)
    return f"| {name} | {told['bodies']} | {frequency:.2f} % | {damping:.1f} % | {size_mb:.1f} MB |"


def gust_rows(name: str) -> str:
    """A row for each wind: RMS sway of the top, what it consists of, and how far both are apart."""
    tree, found = Shipped.read(name), list[str]()
    told, model, _ = tree.exported("mjcf")
    for wind in GUSTY_WINDS:
        found.append(gust_row(tree, told, model, name, wind))
    return "\n".join(found)


def gust_row(tree: Shipped, told: dict[str, Any], model: Any, name: str, wind: str) -> str:
    """The row of one wind."""
    blows = PRESETS[wind]
    gusty = in_gusts(model, told, tree.table, tree.rest_m, blows, GUSTY_S, SETTLED_S)
    assert gusty.warnings == 0
    heading = np.radians(blows.direction_deg)
    along = np.array([np.cos(heading), -np.sin(heading), 0.0])
    across = np.array([np.sin(heading), np.cos(heading), 0.0])
    sways = [gusty.sways(direction) for direction in (along, across)]
    cells = [f"{own.std():.2f}, {given.std():.2f} m" for own, given in sways]
    ratios = band_ratios(gusty, along, float(tree.table.metadata["frequencies_hz"][0]))
    cells.append(", ".join(f"{ratio:.2f}" for ratio in ratios))
    apart = [100 * (own - given).std() / given.std() for own, given in sways]
    cells.append(", ".join(f"{percent:.0f} %" for percent in apart))
    return f"| {name} | {wind} | {' | '.join(cells)} |"


def band_ratios(gusty: Gusty, along: Any, first_hz: float) -> list[float]:
    """RMS of MuJoCo over that of the table: below half the first frequency, up to twice it, and above."""
    own, given = (np.abs(np.fft.rfft(track)) for track in gusty.sways(along))
    frequency = np.fft.rfftfreq(len(gusty.by_table), gusty.dt_s)
    edges = (0.0, 0.5 * first_hz, 2 * first_hz, np.inf)
    bands = [(frequency >= low) & (frequency < high) for low, high in pairwise(edges)]
    return [float(np.linalg.norm(own[band]) / np.linalg.norm(given[band])) for band in bands]


def modal_errors(model: Any, linear: Linear, table: Table, rest_m: Any) -> tuple[float, float]:
    """Worst errors, %, of the first frequencies and of their ring-down against the table's damping."""
    given = np.array(table.metadata["frequencies_hz"][:CHECKED_MODES])
    frequency = 100 * np.abs(linear.frequency_hz[:CHECKED_MODES] / given - 1).max()
    alpha, beta = oscillators(table, rest_m).rayleigh()
    omega = 2 * np.pi * given
    found = ring_down(model, linear, CHECKED_MODES)
    damping = 100 * np.abs(found / (0.5 * (alpha / omega + beta * omega)) - 1).max()
    return float(frequency), float(damping)


def row(name: str) -> str:
    """The figures of one tree."""
    tree = Shipped.read(name)
    table, data = tree.table, tree.compliance
    told, model, size_mb = tree.exported("mjcf")
    rest_m = tree.rest_m
    own, solid = oscillators(table, rest_m), Solid(decode_compliance(data or b""))
    linear = linearised(model)
    frequency, damping = modal_errors(model, linear, table, rest_m)
    rng, cells = np.random.default_rng(RANDOM_SEED), list[str]()
    for least in (3, 1):
        rings = wood_rings(table, solid.binding, least, POINT_COUNT, rng)
        shares = np.stack([np.asarray(solid.binding[ring].mean(axis=0)).ravel() for ring in rings])
        yields = solid.response(shares)
        if table.foliage == "bare":
            shape = np.stack([own.shape[ring].mean(axis=0) for ring in rings])
            yields += changed_by_foliage(solid, shares, shape / own.omega)
        off = 100 * deflection_errors(model, linear, table, rest_m, rings, yields, rng)
        cells.append(f"{np.median(off):.1f} %, {np.quantile(off, 0.9):.1f} %, {(off < 5).sum()}")
    begin_s = time.process_time()
    sway = blown(model, told, table, rest_m, WIND_M_S, WIND_S)
    ms = (time.process_time() - begin_s) / (WIND_S / model.opt.timestep) * 1e3
    assert sway.warnings == 0
    last = slice(len(sway.by_table) // 2, None)
    ends = [np.linalg.norm(track[last].mean(axis=0)) for track in (sway.by_mujoco, sway.by_table)]
    most = [np.linalg.norm(track, axis=1).max() for track in (sway.by_mujoco, sway.by_table)]
    return (
        f"| {name} | {told['bodies']} | {frequency:.2f} % | {damping:.1f} % | {' | '.join(cells)} | "
        f"{ends[0]:.2f}, {ends[1]:.2f} m; {most[0]:.2f}, {most[1]:.2f} m | {ms:.1f} ms | {size_mb:.1f} MB |"
    )


if __name__ == "__main__":
    main()
