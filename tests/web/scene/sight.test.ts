import { PerspectiveCamera, Vector3 } from "three";
import { expect, test } from "vitest";
import { viewerAt } from "../../../web/src/scene/camera/sight";
import { seededRandom } from "../seeded";

/** A camera at a place that looks in a direction, its elevation in rad. */
function cameraAt(x: number, heading: number, elevation: number, aspect: number): PerspectiveCamera {
  const camera = new PerspectiveCamera(46, aspect);
  camera.position.set(x, 2, -x);
  const flat = Math.cos(elevation);
  camera.lookAt(x + flat * Math.cos(heading), 2 + Math.sin(elevation), -x + flat * Math.sin(heading));
  camera.updateMatrixWorld();
  return camera;
}

test("whatever a camera sees stands within the angle of its viewer", () => {
  const random = seededRandom(38);
  for (let run = 0; run < 300; run++) {
    const camera = cameraAt(80 * random(), 7 * random(), 3 * (random() - 0.5), 0.4 + 2 * random());
    const [x, z, aheadX = 0, aheadZ = 0, cosine = -1] = viewerAt(camera);
    expect([x, z]).toEqual([camera.position.x, camera.position.z]);
    for (let point = 0; point < 50; point++) {
      const seen = new Vector3(2 * random() - 1, 2 * random() - 1, 0.9).unproject(camera).sub(camera.position);
      expect(seen.x * aheadX + seen.z * aheadZ).toBeGreaterThanOrEqual(cosine * Math.hypot(seen.x, seen.z) - 1e-9);
    }
  }
});

test("a level view sees part of the forest, a steep one all around", () => {
  const level = viewerAt(cameraAt(3, 1, 0.1, 16 / 9));
  expect(level[4]).toBeGreaterThan(0.4);
  expect([level[2], level[3]]).toEqual([expect.closeTo(Math.cos(1), 9), expect.closeTo(Math.sin(1), 9)]);
  expect(viewerAt(cameraAt(3, 1, -1.2, 16 / 9))).toHaveLength(2);
});
