// One step of the modal reduced-order model for one tree, four oscillators at a time, in single precision.
// AssemblyScript: `npm run kernel` compiles it to ../player/src/core/modal/modalKernel.wasm.ts. Addresses are in bytes;
// ../player/src/core/modal/modalKernel.ts defines the memory layout. One of three implementations of the step, with
// ../player/src/core/modal/modalForest.ts and numba in precompute/galewood/motion/modal/; see docs/design/0010-kernel.md.

import { MODAL_REACH, MODAL_REST } from "./constants";
import { perSpeeds, shelteredSpeeds } from "./pressure";

/** End of the constants that the compiler placed in the memory. */
export const constantsEnd: usize = __heap_base;
/** Half the table's step, s. */
export let halfStep_s: f32 = 0;
/** Power of the wind speed with which the pressure grows above 5 m/s. */
export let exponent: f32 = 2;
/** Coupled coordinates. */
export let coupled: i32 = 0;
/** Bytes of a row of the d oscillators and of one of the r − d further modes, padded to whole vectors. */
export let ownRow: usize = 0;
export let furtherRow: usize = 0;
/**
 * Bytes from one tree to the next in the arrays of states and of poses; the further modes of a pose begin as far behind it as a
 * row of states is long. A coarse model of the same trees, which steps the first oscillators only, has shorter rows.
 */
export let stateRow: usize = 0;
export let poseRow: usize = 0;

/** [6, d] r00 − 1, r01, r10, r11 − 1, s0, s1 */
export let stepping: usize = 0;
/** [2, d] */
export let pull: usize = 0;
/** [2, d] */
export let sway: usize = 0;
/** [44 + 6c + 2G, d] ends with the loads of the places: along x of all places, then along z */
export let force: usize = 0;
/** [G] weights of the places in the mean gust over the crown */
export let meanGust: usize = 0;
/** [d] */
export let shown: usize = 0;
/** [d + 9 + 2c, r − d], the rows of the coordinates apart from the others */
export let posePlain: usize = 0;
export let poseTerms: usize = 0;
/** [3 + 2c] */
export let limits: usize = 0;
/** Drag points, padded to whole vectors, and oscillators whose speeds move them. */
export let dragPoints: i32 = 0;
export let dragInputs: i32 = 0;
/** [3, points] area, m²; share of the pressure in shelter; weight in the mean */
export let dragPoint: usize = 0;
/** [inputs, 3 · points] x of all points, then y, z; [3 · points, d]; [d] */
export let dragIn: usize = 0;
export let dragOut: usize = 0;
export let dragRest: usize = 0;
/** [G, points] gust at each point per unit of those at the places */
export let dragPlace: usize = 0;
/** [2, points] pressure of the wind at each point along x, then along z, Pa */
export let air: usize = 0;
/** [3 · points] */
export let dragForce: usize = 0;
/** Room for the terms, which end with the gusts at the places, [2, G] Pa, and for one row of oscillators and one of further modes. */
export let terms: usize = 0;
export let ahead: usize = 0;
export let total: usize = 0;
/** [count, d] */
export let e: usize = 0;
export let v: usize = 0;
/** [count, d + (r − d)], each part padded */
export let now: usize = 0;
export let before: usize = 0;
/** [count] */
export let extrapolationRatio: usize = 0;

/** So that the division by no wind gives no speed. */
const LEAST_PA: f32 = 1e-30;

/** Return value of functions that return a pair. */
let pairX: f32 = 0;
let pairY: f32 = 0;

// @ts-ignore: decorator
@inline
function sum(a: v128): f32 {
  return (
    f32x4.extract_lane(a, 0) + f32x4.extract_lane(a, 1) + (f32x4.extract_lane(a, 2) + f32x4.extract_lane(a, 3))
  );
}

