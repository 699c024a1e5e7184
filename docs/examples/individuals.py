"""Tables of individuals against full builds of the same trees: figures of docs/design/0036-individuals.md.

Run from the repository: ``python docs/examples/individuals.py FOLDER TREE SEED...``, such as
``build/individuals oak-forest 11 12``; with ``--bare`` it compares the tables without leaves. It grows a tree
of random size for each seed and builds its full table in a minute or two (kept in the folder, as are the
figures, NAME/leaf.json or NAME/bare.json). It makes its quick tables with
three kinds of force, and plays all in the same winds. The reference is the full table, whose own error is a
tenth of what is found (docs/physics.md).
"""

import json
import random
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from galewood import grow
from galewood.check.evaluation import METHODS, play_pressures, unseen_winds
from galewood.io.api import Individual
from galewood.motion.wind import Wind, WindField
from galewood.packaged import species_folder
from galewood.pipeline.individuals import individual_table, law_of_table
from galewood.pipeline.results import shipped_bare_tables, shipped_tables
from galewood.pipeline.stages import ImportedTree, build_table
from galewood.pipeline.tables import BuildOptions
from galewood.player import WindDrivenTrees
from galewood.solid.skinning import joint_rows
from galewood.table import Foliage, Table, decode, encode
from galewood.threads import single_threaded
from galewood.util import Floats, Ints

HEIGHT_SHARES, GIRTH_SHARES = (0.75, 1.25), (0.88, 1.15)
SWAYS, WIND_SEED, FRAME_COUNT = (0.1, 0.2), 5121, 240
DRAWN_SPEED_M_S = 25.0
"""Speed for which the winds are drawn; they are then scaled to their sway."""
LARGEST_SCALE, HALVING_COUNT = 1.5, 9
VERTEX_COUNT, SOUGHT_VERTICES = 1500, 300
GUSTY_WIND, GUSTY_S = Wind(mean_speed_m_s=10.0, seed=5), 20.0


class _Done(Exception):
    """The complete table is there: the records of the paper's method are not needed."""


def grown(tree: str, seed: int) -> Individual:
    """An individual of a built-in tree, of a size that follows from both."""
    entries = json.loads((species_folder() / "species.json").read_bytes())
    entry = next(one for one in entries if one["id"] == tree)
    forms = json.loads((species_folder() / "shipped/forms.json").read_bytes())["forms"]["leaf"]
    rng = random.Random(f"{tree}{seed}")
    share, girth = rng.uniform(*HEIGHT_SHARES), rng.uniform(*GIRTH_SHARES)
    dbh_cm = round(share * girth * round(100 * forms[tree]["dbh_m"]), 1)
    height_m = round(share * entry["height_m"], 1)
    return grow(entry["species"], seed=seed, height_m=height_m, dbh_cm=dbh_cm, form=entry["form"])


def full_table(individual: Individual, options: BuildOptions, folder: Path) -> Table:
    """Its table from simulated runs, kept in a folder."""
    path = folder / individual.name / ("full.bare.table" if options.foliage == "bare" else "full.table")

    def keep(result: Any) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(result.table)
        raise _Done

    if not path.exists():
        source = ImportedTree(individual.tree.mesh, individual.tree.render_glb)
        with suppress(_Done):
            build_table(source, "tree.glb", options, cache_dir=folder / "cache", on_table=keep)
    return decode(path.read_bytes())


def track(table: Table, pressure_pa: Floats, vertices: Ints) -> Floats:
    """(frames, v, 3) displacement of some vertices, m, under a pressure (frames, 2), Pa."""
    q, _ = play_pressures(table, pressure_pa, METHODS["modal"])
    rows = joint_rows(table, table.node_basis).astype(np.float64)[table.vertex_joint[vertices]]
    return np.einsum("nik,tk->tni", rows, q)


def scaled_winds(full: Table, sway: float, vertices: Ints) -> dict[str, Floats]:
    """The unseen winds, each as strong as the full table sways so far (share of the height), if it does."""
    goal_m, dt_s = sway * float(full.metadata["height_m"]), float(full.metadata["dt_s"])
    first_hz = float(full.metadata["frequencies_hz"][0])
    winds = unseen_winds(
        DRAWN_SPEED_M_S, FRAME_COUNT, dt_s, full.streamlined_exponent,
        strength=0.9, seed=WIND_SEED, first_hz=first_hz,
    )  # fmt: skip

    def scale(wind: Floats) -> float:
        low, high = 0.01, LARGEST_SCALE
        for _ in range(HALVING_COUNT):
            middle = float(np.sqrt(low * high))
            most_m = np.linalg.norm(track(full, middle * wind, vertices), axis=2).max()
            low, high = (middle, high) if most_m < goal_m else (low, middle)
        return float(np.sqrt(low * high))

    return {name: scale(wind) * wind for name, wind in winds.items()}


