/**
 * The modal step in WGSL, for one tree per invocation: the arithmetic of core/modal/modalForest.ts in single precision. The
 * fourth implementation of the step, see docs/design/0010-kernel.md.
 */
import {
  HALF_AIR_DENSITY_KG_M3,
  ISOTROPIC_DRAG,
  MODAL_REACH,
  MODAL_REST,
  STREAMLINING_PRESSURE_PA,
  STREAMLINING_SPEED_M_S,
} from "../../core/constants";
import {
  coupledOf,
  dragInputs,
  forceTerms,
  type ModalTensors,
  meanGust,
  poseTerms,
} from "../../core/modal/modalTensors";

/** Numbers per tree in the commands, before the gusts: pressure along x and z, steps, displayed part, whether there are gusts. */
export const DRIVE_FLOATS = 5;

/** Sizes of a model, by the names that its code uses. */
export interface ModalSizes {
  readonly oscillators: number;
  readonly modes: number;
  readonly places: number;
  /** Numbers per tree of the state (oscillators and their speeds, newest pose and the one before), and of the commands. */
  readonly state: number;
  readonly drive: number;
}

export interface ModalCode {
  readonly sizes: ModalSizes;
  /** All tensors, one after the other. */
  readonly model: Float32Array;
  /** `stepTree`, and the functions that it calls. */
  readonly step: string;
  readonly includes: readonly string[];
}

const whole = ({ dragPoint }: ModalTensors) => {
  let area = 0;
  for (let j = 0; j < dragPoint.length; j += 2) area += dragPoint[j];
  return area;
};

/** A number of WGSL: with a point or an exponent. */
const float = (value: number) => (Number.isInteger(value) ? value.toFixed(1) : `${value}`);

const LIMIT_PAIR = /* wgsl */ `
fn limitPair(pair: vec2<f32>, far: f32) -> vec2<f32> {
  let size = length(pair);
  return select(pair, pair * (far / size), size > far);
}`;

const SPEED_OF_PRESSURE = /* wgsl */ `
fn speedOfPressure(pressure: f32, exponent: f32) -> f32 {
  if (pressure <= ${float(STREAMLINING_PRESSURE_PA)}) { return sqrt(pressure / ${float(HALF_AIR_DENSITY_KG_M3)}); }
  return ${float(STREAMLINING_SPEED_M_S)} * pow(pressure / ${float(STREAMLINING_PRESSURE_PA)}, 1.0 / exponent);
}`;

const PRESSURE_PER_SPEED = /* wgsl */ `
fn pressurePerSpeed(speed: f32, exponent: f32) -> f32 {
  if (speed <= ${float(STREAMLINING_SPEED_M_S)}) { return ${float(HALF_AIR_DENSITY_KG_M3)} * speed; }
  return ${float(HALF_AIR_DENSITY_KG_M3 * STREAMLINING_SPEED_M_S)} * pow(speed / ${float(STREAMLINING_SPEED_M_S)}, exponent - 1.0);
}`;

/** Constants: the sizes, and where each tensor begins. */
function constants(
  modal: ModalTensors,
  modes: number,
  dt_s: number,
  tensors: Record<string, ArrayLike<number>>,
) {
  const d = modal.step.length / 6;
  const c = coupledOf(modal.limits.length);
  const m = modal.dragPoint.length / 2;
  const counts = {
    D: d,
    R: modes,
    C: c,
    M: m,
    G: modal.place.length / 3,
    INPUTS: dragInputs(d),
    FORCES: forceTerms(c),
    SHAPES: 7 + 2 * c,
    POSES: poseTerms(d, c),
  };
  let at = 0;
  const starts = Object.entries(tensors).map(([name, { length }]) => {
    const start = [name, at] as const;
    at += length;
    return start;
  });
  const numbers = {
    DT: dt_s,
    EXPONENT: modal.streamlinedExponent,
    ISOTROPIC: ISOTROPIC_DRAG / Math.max(whole(modal), 1e-30),
    REACH: MODAL_REACH,
    REST: MODAL_REST,
  };
  return [
    ...[...Object.entries(counts), ...starts].map(([name, value]) => `const ${name} = ${value}u;`),
    ...Object.entries(numbers).map(([name, value]) => `const ${name}: f32 = ${float(value)};`),
  ].join("\n  ");
}