/** The two sway coordinates of a row, into the pair. */
// @ts-ignore: decorator
@inline
function projectOnSway(row: usize): void {
  let x = f32x4.splat(0);
  let y = f32x4.splat(0);
  for (let k: usize = 0; k < ownRow; k += 16) {
    const value = v128.load(row + k);
    x = f32x4.add(x, f32x4.mul(value, v128.load(sway + k)));
    y = f32x4.add(y, f32x4.mul(value, v128.load(sway + ownRow + k)));
  }
  pairX = sum(x);
  pairY = sum(y);
}

/** Limits the length of the pair to `far`. */
// @ts-ignore: decorator
@inline
function clampPair(far: f32): void {
  const square = pairX * pairX + pairY * pairY;
  if (square <= far * far) return;
  const share = far / sqrt(square);
  pairX *= share;
  pairY *= share;
}

/** Terms in the pose alone: sway of degree 2 and 3, each coupled coordinate of a row times the sway. */
// @ts-ignore: decorator
@inline
function writeShape(x: f32, y: f32, row: usize): void {
  const xx = x * x;
  const xy = x * y;
  const yy = y * y;
  store<f32>(terms, xx);
  store<f32>(terms, xy, 4);
  store<f32>(terms, yy, 8);
  store<f32>(terms, xx * x, 12);
  store<f32>(terms, xx * y, 16);
  store<f32>(terms, x * yy, 20);
  store<f32>(terms, yy * y, 24);
  for (let j = 0; j < coupled; j++) {
    const far = MODAL_REACH * load<f32>(limits + 4 * j, 12);
    const z = min(max(load<f32>(row + 4 * j, 8), -far), far);
    store<f32>(terms + 8 * j, z * x, 28);
    store<f32>(terms + 8 * j, z * y, 32);
  }
}

/** Squares of the sway's speed, which is the pair, and these times the sway. */
// @ts-ignore: decorator
@inline
function writeSquares(x: f32, y: f32, to: usize): void {
  const a = pairX * pairX;
  const b = pairX * pairY;
  const c = pairY * pairY;
  store<f32>(to, a);
  store<f32>(to, b, 4);
  store<f32>(to, c, 8);
  store<f32>(to, a * x, 12);
  store<f32>(to, a * y, 16);
  store<f32>(to, b * x, 20);
  store<f32>(to, b * y, 24);
  store<f32>(to, c * x, 28);
  store<f32>(to, c * y, 32);
}

/** A factor times the sway and times the first `shapes` of its higher terms; where the next is written. */
// @ts-ignore: decorator
@inline
function writeProducts(factor: f32, x: f32, y: f32, shapes: usize, to: usize): usize {
  store<f32>(to, factor * x);
  store<f32>(to, factor * y, 4);
  to += 8;
  for (let k: usize = 0; k < shapes; k++, to += 4) store<f32>(to, factor * load<f32>(terms + 4 * k));
  return to;
}

/** Each coupled coordinate's speed times the sway, and the coordinate times the pressure, which is the pair. */
// @ts-ignore: decorator
@inline
function writeCoupled(x: f32, y: f32, speed: usize, to: usize): void {
  for (let j = 0; j < coupled; j++, to += 16) {
    const far = MODAL_REACH * load<f32>(limits + 4 * j, 12);
    const fast = MODAL_REACH * load<f32>(limits + 4 * (coupled + j), 12);
    const z = min(max(load<f32>(ahead + 4 * j, 8), -far), far);
    const w = min(max(load<f32>(speed + 4 * j, 8), -fast), fast);
    store<f32>(to, w * x);
    store<f32>(to, w * y, 4);
    store<f32>(to, z * pairX, 8);
    store<f32>(to, z * pairY, 12);
  }
}

