"""Sway of exported trees in the programs that move them, beside the table's own, as pictures of docs/how-to.

Run from the repository: ``python docs/examples/live_plots.py docs/images``. It writes live-sway.svg (the GLB
of `--to live` in Babylon.js), mujoco-release.svg and mujoco-gusts.svg (`--to mjcf` in MuJoCo), and prints
the errors.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import matplotlib as mpl
import mujoco
import numpy as np
from galewood.io.export import ExportOptions, write_export
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.rigid.targets import oscillators
from galewood.io.export.skeletal.radii import wood_vertices
from galewood.motion.wind import PRESETS, Wind, WindField
from galewood.pipeline.results import read_compliance
from galewood.player import WindDrivenTrees
from galewood.solid.skinning import drawn_positions
from galewood.table import Table, decode
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from scipy.linalg import cho_solve

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.precompute.fixtures.mujoco_trees import body_of, in_gusts, linearised, upright

REPOSITORY = Path(__file__).parents[2]
TREE_PATH = REPOSITORY / "assets/species/shipped/poplar.table"
BABYLON_PLAYER = REPOSITORY / "tests/precompute/io/babylonLive.mjs"
SECONDS = 20.0
SETTLED_S = 10.0
"""Before the time that is shown: both begin at rest."""
WIND = Wind(mean_speed_m_s=8.0, model="cosine")
GUSTS = "autumn-gusts"
RELEASED_M, RELEASED_S = 0.05, 12.0
"""Deflection of the top from which MuJoCo's tree is released, and how long it is followed."""
OWN_COLOUR, TABLE_COLOUR = "#d1495b", "#2a6f4e"


def main() -> None:
    """Write both pictures."""
    folder = Path(sys.argv[1])
    table, glb = decode(TREE_PATH.read_bytes()), TREE_PATH.with_suffix(".glb").read_bytes()
    rest_m = GltfFile(glb, table).rest_m()
    top = top_of(table, rest_m)
    height_m = float(table.metadata["height_m"])
    for name, drawn, curves in (
        ("live-sway", "Babylon.js", in_babylon(table, glb, rest_m, top)),
        ("mujoco-release", "MuJoCo", in_mujoco(table, glb, rest_m, top)),
        ("mujoco-gusts", "MuJoCo", in_mujocos_gusts(table, glb, rest_m)),
    ):
        time_s, found, given = curves
        apart = np.linalg.norm(found - given, axis=1)
        reach = np.linalg.norm(given, axis=1).max()
        rms = float(np.sqrt(np.square(apart).mean()))
        print(
            f"{name}: largest error {100 * apart.max() / height_m:.2g} % of the height, RMS "
            f"{100 * rms / height_m:.2g} %, at displacements of up to {100 * reach / height_m:.2g} %"
        )
        plot(folder / f"{name}.svg", drawn, time_s, found, given)


def top_of(table: Table, rest_m: Any) -> int:
    """The highest vertex of the wood."""
    wood = wood_vertices(table)
    return int(wood[np.argmax(rest_m[wood, 1])])


def in_babylon(table: Table, glb: bytes, rest_m: Any, top: int) -> tuple[Any, Any, Any]:
    """Times (T,), s, and displacements (T, 3) of the top, m, by Babylon.js and by the table, in one wind."""
    dt_s = float(table.metadata["dt_s"])
    steps, first = round((SETTLED_S + SECONDS) / dt_s), round(SETTLED_S / dt_s)
    with tempfile.TemporaryDirectory() as text:
        folder = Path(text)
        write_export(table, glb, "live", folder, "tree", ExportOptions(wind=WIND, seconds=1.0))
        asked = {"frame_s": dt_s, "frames": steps, "vertices": [top], "tracked": True}
        (folder / "request.json").write_text(json.dumps(asked))
        command = ["node", str(BABYLON_PLAYER), str(folder / "tree.glb"), str(folder / "request.json")]
        done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=True)
    found = np.array(json.loads(done.stdout.splitlines()[-1])["track"])[:, 0]
    tree, field = WindDrivenTrees(table, [[0.0, 0.0, 0.0, 1.0]]), WindField(WIND)
    given = np.zeros((steps, 3))
    for k in range(steps):
        tree.step(field, dt_s * (k + 1), dt_s * (1 + 1e-12))
        given[k] = drawn_positions(table, rest_m, tree.q[0])[top]
    shown = slice(first, None)
    return dt_s * np.arange(steps - first), (found - rest_m[top])[shown], (given - rest_m[top])[shown]


