/** The tree that loads first, against a camera: it must be seen in the first picture of a wide window and of an upright phone. */
import { PerspectiveCamera, Vector3 } from "three";
import { expect, test } from "vitest";
import { EDGE_VIEW } from "../../../../web/src/scene/camera/viewpoints";
import { firstInView, type TreeAsset } from "../../../../web/src/scene/forest";
import { plant } from "../../../../web/src/scene/forms";
import { groundHeight_m } from "../../../../web/src/scene/ground/landscape";
import { placeTrees } from "../../../../web/src/scene/placement";
import { seededRandom } from "../../../../tools/species/random";

const SEED = 20_260;
const TREE_COUNT = 120;
/** Height (m) at which a tree is looked for in the picture. */
const SEEN_M = 4;
/** Aspect and field of view, degrees, as the stage has them. */
const WINDOWS = [
  [16 / 9, 46],
  [390 / 780, 58],
] as const;

const asset = (species: string, form: "open" | "forest"): TreeAsset => ({
  id: form === "open" ? species : `${species}-forest`,
  species,
  builtin: true,
  form,
  hasTable: true,
  model: null,
  motion: null,
});
const ASSETS = ["beech", "birch", "poplar", "maple", "spruce"].flatMap((name) => [asset(name, "open"), asset(name, "forest")]);

function camera([aspect, fov]: readonly [number, number]): PerspectiveCamera {
  const eye = new PerspectiveCamera(fov, aspect, 0.3, 2600);
  eye.position.copy(EDGE_VIEW.eye);
  eye.lookAt(EDGE_VIEW.target.x, EDGE_VIEW.target.y, EDGE_VIEW.target.z);
  eye.updateMatrixWorld();
  return eye;
}

test(`is in the picture of the page's first view, in 30 forests (seed ${SEED})`, () => {
  const random = seededRandom(SEED);
  const cameras = WINDOWS.map(camera);
  for (let k = 0; k < 30; k++) {
    const seed = random.integer(1e6);
    const first = firstInView(ASSETS, TREE_COUNT, seed, {}, EDGE_VIEW);
    expect(first).not.toBeNull();
    const places = placeTrees(TREE_COUNT, seed);
    const planted = plant(ASSETS, places, {});
    const own = places.filter((_, i) => planted[i] === first);
    for (const eye of cameras) {
      const seen = own.some(({ x_m, z_m }) => {
        const { x, y, z } = new Vector3(x_m, groundHeight_m(x_m, z_m) + SEEN_M, z_m).project(eye);
        return Math.abs(x) < 1 && Math.abs(y) < 1 && z < 1;
      });
      expect(seen, `forest ${seed}, aspect ${eye.aspect}`).toBe(true);
    }
  }
});

test("is none where no tree stands in the picture, and never one without a table", () => {
  const away = { eye: EDGE_VIEW.eye, target: { x: 0, y: 0, z: 400 } };
  expect(firstInView(ASSETS, 5, 3, {}, away)).toBeNull();
  const only = ASSETS.map((one) => ({ ...one, hasTable: one.species === "spruce" }));
  expect(firstInView(only, TREE_COUNT, 7, {}, EDGE_VIEW)?.species).toBe("spruce");
});