/** Adds `count` rows of a matrix, each times its number in `factors`, to `out`. */
// @ts-ignore: decorator
@inline
function addRows(matrix: usize, factors: usize, count: i32, row: usize, out: usize): void {
  let k: usize = 0;
  for (; k + 64 <= row; k += 64) {
    let a = v128.load(out + k);
    let b = v128.load(out + k, 16);
    let c = v128.load(out + k, 32);
    let d = v128.load(out + k, 48);
    let at = matrix + k;
    for (let f = 0; f < count; f++, at += row) {
      const factor = v128.load32_splat(factors + 4 * f);
      a = f32x4.add(a, f32x4.mul(factor, v128.load(at)));
      b = f32x4.add(b, f32x4.mul(factor, v128.load(at, 16)));
      c = f32x4.add(c, f32x4.mul(factor, v128.load(at, 32)));
      d = f32x4.add(d, f32x4.mul(factor, v128.load(at, 48)));
    }
    v128.store(out + k, a);
    v128.store(out + k, b, 16);
    v128.store(out + k, c, 32);
    v128.store(out + k, d, 48);
  }
  for (; k + 32 <= row; k += 32) {
    let a = v128.load(out + k);
    let b = v128.load(out + k, 16);
    let at = matrix + k;
    for (let f = 0; f < count; f++, at += row) {
      const factor = v128.load32_splat(factors + 4 * f);
      a = f32x4.add(a, f32x4.mul(factor, v128.load(at)));
      b = f32x4.add(b, f32x4.mul(factor, v128.load(at, 16)));
    }
    v128.store(out + k, a);
    v128.store(out + k, b, 16);
  }
  for (; k < row; k += 16) {
    let a = v128.load(out + k);
    let at = matrix + k;
    for (let f = 0; f < count; f++, at += row) {
      a = f32x4.add(a, f32x4.mul(v128.load32_splat(factors + 4 * f), v128.load(at)));
    }
    v128.store(out + k, a);
  }
}

/** All terms of the force at the midpoint of the step, extrapolated from the current state, in the mean wind (Pa). */
// @ts-ignore: decorator
@inline
function writeForceTerms(position: usize, speed: usize, px: f32, pz: f32): void {
  const half = f32x4.splat(halfStep_s);
  for (let k: usize = 0; k < ownRow; k += 16) {
    v128.store(ahead + k, f32x4.add(v128.load(position + k), f32x4.mul(half, v128.load(speed + k))));
  }
  projectOnSway(ahead);
  clampPair(MODAL_REACH * load<f32>(limits));
  const x = pairX;
  const y = pairY;
  writeShape(x, y, ahead);
  let to = terms + 28 + 8 * coupled;
  projectOnSway(speed);
  clampPair(MODAL_REACH * load<f32>(limits, 4));
  writeSquares(x, y, to);
  to = writeProducts(pairX, x, y, 3, to + 36);
  to = writeProducts(pairY, x, y, 3, to);
  pairX = px;
  pairY = pz;
  clampPair(MODAL_REACH * load<f32>(limits, 8));
  to = writeProducts(pairX, x, y, 7, to);
  to = writeProducts(pairY, x, y, 7, to);
  writeCoupled(x, y, speed, to);
}

/** Whether the motion is negligible, so that a tree in still air can be set to rest. */
function isAtRest(position: usize, speed: usize): bool {
  const small = MODAL_REST * load<f32>(limits);
  projectOnSway(position);
  if (max(abs(pairX), abs(pairY)) > small) return false;
  projectOnSway(speed);
  if (max(abs(pairX), abs(pairY)) > MODAL_REST * load<f32>(limits, 4)) return false;
  let largest: f32 = 0;
  for (let k: usize = 0; k < ownRow; k += 4) largest = max(largest, abs(load<f32>(position + k)));
  return largest * max(abs(load<f32>(sway)), abs(load<f32>(sway + ownRow))) < small;
}

/** The mean speed during the step, without the drag, into `ahead`. */
// @ts-ignore: decorator
@inline
function writeMeanSpeed(position: usize, speed: usize): void {
  const rate = f32x4.splat((0.5 as f32) / halfStep_s);
  for (let k: usize = 0; k < ownRow; k += 16) {
    const r00 = f32x4.mul(v128.load(stepping + k), v128.load(position + k));
    const r01 = f32x4.mul(v128.load(stepping + ownRow + k), v128.load(speed + k));
    const s0 = f32x4.mul(v128.load(stepping + 4 * ownRow + k), v128.load(total + k));
    v128.store(ahead + k, f32x4.mul(rate, f32x4.add(f32x4.add(r00, r01), s0)));
  }
}

