"""Pictures of the exports in the programs that open them, for the table of docs/how-to/exports.md.

Run from the repository: ``python docs/examples/export_pictures docs/images/exports [PICTURE ...]``, with
MUJOCO_GL=egl where there is no display, and with BLENDER_PYTHON, a Python that has the package bpy, for the
kind usd.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from galewood.io.export import KINDS, ExportOptions, write_export
from galewood.motion.wind import PRESETS
from galewood.pipeline.results import read_compliance
from galewood.table import decode
from PIL import Image

sys.path.insert(0, str(Path(__file__).parents[3]))
from tests.precompute.fixtures.mujoco_trees import sprung

HERE = Path(__file__).parent
REPOSITORY = HERE.parents[2]
TREE_PATH = REPOSITORY / "assets/species/shipped/poplar.table"
OPTIONS = ExportOptions(wind=PRESETS["storm-front"], seconds=4.0)
TIME_S = 1.0
WIDTH_PX, HEIGHT_PX = 320, 380
MOST_BYTES = 60_000
SKY_RGB = (188, 214, 234)
WIND_S = 2.5
"""How long MuJoCo's wind blows before the picture."""
IN_BROWSER = {
    "vat": ("three", "tree.json"),
    "bones": ("three", "tree.glb"),
    "bones-playcanvas": ("playcanvas", "tree.glb"),
    "pivots": ("three", "tree_rigged.glb"),
    "glb": ("three", "tree.glb"),
    "live": ("babylon", "tree.glb"),
}
"""Program and file of each picture that Chromium draws."""
PICTURES = (*KINDS, "bones-playcanvas")
"""Named after the kind, and the program if it is a second one."""


def main() -> None:
    """Export, draw and write a WebP for each kind."""
    out, pictures = Path(sys.argv[1]), sys.argv[2:] or list(PICTURES)
    table, glb = decode(TREE_PATH.read_bytes()), TREE_PATH.with_suffix(".glb").read_bytes()
    height_m = float(table.metadata["height_m"])
    with tempfile.TemporaryDirectory() as text:
        folder, asked = Path(text), list[dict[str, Any]]()
        for name in pictures:
            kind = name.partition("-")[0]
            picture, compliance = folder / f"{name}.png", read_compliance(TREE_PATH)
            write_export(table, glb, kind, folder / kind, "tree", OPTIONS, compliance=compliance)
            if name in IN_BROWSER:
                program, file = IN_BROWSER[name]
                scene = {"time_s": TIME_S, "height_m": height_m, "picture": str(picture)}
                asked.append({"program": program, "folder": str(folder / kind), "file": file, **scene})
            elif kind == "usd":
                frame, command = str(round(TIME_S * OPTIONS.fps)), os.environ["BLENDER_PYTHON"]
                stage = str(folder / "usd/tree.usdc")
                asked_of = [command, str(HERE / "inBlender.py"), stage, frame, str(height_m), str(picture)]
                subprocess.run(asked_of, check=True, stdout=subprocess.DEVNULL)
            elif kind == "impostor":
                on_sky(Image.open(folder / kind / "tree_base_color.png")).save(picture)
            else:
                Image.fromarray(in_mujoco(folder / kind, kind, height_m)).save(picture)
        request = folder / "request.json"
        request.write_text(json.dumps(asked))
        if asked:
            subprocess.run(["node", str(HERE / "inBrowser.mjs"), str(request)], check=True, cwd=REPOSITORY)
        out.mkdir(parents=True, exist_ok=True)
        for name in pictures:
            path = out / f"{name}.webp"
            Image.open(folder / f"{name}.png").convert("RGB").save(path, quality=80, method=6)
            assert path.stat().st_size <= MOST_BYTES, path
            print(path, path.stat().st_size)


def on_sky(atlas: Image.Image) -> Image.Image:
    """The upper left quarter of the views, in front of a sky: from the horizon up to near the zenith."""
    sky = Image.new("RGBA", atlas.size, (*SKY_RGB, 255))
    sky.alpha_composite(atlas)
    return sky.crop((0, 0, atlas.width // 2, atlas.height // 2)).resize((HEIGHT_PX, HEIGHT_PX))


def in_mujoco(folder: Path, kind: str, height_m: float) -> Any:
    """(height, width, 3) the tree after a while in a wind of 12 m/s; of URDF the collision shapes, at rest.

    MuJoCo reads no materials of URDF, and leaves its meshes out.
    """
    if kind == "mjcf":
        model = mujoco.MjModel.from_xml_path(str(folder / "tree.xml"))
        model.opt.wind[:] = [json.loads((folder / "tree.json").read_text())["wind_m_s"]["12"], 0, 0]
    else:
        model = sprung(folder / "tree.urdf")
        model.geom_rgba[:] = [0.45, 0.33, 0.22, 1.0]
    model.vis.global_.offwidth, model.vis.global_.offheight, model.vis.global_.fovy = WIDTH_PX, HEIGHT_PX, 30
    model.vis.headlight.ambient[:], model.vis.headlight.diffuse[:] = 0.45, 0.6
    model.stat.extent, data = height_m, mujoco.MjData(model)
    mujoco.mj_step(model, data, round(WIND_S / model.opt.timestep) if kind == "mjcf" else 1)
    camera = mujoco.MjvCamera()
    camera.lookat[:], camera.distance = [0, 0, 0.47 * height_m], 2.2 * height_m
    camera.azimuth, camera.elevation = 90.0, 0.0
    renderer = mujoco.Renderer(model, HEIGHT_PX, WIDTH_PX)
    renderer.update_scene(data, camera)
    picture = renderer.render()
    renderer.enable_segmentation_rendering()
    renderer.update_scene(data, camera)
    empty = renderer.render()[:, :, 0] < 0
    return np.where(empty[:, :, None], np.array(SKY_RGB, np.uint8), picture)


if __name__ == "__main__":
    main()
