/** Parts of the npm package that its users do not see: how trees stand, and what the worker does. */
import { Matrix4, Quaternion, Vector3 } from "three";
import { describe, expect, test } from "vitest";
import { createForest, PRESETS, readTable } from "../../../web/player/src/core";
import { instancesOf, placementOf } from "../../../web/player/src/three/standing";
import { INSTANCE_FLOATS } from "../../../web/player/src/trees/instanceData";
import { Stepper } from "../../../web/player/src/worker/simple/stepper";
import { golden, random } from "../golden";

describe("trees at matrices", () => {
  const seed = 5;
  const next = random(seed);
  const matrices = Array.from({ length: 20 }, () => {
    const turn = new Quaternion(next() - 0.5, next() - 0.5, next() - 0.5, next() - 0.5).normalize();
    const size = new Vector3(0.5 + next(), 0.5 + next(), 0.5 + next());
    return new Matrix4().compose(new Vector3(9 * next(), 3 * next(), 9 * next()), turn, size);
  });

  test(`the shader's arithmetic is that of the matrix (seed ${seed})`, () => {
    const { data } = instancesOf(matrices);
    for (const [k, matrix] of matrices.entries()) {
      const [x, y, z, , qx, qy, , , qz, qw, wide, deep] = data.subarray(k * INSTANCE_FLOATS);
      const v = new Vector3(0.3, 2.5, -0.7);
      const q = new Vector3(qx, qy, qz);
      const s = new Vector3(v.x * wide, v.y, v.z * deep);
      const spun = s
        .clone()
        .multiplyScalar(qw * qw - q.dot(q))
        .addScaledVector(q, 2 * q.dot(s))
        .addScaledVector(q.clone().cross(s), 2 * qw);
      expect(spun.add(new Vector3(x, y, z)).distanceTo(v.applyMatrix4(matrix))).toBeLessThan(1e-5);
    }
  });

  test("upright trees have yaw and scale; a mirrored one is refused", () => {
    const upright = new Matrix4().compose(
      new Vector3(1, 2, 3),
      new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), 0.7),
      new Vector3(2, 2, 2),
    );
    expect(instancesOf([upright]).oriented?.upright).toBe(true);
    expect(instancesOf(matrices).oriented?.upright).toBe(false);
    const [x, z, yaw, scale] = placementOf([upright], new Matrix4().makeTranslation(10, 0, 0));
    [x - 11, z - 3, yaw - 0.7, scale - 2].forEach((error) => expect(Math.abs(error)).toBeLessThan(1e-6));
    expect(() => instancesOf([new Matrix4().makeScale(-1, 1, 1)])).toThrow(/mirrors/);
    expect(() => instancesOf([new Matrix4(), new Matrix4().makeTranslation(Number.NaN, 0, 0)])).toThrow(
      "matrix 1 has an element that is not a finite number",
    );
  });
});

describe("the worker", () => {
  const table = () => golden("pole.safetensors").slice().buffer as ArrayBuffer;
  const frame = (stride: number) => ({ group: 0, poses: new Float32Array(stride), velocity: null });

  test("steps like the public forest; a group that moves keeps its pose", () => {
    const stepper = new Stepper();
    const motion = stepper.read(0, table());
    stepper.setWind(PRESETS["autumn-gusts"]);
    stepper.plant(0, 0, Float32Array.of(4, 5, 0.3, 1));
    const place = { x_m: 4, z_m: 5, yaw_rad: 0.3 };
    const read = readTable(table());
    const forest = createForest({ kinds: [{ table: read, places: [place] }], wind: PRESETS["autumn-gusts"] });
    const frames = [frame(motion.stride)];
    for (let k = 0; k < 90; k++) {
      stepper.advance(1 / 30, [4, 5], frames);
      forest.step(1 / 30);
    }
    const before = frames[0].poses.slice(0, motion.modes);
    expect(before).toEqual(forest.coordinates(0).slice());
    stepper.plant(0, 0, Float32Array.of(40, 5, 0.3, 1));
    stepper.advance(0, [4, 5], frames);
    const jump = before.reduce((most, value, k) => Math.max(most, Math.abs(value - frames[0].poses[k])), 0);
    expect(jump).toBeLessThan(1e-6);
  });
});