def in_mujoco(table: Table, glb: bytes, rest_m: Any, top: int) -> tuple[Any, Any, Any]:
    """The same of a tree that is pulled at the top and released, without air, by MuJoCo and by the table.

    That of the table is the exact motion of its oscillators with the damping that it states for them.
    """
    with tempfile.TemporaryDirectory() as text:
        compliance = read_compliance(TREE_PATH)
        write_export(table, glb, "mjcf", Path(text), "tree", compliance=compliance)
        model = mujoco.MjModel.from_xml_path(str(Path(text) / "tree.xml"))
    own = oscillators(table, rest_m)
    yields = (own.shape[top, 0] / own.omega) ** 2
    force_n = RELEASED_M / float(yields.sum())
    model.opt.density = 0.0
    data, linear = mujoco.MjData(model), linearised(model)
    mujoco.mj_forward(model, data)
    body, place = body_of(model, table, top), upright(rest_m[top])
    local, pulled = place - data.xpos[body], np.zeros(model.nv)
    mujoco.mj_applyFT(model, data, np.array([force_n, 0, 0]), np.zeros(3), place, body, pulled)
    data.qpos[:] = cho_solve(linear.factor, pulled)
    steps = round(RELEASED_S / model.opt.timestep)
    found = np.zeros((steps, 3))
    for k in range(steps):
        mujoco.mj_forward(model, data) if k == 0 else mujoco.mj_step(model, data)
        found[k] = data.xpos[body] + data.xmat[body].reshape(3, 3) @ local - place
    time_s = model.opt.timestep * np.arange(steps)
    alpha, beta = own.rayleigh()
    decay = 0.5 * (alpha + beta * own.omega**2)
    turned = np.sqrt(own.omega**2 - decay**2)
    phase = turned * time_s[:, None]
    swing = np.exp(-decay * time_s[:, None]) * (np.cos(phase) + decay / turned * np.sin(phase))
    given = upright((swing * force_n * own.shape[top, 0] / own.omega**2) @ own.shape[top].T)
    return time_s[::10], found[::10], given[::10]


def in_mujocos_gusts(table: Table, glb: bytes, rest_m: Any) -> tuple[Any, Any, Any]:
    """The same in the gusts of a preset, which act on every body, by MuJoCo and by the table."""
    with tempfile.TemporaryDirectory() as text:
        compliance = read_compliance(TREE_PATH)
        told = write_export(table, glb, "mjcf", Path(text), "tree", compliance=compliance)
        model = mujoco.MjModel.from_xml_path(str(Path(text) / "tree.xml"))
    gusty = in_gusts(model, told, table, rest_m, PRESETS[GUSTS], SECONDS, SETTLED_S)
    return gusty.dt_s * np.arange(len(gusty.by_table)), gusty.by_mujoco, gusty.by_table


def plot(path: Path, drawn: str, time_s: Any, found: Any, given: Any) -> None:
    """Both displacements along x."""
    mpl.rcParams["svg.hashsalt"] = "galewood"  # the same file for the same curves
    figure = Figure(figsize=(7.2, 2.6), layout="constrained")
    axes = figure.add_subplot()
    axes.plot(time_s, given[:, 0], color=TABLE_COLOUR, linewidth=2.4, alpha=0.55, label="table")
    axes.plot(time_s, found[:, 0], color=OWN_COLOUR, linewidth=0.9, label=drawn)
    axes.set(xlabel="time, s", ylabel="top along x, m", xlim=(0, time_s[-1]))
    axes.xaxis.set_major_locator(MultipleLocator(2))
    axes.grid(alpha=0.25)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), frameon=False, ncols=2)
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    main()
