// One step of the modal reduced-order model for one tree, four oscillators at a time, in single precision.
// AssemblyScript: `npm run kernel` compiles it to ../player/src/core/modal/modalKernel.wasm.ts. Addresses are in bytes;
// ../player/src/core/modal/modalKernel.ts defines the memory layout. One of three implementations of the step, with
// ../player/src/core/modal/modalForest.ts and numba in precompute/galewood/motion/modal/; see docs/design/0010-kernel.md.

import { MODAL_REACH, MODAL_REST } from "./constants";
import { perSpeeds, shelteredSpeeds } from "./pressure";

/** End of the constants that the compiler placed in the memory. */
export const constantsEnd: usize = __heap_base;

/**
 * A model in the memory: its numbers, and the addresses of its arrays, in the order of `FIELDS` in modalKernel.ts. Rows are padded
 * to whole vectors, lengths of rows are in bytes. Arrays that a step reads lie in the order in which it reads them.
 */
@unmanaged
class Model {
  /** Half the step, s. */
  halfStep_s: f32;
  /** Power of the wind speed with which the pressure grows above 5 m/s. */
  exponent: f32;
  /** Coupled coordinates. */
  coupled: i32;
  /** A row of the d oscillators and one of the r − d further modes. */
  ownRow: usize;
  furtherRow: usize;
  /**
   * A tree: its displacements, speeds, and poses after the last step and the one before. Where the last three begin, and
   * where the further modes begin in a pose. A coarse model of the same trees has shorter rows and steps the first oscillators only.
   */
  stateRow: usize;
  speedAt: usize;
  nowAt: usize;
  beforeAt: usize;
  furtherAt: usize;
  /** Trees. */
  states: usize;
  /** Sums of the terms that take their place, or 0: the terms themselves drive the model. */
  sums: i32;
  /** Rows of `drive` before those of the gusts, and rows of the pose that are not zero. */
  driveRows: i32;
  poseRows: i32;
  poseTermRows: i32;
  /** Drag points, padded to whole vectors; oscillators whose speeds move them, and how many of these are whole vectors. */
  dragPoints: i32;
  dragInputs: i32;
  dragShared: i32;
  /** Room for what drives the model: [2] the pressure, Pa; the terms or their sums; [2, G] the gusts at the places, Pa. */
  factors: usize;
  /** Room for the terms; room for one row of oscillators, one of their forces, [2, points] air, Pa, and [3, points] forces. */
  terms: usize;
  ahead: usize;
  total: usize;
  air: usize;
  dragForce: usize;
  /** [3 + 2c] */
  limits: usize;
  /** [2, d] */
  sway: usize;
  /** [sums, 44 + 6c] shares of the terms in each sum, rows padded */
  termShare: usize;
  /** [6, d] r00 − 1, r01, r10, r11 − 1, s0, s1 */
  stepping: usize;
  /** [inputs, 3 · points] velocity x of all points, then y, z, per unit of each speed */
  dragIn: usize;
  /** [3, points] area, m²; share of the pressure in shelter; weight in the mean */
  dragPoint: usize;
  /** [d] */
  dragRest: usize;
  /** [3 · points, d − shared] the same velocities per unit of the other speeds */
  dragOut: usize;
  /** [d] */
  shown: usize;
  /** [d, r − d] and [9 + 2c, r − d], without the last rows if these are zero */
  posePlain: usize;
  poseTerms: usize;
  /** [2 + 44 + 6c + 2G, d] or [2 + sums + 2G, d]: loads of the pressure, of the terms or sums, and of the gusts along x and z */
  drive: usize;
  /** [G] weights of the places in the mean gust over the crown */
  meanGust: usize;
  /** [G, points] gust at each point per unit of those at the places */
  dragPlace: usize;
}

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
function projectOnSway(m: Model, row: usize): void {
  let x = f32x4.splat(0);
  let y = f32x4.splat(0);
  for (let k: usize = 0, at = m.sway; k < m.ownRow; k += 16, at += 16) {
    const value = v128.load(row + k);
    x = f32x4.add(x, f32x4.mul(value, v128.load(at)));
    y = f32x4.add(y, f32x4.mul(value, v128.load(at + m.ownRow)));
  }
  pairX = sum(x);
  pairY = sum(y);
}