/** One step of a tree, whose oscillators are in `e` and `v`, under the pressure (px, pz); writes its pose into `now`. */
const STEP_CODE = /* wgsl */ `
    var feltX = px;
    var feltZ = pz;
    for (var g = 0u; g < places; g++) {
      feltX += (*model)[MEAN_GUST + g] * (*drive)[gusts + g];
      feltZ += (*model)[MEAN_GUST + g] * (*drive)[gusts + G + g];
    }
    // terms of the force at the midpoint of the step
    var sway = vec2<f32>(0.0);
    var rate = vec2<f32>(0.0);
    for (var k = 0u; k < D; k++) {
      ahead[k] = e[k] + 0.5 * DT * v[k];
      let to = vec2<f32>((*model)[SWAY + k], (*model)[SWAY + D + k]);
      sway += to * ahead[k];
      rate += to * v[k];
    }
    sway = limitPair(sway, REACH * (*model)[LIMITS]);
    rate = limitPair(rate, REACH * (*model)[LIMITS + 1u]);
    let felt = limitPair(vec2<f32>(feltX, feltZ), REACH * (*model)[LIMITS + 2u]);
    SHAPE_OF(ahead)
    var to = SHAPES;
    let squares = array<f32, 3>(rate.x * rate.x, rate.x * rate.y, rate.y * rate.y);
    for (var k = 0u; k < 3u; k++) {
      terms[to + k] = squares[k];
      terms[to + 3u + 2u * k] = squares[k] * sway.x;
      terms[to + 4u + 2u * k] = squares[k] * sway.y;
    }
    to += 9u;
    for (var side = 0u; side < 4u; side++) {
      let factor = array<f32, 4>(rate.x, rate.y, felt.x, felt.y)[side];
      terms[to] = factor * sway.x;
      terms[to + 1u] = factor * sway.y;
      to += 2u;
      let shapes = select(7u, 3u, side < 2u);
      for (var k = 0u; k < shapes; k++) { terms[to + k] = factor * terms[k]; }
      to += shapes;
    }
    for (var j = 0u; j < C; j++) {
      let far = REACH * (*model)[LIMITS + 3u + j];
      let fast = REACH * (*model)[LIMITS + 3u + C + j];
      let z = clamp(ahead[2u + j], -far, far);
      let w = clamp(v[2u + j], -fast, fast);
      terms[to] = w * sway.x;
      terms[to + 1u] = w * sway.y;
      terms[to + 2u] = z * felt.x;
      terms[to + 3u] = z * felt.y;
      to += 4u;
    }
    // forces of wind and terms, and the mean speed during the step without drag
    for (var k = 0u; k < D; k++) {
      var sum = (*model)[LOAD + 2u * k] * px + (*model)[LOAD + 2u * k + 1u] * pz;
      for (var g = 0u; g < 2u * places; g++) { sum += (*model)[PLACE_LOAD + 2u * G * k + g] * (*drive)[gusts + g]; }
      for (var f = 0u; f < FORCES; f++) { sum += (*model)[FORCE + f * D + k] * terms[f]; }
      total[k] = sum;
      let at = STEP + 6u * k;
      ahead[k] = ((*model)[at] * e[k] + (*model)[at + 1u] * v[k] + (*model)[at + 4u] * sum) / DT;
    }
    // drag at the points of the crown
    var mean = 0.0;
    for (var j = 0u; j < M; j++) {
      let area = (*model)[DRAG_POINT + 2u * j];
      let share = (*model)[DRAG_POINT + 2u * j + 1u];
      var wind = vec2<f32>(px, pz);
      for (var g = 0u; g < places; g++) {
        wind += (*model)[DRAG_PLACE + j * G + g] * vec2<f32>((*drive)[gusts + g], (*drive)[gusts + G + g]);
      }
      let strength = length(wind);
      let air = select(0.0, speedOfPressure(share * strength, EXPONENT) / max(strength, 1e-30), strength > 0.0);
      var moving = vec3<f32>(0.0);
      for (var k = 0u; k < INPUTS; k++) {
        let row = DRAG_SHAPE + j * D + k;
        moving += ahead[k] * vec3<f32>((*model)[row], (*model)[row + M * D], (*model)[row + 2u * M * D]);
      }
      let relative = vec3<f32>(air * wind.x, 0.0, air * wind.y) - moving;
      let per = pressurePerSpeed(length(relative), EXPONENT);
      mean += area * per;
      let push = area * (per * relative - share * vec3<f32>(wind.x, 0.0, wind.y));
      for (var k = 0u; k < D; k++) {
        let row = DRAG_SHAPE + j * D + k;
        total[k] += dot(push, vec3<f32>((*model)[row], (*model)[row + M * D], (*model)[row + 2u * M * D]));
      }
    }
    sway = vec2<f32>(0.0);
    rate = vec2<f32>(0.0);
    var largest = 0.0;
    for (var k = 0u; k < D; k++) {
      let force = total[k] - ISOTROPIC * (*model)[DRAG_REST + k] * mean * ahead[k];
      let at = STEP + 6u * k;
      let a = e[k];
      let b = v[k];
      e[k] = a + ((*model)[at] * a + (*model)[at + 1u] * b + (*model)[at + 4u] * force);
      v[k] = b + ((*model)[at + 2u] * a + (*model)[at + 3u] * b + (*model)[at + 5u] * force);
      let to_sway = vec2<f32>((*model)[SWAY + k], (*model)[SWAY + D + k]);
      sway += to_sway * e[k];
      rate += to_sway * v[k];
      largest = max(largest, abs(e[k]));
    }
    // in still air a motion that is negligible ends
    let small = REST * (*model)[LIMITS];
    let first = max(abs((*model)[SWAY]), abs((*model)[SWAY + D]));
    if (px == 0.0 && pz == 0.0 && max(abs(sway.x), abs(sway.y)) <= small
        && max(abs(rate.x), abs(rate.y)) <= REST * (*model)[LIMITS + 1u] && largest * first < small) {
      for (var k = 0u; k < D; k++) {
        e[k] = 0.0;
        v[k] = 0.0;
      }
      sway = vec2<f32>(0.0);
    }
    sway = limitPair(sway, REACH * (*model)[LIMITS]);
    SHAPE_OF(e)
    for (var k = 0u; k < R; k++) {
      before[k] = now[k];
      if (k < D) {
        now[k] = (*model)[SHOWN + k] * e[k];
        continue;
      }
      let row = POSE + k - D;
      let width = R - D;
      var sum = feltX * (*model)[row + D * width] + feltZ * (*model)[row + (D + 1u) * width];
      for (var f = 0u; f < D; f++) { sum += (*model)[row + f * width] * e[f]; }
      for (var f = 0u; f < SHAPES; f++) { sum += (*model)[row + (D + 2u + f) * width] * terms[f]; }
      now[k] = sum;
    }`;