def gusty_track(table: Table, vertices: Ints) -> Floats:
    """(frames, v, 3) displacement in a wind whose gusts differ within the crown, m."""
    dt_s = float(table.metadata["dt_s"])
    trees = WindDrivenTrees(table, np.array([[3.0, 5.0, 0.0, 1.0]]))
    field, poses = WindField(GUSTY_WIND), list[Floats]()
    for frame in range(round(GUSTY_S / dt_s)):
        trees.step(field, (frame + 1) * dt_s, dt_s)
        poses.append(np.array(trees.q[0], np.float64))
    rows = joint_rows(table, table.node_basis).astype(np.float64)[table.vertex_joint[vertices]]
    return np.einsum("nik,tk->tni", rows, np.array(poses))


def rms(motion: Floats) -> float:
    """Root mean square of vectors (…, 3)."""
    return float(np.sqrt((motion**2).sum(axis=-1).mean()))


def compared(full: Table, tables: dict[str, Table]) -> dict[str, Any]:
    """Errors of each table: of the worst vertex per wind, over the height; in gusts the RMS."""
    height_m, rng = float(full.metadata["height_m"]), np.random.default_rng(0)
    vertices = np.sort(rng.choice(len(full.vertex_joint), VERTEX_COUNT, replace=False))
    found: dict[str, Any] = {name: {"largest": {}, "of_95_percent": {}} for name in tables}
    for sway in SWAYS:
        winds = scaled_winds(full, sway, vertices[:: VERTEX_COUNT // SOUGHT_VERTICES])
        for wind in winds.values():
            exact = track(full, wind, vertices)
            for name, table in tables.items():
                off = np.linalg.norm(track(table, wind, vertices) - exact, axis=2).max(axis=0) / height_m
                found[name]["largest"].setdefault(str(sway), []).append(float(off.max()))
                found[name]["of_95_percent"].setdefault(str(sway), []).append(float(np.percentile(off, 95)))
    exact = gusty_track(full, vertices)
    for name, table in tables.items():
        found[name]["gusts"] = rms(gusty_track(table, vertices) - exact) / rms(exact)
    return found


@single_threaded
def figures_of(tree: str, seed: int, folder: Path, foliage: Foliage) -> dict[str, Any]:
    """Frequencies, errors and CPU seconds of one individual."""
    individual = grown(tree, seed)
    request, mesh, glb = individual.request, individual.tree.mesh, individual.tree.render_glb
    options = BuildOptions(
        species=individual.species,
        height_m=request.height_m,
        stiffness="as drawn",
        reference_frames=0,
        foliage=foliage,
    )
    full = full_table(individual, options, folder)
    shipped = shipped_bare_tables if foliage == "bare" else shipped_tables
    builtin = decode(shipped(species_folder())[tree].read_bytes())
    motion = individual.motions.bare if foliage == "bare" else individual.motions.leaf
    if motion is None:
        raise ValueError(f"a {tree} keeps its leaves")
    start_s = time.process_time()
    ours = individual_table(mesh, motion, options, glb)
    cpu_s = time.process_time() - start_s
    tables = {
        "isotropic": ours,
        "none": individual_table(mesh, motion, options, glb, lambda states: 0 * states.sway),
        "copied": individual_table(mesh, motion, options, glb, law_of_table(builtin)),
    }
    return {
        "name": individual.name,
        **request.model_dump(),
        "hz": {name: one.metadata["frequencies_hz"][:3] for name, one in (("full", full), ("quick", ours))},
        "cpu_s": cpu_s,
        "bytes": len(encode(ours)),
        "errors": compared(full, tables),
    }


def main() -> None:
    """Print a line for each individual, and write its figures."""
    given = [word for word in sys.argv[1:] if word != "--bare"]
    foliage: Foliage = "bare" if "--bare" in sys.argv else "leaf"
    folder, tree = Path(given[0]), given[1]
    for seed in map(int, given[2:]):
        found = figures_of(tree, seed, folder, foliage)
        (folder / found["name"] / f"{foliage}.json").write_text(json.dumps(found, indent=1))
        full, quick = found["hz"]["full"][0], found["hz"]["quick"][0]
        errors = {
            f"{name} {sway}": [round(100 * float(one), 1) for one in (np.median(values), max(values))]
            for name, of_table in found["errors"].items()
            for sway, values in of_table["largest"].items()
        }
        print(
            found["name"], f"{full:.3f} {quick:.3f} Hz {100 * (quick / full - 1):+.1f} %", errors, flush=True
        )


if __name__ == "__main__":
    main()