/** Limits the length of the pair to `far`. */
function clampPair(far: f32): void {
  const square = pairX * pairX + pairY * pairY;
  if (square <= far * far) return;
  const share = far / sqrt(square);
  pairX *= share;
  pairY *= share;
}

/** Terms in the pose alone: sway of degree 2 and 3, each coupled coordinate of a row times the sway. */
function writeShape(m: Model, x: f32, y: f32, row: usize): void {
  const terms = m.terms;
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
  for (let j = 0; j < m.coupled; j++) {
    const far = MODAL_REACH * load<f32>(m.limits + 4 * j, 12);
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
function writeProducts(m: Model, factor: f32, x: f32, y: f32, shapes: usize, to: usize): usize {
  store<f32>(to, factor * x);
  store<f32>(to, factor * y, 4);
  to += 8;
  for (let k: usize = 0; k < shapes; k++, to += 4) store<f32>(to, factor * load<f32>(m.terms + 4 * k));
  return to;
}

/** Each coupled coordinate's speed times the sway, and the coordinate times the pressure, which is the pair. */
// @ts-ignore: decorator
@inline
function writeCoupled(m: Model, x: f32, y: f32, speed: usize, to: usize): void {
  for (let j = 0; j < m.coupled; j++, to += 16) {
    const far = MODAL_REACH * load<f32>(m.limits + 4 * j, 12);
    const fast = MODAL_REACH * load<f32>(m.limits + 4 * (m.coupled + j), 12);
    const z = min(max(load<f32>(m.ahead + 4 * j, 8), -far), far);
    const w = min(max(load<f32>(speed + 4 * j, 8), -fast), fast);
    store<f32>(to, w * x);
    store<f32>(to, w * y, 4);
    store<f32>(to, z * pairX, 8);
    store<f32>(to, z * pairY, 12);
  }
}

/** Adds `count` rows of a matrix, each times its number in `factors`, to `out`. */
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

/** The sums of four vectors. */
// @ts-ignore: decorator
@inline
function sums(a: v128, b: v128, c: v128, d: v128): v128 {
  const ab = f32x4.add(v128.shuffle<f32>(a, b, 0, 4, 1, 5), v128.shuffle<f32>(a, b, 2, 6, 3, 7));
  const cd = f32x4.add(v128.shuffle<f32>(c, d, 0, 4, 1, 5), v128.shuffle<f32>(c, d, 2, 6, 3, 7));
  return f32x4.add(v128.shuffle<f32>(ab, cd, 0, 1, 4, 5), v128.shuffle<f32>(ab, cd, 2, 3, 6, 7));
}

/** Adds the products of `count` rows of a matrix, a multiple of four, with a row to `out`. */
// @ts-ignore: decorator
@inline
function addProducts(matrix: usize, factors: usize, count: i32, row: usize, out: usize): void {
  for (let f = 0; f < count; f += 4, matrix += 4 * row, out += 16) {
    let a = f32x4.splat(0);
    let b = a;
    let c = a;
    let d = a;
    for (let k: usize = 0, at = matrix; k < row; k += 16, at += 16) {
      const factor = v128.load(factors + k);
      a = f32x4.add(a, f32x4.mul(factor, v128.load(at)));
      b = f32x4.add(b, f32x4.mul(factor, v128.load(at + row)));
      c = f32x4.add(c, f32x4.mul(factor, v128.load(at + 2 * row)));
      d = f32x4.add(d, f32x4.mul(factor, v128.load(at + 3 * row)));
    }
    v128.store(out, f32x4.add(v128.load(out), sums(a, b, c, d)));
  }
}

/** The pressure and all terms of the force at the midpoint of the step, extrapolated from the current state, in the mean wind (Pa). */
// @ts-ignore: decorator
@inline
function writeForceTerms(m: Model, position: usize, speed: usize, px: f32, pz: f32): void {
  const half = f32x4.splat(m.halfStep_s);
  for (let k: usize = 0; k < m.ownRow; k += 16) {
    v128.store(m.ahead + k, f32x4.add(v128.load(position + k), f32x4.mul(half, v128.load(speed + k))));
  }
  projectOnSway(m, m.ahead);
  clampPair(MODAL_REACH * load<f32>(m.limits));
  const x = pairX;
  const y = pairY;
  writeShape(m, x, y, m.ahead);
  let to = m.terms + 28 + 8 * m.coupled;
  projectOnSway(m, speed);
  clampPair(MODAL_REACH * load<f32>(m.limits, 4));
  writeSquares(x, y, to);
  to = writeProducts(m, pairX, x, y, 3, to + 36);
  to = writeProducts(m, pairY, x, y, 3, to);
  pairX = px;
  pairY = pz;
  clampPair(MODAL_REACH * load<f32>(m.limits, 8));
  to = writeProducts(m, pairX, x, y, 7, to);
  to = writeProducts(m, pairY, x, y, 7, to);
  writeCoupled(m, x, y, speed, to);
}

/** The sums of the terms by which they drive the model, instead of the terms. */
// @ts-ignore: decorator
@inline
function sumTerms(m: Model): void {
  const row: usize = (4 * (44 + 6 * m.coupled) + 15) & ~15;
  for (let f = 0, at = m.termShare, to = m.factors + 8; f < m.sums; f++, at += row, to += 4) {
    let all = f32x4.splat(0);
    for (let k: usize = 0; k < row; k += 16) {
      all = f32x4.add(all, f32x4.mul(v128.load(m.terms + k), v128.load(at + k)));
    }
    store<f32>(to, sum(all));
  }
}

/** Whether the motion is negligible, so that a tree in still air can be set to rest. */
function isAtRest(m: Model, position: usize, speed: usize): bool {
  const small = MODAL_REST * load<f32>(m.limits);
  projectOnSway(m, position);
  if (max(abs(pairX), abs(pairY)) > small) return false;
  projectOnSway(m, speed);
  if (max(abs(pairX), abs(pairY)) > MODAL_REST * load<f32>(m.limits, 4)) return false;
  let largest: f32 = 0;
  for (let k: usize = 0; k < m.ownRow; k += 4) largest = max(largest, abs(load<f32>(position + k)));
  return largest * max(abs(load<f32>(m.sway)), abs(load<f32>(m.sway + m.ownRow))) < small;
}

/** The mean speed during the step, without the drag, into `ahead`. */
// @ts-ignore: decorator
@inline
function writeMeanSpeed(m: Model, position: usize, speed: usize): void {
  const rate = f32x4.splat((0.5 as f32) / m.halfStep_s);
  const row = m.ownRow;
  for (let k: usize = 0, at = m.stepping; k < row; k += 16, at += 16) {
    const r00 = f32x4.mul(v128.load(at), v128.load(position + k));
    const r01 = f32x4.mul(v128.load(at + row), v128.load(speed + k));
    const s0 = f32x4.mul(v128.load(at + 4 * row), v128.load(m.total + k));
    v128.store(m.ahead + k, f32x4.mul(rate, f32x4.add(f32x4.add(r00, r01), s0)));
  }
}

/** The wind at the drag points, in `air`: that at the tree plus the gusts of the places around. */
// @ts-ignore: decorator
@inline
function writeAir(m: Model, px: f32, pz: f32, gusts: usize, places: i32): void {
  const side: usize = 4 * m.dragPoints;
  for (let j: usize = 0; j < side; j += 16) {
    let x = f32x4.splat(px);
    let z = f32x4.splat(pz);
    for (let g = 0, at = m.dragPlace + j; g < places; g++, at += side) {
      const weight = v128.load(at);
      x = f32x4.add(x, f32x4.mul(weight, v128.load32_splat(gusts + 4 * g)));
      z = f32x4.add(z, f32x4.mul(weight, v128.load32_splat(gusts + 4 * (places + g))));
    }
    v128.store(m.air + j, x);
    v128.store(m.air + side + j, z);
  }
}

/** Adds the drag at the speeds in `ahead` to `total`: four points at a time. */
// @ts-ignore: decorator
@inline
function addDrag(m: Model): void {
  const side: usize = 4 * m.dragPoints;
  const exponent = m.exponent;
  let mean = f32x4.splat(0);
  for (let j: usize = 0; j < side; j += 16) {
    let x = f32x4.splat(0);
    let y = f32x4.splat(0);
    let z = f32x4.splat(0);
    for (let k = 0, at = m.dragIn + j; k < m.dragInputs; k++, at += 3 * side) {
      const speed = v128.load32_splat(m.ahead + 4 * k);
      x = f32x4.add(x, f32x4.mul(speed, v128.load(at)));
      y = f32x4.add(y, f32x4.mul(speed, v128.load(at + side)));
      z = f32x4.add(z, f32x4.mul(speed, v128.load(at + 2 * side)));
    }
    const point = m.dragPoint + j;
    const area = v128.load(point);
    const share = v128.load(point + side);
    const pressureX = v128.load(m.air + j);
    const pressureZ = v128.load(m.air + side + j);
    const wind = f32x4.sqrt(f32x4.add(f32x4.mul(pressureX, pressureX), f32x4.mul(pressureZ, pressureZ)));
    const speed = shelteredSpeeds(f32x4.mul(share, wind), exponent);
    const perPressure = f32x4.div(speed, f32x4.max(wind, f32x4.splat(LEAST_PA)));
    x = f32x4.sub(f32x4.mul(perPressure, pressureX), x);
    z = f32x4.sub(f32x4.mul(perPressure, pressureZ), z);
    const square = f32x4.add(f32x4.mul(x, x), f32x4.add(f32x4.mul(y, y), f32x4.mul(z, z)));
    const per = perSpeeds(f32x4.sqrt(square), exponent);
    mean = f32x4.add(mean, f32x4.mul(per, v128.load(point + 2 * side)));
    const steadyX = f32x4.mul(share, pressureX);
    const steadyZ = f32x4.mul(share, pressureZ);
    const force = m.dragForce + j;
    v128.store(force, f32x4.mul(area, f32x4.sub(f32x4.mul(per, x), steadyX)));
    v128.store(force + side, f32x4.mul(area, f32x4.neg(f32x4.mul(per, y))));
    v128.store(force + 2 * side, f32x4.mul(area, f32x4.sub(f32x4.mul(per, z), steadyZ)));
  }
  const rest = f32x4.splat(sum(mean));
  for (let k: usize = 0; k < m.ownRow; k += 16) {
    const lost = f32x4.mul(f32x4.mul(rest, v128.load(m.dragRest + k)), v128.load(m.ahead + k));
    v128.store(m.total + k, f32x4.sub(v128.load(m.total + k), lost));
  }
  // The points push the oscillators by the same matrix by which these move the points.
  const shared: usize = 4 * m.dragShared;
  addProducts(m.dragIn, m.dragForce, m.dragShared, 3 * side, m.total);
  addRows(m.dragOut, m.dragForce, 3 * m.dragPoints, m.ownRow - shared, m.total + shared);
}

/** Each oscillator's own step under the total force. */
// @ts-ignore: decorator
@inline
function move(m: Model, position: usize, speed: usize): void {
  const row = m.ownRow;
  for (let k: usize = 0; k < row; k += 16) {
    const a = v128.load(position + k);
    const b = v128.load(speed + k);
    const f = v128.load(m.total + k);
    let at = m.stepping + k;
    const r00 = f32x4.mul(v128.load(at), a);
    const r01 = f32x4.mul(v128.load((at += row)), b);
    const r10 = f32x4.mul(v128.load((at += row)), a);
    const r11 = f32x4.mul(v128.load((at += row)), b);
    const s0 = f32x4.mul(v128.load((at += row)), f);
    const s1 = f32x4.mul(v128.load(at + row), f);
    v128.store(position + k, f32x4.add(a, f32x4.add(f32x4.add(r00, r01), s0)));
    v128.store(speed + k, f32x4.add(b, f32x4.add(f32x4.add(r10, r11), s1)));
  }
}

/** Writes the pose of the current state in the mean wind over the crown (Pa), and keeps the previous one; returns the sway over its limit. */
// @ts-ignore: decorator
@inline
function writePose(m: Model, position: usize, px: f32, pz: f32): f32 {
  projectOnSway(m, position);
  const far = load<f32>(m.limits);
  const reach = sqrt(pairX * pairX + pairY * pairY) / far;
  clampPair(MODAL_REACH * far);
  // Behind the pressure, which the pose is linear in, the same terms as the force's first ones.
  writeShape(m, pairX, pairY, position);
  const to = position + m.nowAt;
  const old = position + m.beforeAt;
  for (let k: usize = 0; k < m.ownRow; k += 16) {
    v128.store(old + k, v128.load(to + k));
    v128.store(to + k, f32x4.mul(v128.load(m.shown + k), v128.load(position + k)));
  }
  const further = to + m.furtherAt;
  const row = m.furtherRow;
  const x = f32x4.splat(px);
  const z = f32x4.splat(pz);
  for (let k: usize = 0, at = m.poseTerms; k < row; k += 16, at += 16) {
    v128.store(old + m.furtherAt + k, v128.load(further + k));
    v128.store(further + k, f32x4.add(f32x4.mul(x, v128.load(at)), f32x4.mul(z, v128.load(at + row))));
  }
  addRows(m.posePlain, position, m.poseRows, row, further);
  addRows(m.poseTerms + 2 * row, m.terms, m.poseTermRows, row, further);
  return reach;
}

/**
 * Advances a tree of a model by one of its steps under a pressure (Pa) in its own frame and the gusts behind the factors.
 * `places`: G, or 0 if there are no gusts. Returns sway or pressure over the largest sampled value.
 */
export function step(model: usize, tree: i32, px: f32, pz: f32, places: i32): f32 {
  const m = changetype<Model>(model);
  const position = m.states + m.stateRow * tree;
  const speed = position + m.speedAt;
  const gusts = m.factors + 4 * m.driveRows;
  let feltX = px;
  let feltZ = pz;
  for (let g = 0; g < places; g++) {
    const weight = load<f32>(m.meanGust + 4 * g);
    feltX += weight * load<f32>(gusts + 4 * g);
    feltZ += weight * load<f32>(gusts + 4 * (places + g));
  }
  writeForceTerms(m, position, speed, feltX, feltZ);
  sumTerms(m);
  store<f32>(m.factors, px);
  store<f32>(m.factors, pz, 4);
  memory.fill(m.total, 0, m.ownRow);
  addRows(m.drive, m.factors, m.driveRows + 2 * places, m.ownRow, m.total);
  if (m.dragPoints > 0) {
    writeMeanSpeed(m, position, speed);
    writeAir(m, px, pz, gusts, places);
    addDrag(m);
  }
  move(m, position, speed);
  if (px == 0 && pz == 0 && isAtRest(m, position, speed)) {
    memory.fill(position, 0, m.ownRow);
    memory.fill(speed, 0, m.ownRow);
  }
  return max(writePose(m, position, feltX, feltZ), sqrt(px * px + pz * pz) / load<f32>(m.limits, 8));
}