/** Terms in the pose alone: sway of degree 2 and 3, each coupled coordinate times the sway. */
const shapeOf = (values: string) => /* wgsl */ `
    terms[0] = sway.x * sway.x;
    terms[1] = sway.x * sway.y;
    terms[2] = sway.y * sway.y;
    terms[3] = terms[0] * sway.x;
    terms[4] = terms[0] * sway.y;
    terms[5] = terms[2] * sway.x;
    terms[6] = terms[2] * sway.y;
    for (var j = 0u; j < C; j++) {
      let far = REACH * (*model)[LIMITS + 3u + j];
      let z = clamp(${values}[2u + j], -far, far);
      terms[7u + 2u * j] = z * sway.x;
      terms[8u + 2u * j] = z * sway.y;
    }`;

/** The code of a table's step. `modes`: displayed ones. `dt_s`: length of a step. */
export function modalCode(modal: ModalTensors, modes: number, dt_s: number): ModalCode {
  const oscillators = modal.step.length / 6;
  const places = modal.place.length / 3;
  const tensors = {
    STEP: modal.step,
    LOAD: modal.load,
    SWAY: modal.sway,
    FORCE: modal.force,
    SHOWN: modal.shown,
    POSE: modal.pose,
    LIMITS: modal.limits,
    DRAG_POINT: modal.dragPoint,
    DRAG_SHAPE: modal.dragShape,
    DRAG_REST: modal.dragRest,
    DRAG_PLACE: modal.dragPlace,
    PLACE_LOAD: modal.placeLoad,
    MEAN_GUST: meanGust(modal),
  };
  const sizes = {
    oscillators,
    modes,
    places,
    state: 2 * oscillators + 2 * modes,
    drive: DRIVE_FLOATS + 2 * places,
  };
  const body = STEP_CODE.replace(/SHAPE_OF\((\w+)\)/g, (_, values: string) => shapeOf(values));
  const step = /* wgsl */ `
fn stepTree(model: ptr<storage, array<f32>, read>, state: ptr<storage, array<f32>, read_write>, drive: ptr<storage, array<f32>, read>, shown: ptr<storage, array<f32>, read_write>, tree: u32, count: u32) -> void {
  ${constants(modal, modes, dt_s, tensors)}
  if (tree >= count) { return; }
  let commands = tree * ${sizes.drive}u;
  let px = (*drive)[commands];
  let pz = (*drive)[commands + 1u];
  let steps = u32((*drive)[commands + 2u]);
  let part = (*drive)[commands + 3u];
  let places = select(0u, G, (*drive)[commands + 4u] > 0.0);
  let gusts = commands + ${DRIVE_FLOATS}u;
  var e: array<f32, D>;
  var v: array<f32, D>;
  var ahead: array<f32, D>;
  var total: array<f32, D>;
  var now: array<f32, R>;
  var before: array<f32, R>;
  var terms: array<f32, FORCES>;
  // The numbers of all trees lie side by side, so that invocations read neighbouring ones.
  for (var k = 0u; k < D; k++) {
    e[k] = (*state)[k * count + tree];
    v[k] = (*state)[(D + k) * count + tree];
  }
  for (var k = 0u; k < R; k++) {
    now[k] = (*state)[(2u * D + k) * count + tree];
    before[k] = (*state)[(2u * D + R + k) * count + tree];
  }
  for (var s = 0u; s < steps; s++) {${body}
  }
  if (steps > 0u) {
    for (var k = 0u; k < D; k++) {
      (*state)[k * count + tree] = e[k];
      (*state)[(D + k) * count + tree] = v[k];
    }
    for (var k = 0u; k < R; k++) {
      (*state)[(2u * D + k) * count + tree] = now[k];
      (*state)[(2u * D + R + k) * count + tree] = before[k];
    }
  }
  for (var k = 0u; k < R; k++) { (*shown)[tree * R + k] = before[k] + (now[k] - before[k]) * part; }
}`;
  const model = Float32Array.from(Object.values(tensors).flatMap((tensor) => [...tensor]));
  return { sizes, model, step, includes: [LIMIT_PAIR, SPEED_OF_PRESSURE, PRESSURE_PER_SPEED] };
}