/** The wind at the drag points, in `air`: that at the tree plus the gusts of the places around. */
// @ts-ignore: decorator
@inline
function writeAir(px: f32, pz: f32, gusts: usize, places: i32): void {
  const side: usize = 4 * dragPoints;
  for (let j: usize = 0; j < side; j += 16) {
    let x = f32x4.splat(px);
    let z = f32x4.splat(pz);
    for (let g = 0, at = dragPlace + j; g < places; g++, at += side) {
      const weight = v128.load(at);
      x = f32x4.add(x, f32x4.mul(weight, v128.load32_splat(gusts + 4 * g)));
      z = f32x4.add(z, f32x4.mul(weight, v128.load32_splat(gusts + 4 * (places + g))));
    }
    v128.store(air + j, x);
    v128.store(air + side + j, z);
  }
}

/** Adds the drag at the speeds in `ahead` to `total`: four points at a time. */
// @ts-ignore: decorator
@inline
function addDrag(): void {
  const side: usize = 4 * dragPoints;
  let mean = f32x4.splat(0);
  for (let j: usize = 0; j < side; j += 16) {
    let x = f32x4.splat(0);
    let y = f32x4.splat(0);
    let z = f32x4.splat(0);
    for (let k = 0, at = dragIn + j; k < dragInputs; k++, at += 3 * side) {
      const speed = v128.load32_splat(ahead + 4 * k);
      x = f32x4.add(x, f32x4.mul(speed, v128.load(at)));
      y = f32x4.add(y, f32x4.mul(speed, v128.load(at + side)));
      z = f32x4.add(z, f32x4.mul(speed, v128.load(at + 2 * side)));
    }
    const area = v128.load(dragPoint + j);
    const share = v128.load(dragPoint + side + j);
    const pressureX = v128.load(air + j);
    const pressureZ = v128.load(air + side + j);
    const wind = f32x4.sqrt(f32x4.add(f32x4.mul(pressureX, pressureX), f32x4.mul(pressureZ, pressureZ)));
    const speed = shelteredSpeeds(f32x4.mul(share, wind), exponent);
    const perPressure = f32x4.div(speed, f32x4.max(wind, f32x4.splat(LEAST_PA)));
    x = f32x4.sub(f32x4.mul(perPressure, pressureX), x);
    z = f32x4.sub(f32x4.mul(perPressure, pressureZ), z);
    const square = f32x4.add(f32x4.mul(x, x), f32x4.add(f32x4.mul(y, y), f32x4.mul(z, z)));
    const per = perSpeeds(f32x4.sqrt(square), exponent);
    mean = f32x4.add(mean, f32x4.mul(per, v128.load(dragPoint + 2 * side + j)));
    const steadyX = f32x4.mul(share, pressureX);
    const steadyZ = f32x4.mul(share, pressureZ);
    v128.store(dragForce + j, f32x4.mul(area, f32x4.sub(f32x4.mul(per, x), steadyX)));
    v128.store(dragForce + side + j, f32x4.mul(area, f32x4.neg(f32x4.mul(per, y))));
    v128.store(dragForce + 2 * side + j, f32x4.mul(area, f32x4.sub(f32x4.mul(per, z), steadyZ)));
  }
  const rest = f32x4.splat(sum(mean));
  for (let k: usize = 0; k < ownRow; k += 16) {
    const lost = f32x4.mul(f32x4.mul(rest, v128.load(dragRest + k)), v128.load(ahead + k));
    v128.store(total + k, f32x4.sub(v128.load(total + k), lost));
  }
  addRows(dragOut, dragForce, 3 * dragPoints, ownRow, total);
}

