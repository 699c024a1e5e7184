"""Export built-in trees for MuJoCo, run them there, and print the errors as rows of a Markdown table.

python docs/examples/mujoco_figures.py [NAME ...]      for example: poplar apricot.bare
python docs/examples/mujoco_figures.py urdf [NAME ...] the same as URDF: bodies, frequency, ring-down, files
"""

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from galewood.io.export import write_export
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.rigid.solid import Solid
from galewood.io.export.rigid.targets import changed_by_foliage, oscillators
from galewood.pipeline.results import read_compliance
from galewood.table import Table, decode, decode_compliance

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.precompute.fixtures.mujoco_trees import (
    Linear,
    blown,
    deflection_errors,
    linearised,
    ring_down,
    sprung,
    wood_rings,
)

SHIPPED_FOLDER = Path(__file__).parents[2] / "assets/species/shipped"
POINT_COUNT, RANDOM_SEED, CHECKED_MODES, WIND_M_S, WIND_S = 50, 20261126, 5, 8, 20.0


def main() -> None:
    """Print a row per tree."""
    asked = sys.argv[1:]
    printed, asked = (urdf_row, asked[1:]) if asked[:1] == ["urdf"] else (row, asked)
    names = asked or sorted(path.name.removesuffix(".table") for path in SHIPPED_FOLDER.glob("*.table"))
    for name in names:
        print(printed(name), flush=True)


def urdf_row(name: str) -> str:
    """The figures of one tree as URDF."""
    path = SHIPPED_FOLDER / f"{name}.table"
    table, data = decode(path.read_bytes()), read_compliance(path)
    glb = (SHIPPED_FOLDER / f"{name.removesuffix('.bare')}.glb").read_bytes()
    with tempfile.TemporaryDirectory() as text:
        folder = Path(text)
        told = write_export(table, glb, "urdf", folder, "tree", compliance=data)
        size = sum(file.stat().st_size for file in folder.iterdir())
        model = sprung(folder / "tree.urdf")
    frequency, damping = modal_errors(model, linearised(model), table, GltfFile(glb, table).rest_m())
    return f"| {name} | {told['bodies']} | {frequency:.2f} % | {damping:.1f} % | {size / 1e6:.1f} MB |"


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
    path = SHIPPED_FOLDER / f"{name}.table"
    table, data = decode(path.read_bytes()), read_compliance(path)
    glb = (SHIPPED_FOLDER / f"{name.removesuffix('.bare')}.glb").read_bytes()
    with tempfile.TemporaryDirectory() as text:
        folder, begin_s = Path(text), time.process_time()
        told = write_export(table, glb, "mjcf", folder, "tree", compliance=data)
        export_s = time.process_time() - begin_s
        size = sum(file.stat().st_size for file in folder.iterdir())
        model = mujoco.MjModel.from_xml_path(str(folder / "tree.xml"))
    rest_m = GltfFile(glb, table).rest_m()
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
        soft = np.trace(yields, axis1=1, axis2=2) > 0.01 * np.trace(yields, axis1=1, axis2=2).max()
        cells.append(
            f"{np.median(off):.1f} %, {np.quantile(off, 0.9):.1f} %, {(off < 5).sum()} of {len(off)} "
            f"({(off < 5)[soft].sum()} of {soft.sum()})"
        )
    begin_s = time.process_time()
    sway = blown(model, told, table, rest_m, WIND_M_S, WIND_S)
    ms = (time.process_time() - begin_s) / (WIND_S / model.opt.timestep) * 1e3
    last = slice(len(sway.by_table) // 2, None)
    ends = [np.linalg.norm(track[last].mean(axis=0)) for track in (sway.by_mujoco, sway.by_table)]
    most = [np.linalg.norm(track, axis=1).max() for track in (sway.by_mujoco, sway.by_table)]
    return (
        f"| {name} | {told['bodies']} | {frequency:.2f} % | {damping:.1f} % | {' | '.join(cells)} | "
        f"{ends[0]:.2f}, {ends[1]:.2f} m; {most[0]:.2f}, {most[1]:.2f} m | {sway.warnings} | {ms:.2f} ms | "
        f"{export_s:.0f} s, {size / 1e6:.1f} MB |"
    )


if __name__ == "__main__":
    main()
