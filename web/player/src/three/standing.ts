/** How trees stand: from matrices to the data of their instances. */
import { Matrix4, Quaternion, Vector3 } from "three";
import { INSTANCE_FLOATS, type InstanceData } from "../trees/instanceData";

/** Angle by which a tree may lean and still be culled as an upright one: sine of about one degree. */
const MAX_LEAN_SINE = 0.02;

const spot = new Vector3();
const turn = new Quaternion();
const size = new Vector3();
const up = new Vector3();
const whole = new Matrix4();
const inverse = new Matrix4();

function decompose(matrix: Matrix4, k: number): void {
  if (!matrix.elements.every(Number.isFinite))
    throw new RangeError(`matrix ${k} has an element that is not a finite number`);
  matrix.decompose(spot, turn, size);
  if (!(matrix.determinant() > 0))
    throw new RangeError(`matrix ${k} mirrors the tree or has no size: use positive scales`);
}

/** Columns of the first three rows. */
function twelve(matrix: Matrix4, out: Float32Array, at: number): void {
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 3; row++) out[at + 3 * column + row] = matrix.elements[4 * column + row];
  }
}

function write(matrix: Matrix4, k: number, data: Float32Array): boolean {
  decompose(matrix, k);
  const root = Math.sqrt(size.y);
  const largest = Math.max(size.x, size.y, size.z);
  const { x, y, z, w } = turn;
  data.set(
    [
      spot.x,
      spot.y,
      spot.z,
      0,
      root * x,
      root * y,
      largest,
      1,
      root * z,
      root * w,
      size.x / size.y,
      size.z / size.y,
    ],
    k * INSTANCE_FLOATS,
  );
  return up.set(0, 1, 0).applyQuaternion(turn).y > 1 - MAX_LEAN_SINE * MAX_LEAN_SINE;
}

/** The instances that matrices describe, in the frame of the forest. Shear is ignored. */
export function instancesOf(matrices: readonly Matrix4[]): InstanceData {
  const count = matrices.length;
  const data = new Float32Array(count * INSTANCE_FLOATS);
  const inverses = new Float32Array(count * 12);
  let upright = true;
  for (const [k, matrix] of matrices.entries()) {
    if (!write(matrix, k, data)) upright = false;
    twelve(inverse.copy(matrix).invert(), inverses, 12 * k);
  }
  const ids = Uint32Array.from({ length: count }, (_, k) => k);
  return {
    count,
    data,
    placement: new Float32Array(4 * count),
    ids,
    leans: false,
    oriented: { inverse: inverses, upright },
  };
}

/** x, z, yaw and scale of each tree in the world: what its motion depends on. */
export function placementOf(matrices: readonly Matrix4[], forest: Matrix4): Float32Array<ArrayBuffer> {
  const placement = new Float32Array(4 * matrices.length);
  for (const [k, matrix] of matrices.entries()) {
    whole.multiplyMatrices(forest, matrix).decompose(spot, turn, size);
    const ahead = up.set(1, 0, 0).applyQuaternion(turn);
    const yaw_rad = Math.atan2(-ahead.z, ahead.x);
    placement.set([spot.x, spot.z, yaw_rad, Math.cbrt(size.x * size.y * size.z)], 4 * k);
  }
  return placement;
}