/** Each oscillator's own step under the total force. */
// @ts-ignore: decorator
@inline
function move(position: usize, speed: usize): void {
  for (let k: usize = 0; k < ownRow; k += 16) {
    const a = v128.load(position + k);
    const b = v128.load(speed + k);
    const f = v128.load(total + k);
    let at = stepping + k;
    const r00 = f32x4.mul(v128.load(at), a);
    const r01 = f32x4.mul(v128.load((at += ownRow)), b);
    const r10 = f32x4.mul(v128.load((at += ownRow)), a);
    const r11 = f32x4.mul(v128.load((at += ownRow)), b);
    const s0 = f32x4.mul(v128.load((at += ownRow)), f);
    const s1 = f32x4.mul(v128.load(at + ownRow), f);
    v128.store(position + k, f32x4.add(a, f32x4.add(f32x4.add(r00, r01), s0)));
    v128.store(speed + k, f32x4.add(b, f32x4.add(f32x4.add(r10, r11), s1)));
  }
}

/**
 * Writes the pose of the current state in the mean wind over the crown (Pa), keeps the previous one, and updates the
 * extrapolation ratio.
 */
// @ts-ignore: decorator
@inline
function writePose(tree: i32, position: usize, px: f32, pz: f32, strength: f32): void {
  projectOnSway(position);
  const far = load<f32>(limits);
  const reach = sqrt(pairX * pairX + pairY * pairY) / far;
  const pressed = strength / load<f32>(limits, 8);
  store<f32>(extrapolationRatio + 4 * tree, max(reach, pressed));
  clampPair(MODAL_REACH * far);
  // Behind the pressure, which the pose is linear in, the same terms as the force's first ones.
  writeShape(pairX, pairY, position);
  const to = now + poseRow * tree;
  const old = before + poseRow * tree;
  for (let k: usize = 0; k < ownRow; k += 16) {
    v128.store(old + k, v128.load(to + k));
    v128.store(to + k, f32x4.mul(v128.load(shown + k), v128.load(position + k)));
  }
  const further = to + stateRow;
  const x = f32x4.splat(px);
  const z = f32x4.splat(pz);
  for (let k: usize = 0; k < furtherRow; k += 16) {
    v128.store(old + stateRow + k, v128.load(further + k));
    const a = f32x4.mul(x, v128.load(poseTerms + k));
    const b = f32x4.mul(z, v128.load(poseTerms + furtherRow + k));
    v128.store(further + k, f32x4.add(a, b));
  }
  addRows(posePlain, position, <i32>(ownRow >> 2), furtherRow, further);
  addRows(poseTerms + 2 * furtherRow, terms, 7 + 2 * coupled, furtherRow, further);
}

/**
 * Advances a tree by one table step under a pressure (Pa) in its own frame and the gusts behind the terms. `places`: G, or
 * 0 if there are no gusts.
 */
export function step(tree: i32, px: f32, pz: f32, places: i32): void {
  const position = e + stateRow * tree;
  const speed = v + stateRow * tree;
  const count = 44 + 6 * coupled;
  const gusts = terms + 4 * count;
  let feltX = px;
  let feltZ = pz;
  for (let g = 0; g < places; g++) {
    const weight = load<f32>(meanGust + 4 * g);
    feltX += weight * load<f32>(gusts + 4 * g);
    feltZ += weight * load<f32>(gusts + 4 * (places + g));
  }
  writeForceTerms(position, speed, feltX, feltZ);
  const x = f32x4.splat(px);
  const z = f32x4.splat(pz);
  for (let k: usize = 0; k < ownRow; k += 16) {
    const a = f32x4.mul(x, v128.load(pull + k));
    v128.store(total + k, f32x4.add(a, f32x4.mul(z, v128.load(pull + ownRow + k))));
  }
  addRows(force, terms, count + 2 * places, ownRow, total);
  if (dragPoints > 0) {
    writeMeanSpeed(position, speed);
    writeAir(px, pz, gusts, places);
    addDrag();
  }
  move(position, speed);
  if (px == 0 && pz == 0 && isAtRest(position, speed)) {
    memory.fill(position, 0, ownRow);
    memory.fill(speed, 0, ownRow);
  }
  writePose(tree, position, feltX, feltZ, sqrt(px * px + pz * pz));
}
