/**
 * The modal step in WebAssembly, compiled from web/kernel/modal.ts: memory layout and instantiation. One of three
 * implementations of the step, see docs/design/0010-kernel.md.
 */
import { ISOTROPIC_DRAG } from "../constants";
import { MODAL_KERNEL } from "./modalKernel.wasm";
import { coupledOf, dragInputs, forceTerms, type ModalTensors, meanGust } from "./modalTensors";

const PAGE_BYTES = 65_536;
/** Floats per SIMD vector; rows are padded to a multiple. */
const SIMD_LANES = 4;
/** Data starts here, behind the constants that the compiler placed in the memory (tables of the power function). */
const FIRST_BYTE = 4096;

type DragTensor = "dragPoint" | "dragIn" | "dragOut" | "dragRest" | "dragPlace";
type Tensor =
  | ("stepping" | "pull" | "sway" | "force" | "meanGust" | "shown" | "posePlain" | "poseTerms" | "limits")
  | DragTensor;
type State = "e" | "v" | "now" | "before" | "extrapolationRatio";
type Place = Tensor | State | "terms" | "ahead" | "total" | "air" | "dragForce";
type Setting = "halfStep_s" | "exponent" | "coupled" | "ownRow" | "furtherRow" | "dragPoints" | "dragInputs";
type Step = (tree: number, px: number, pz: number, places: number) => void;
type Exports = Record<Place | Setting | "constantsEnd", WebAssembly.Global> & { step: Step };

const filled = (count: number) => SIMD_LANES * Math.ceil(count / SIMD_LANES);

/** [rows, width] with zero-padded rows. */
function inFullRows(values: Float32Array, width: number): Float32Array {
  if (width === 0) return new Float32Array(0);
  const rows = values.length / width;
  const full = new Float32Array(rows * filled(width));
  for (let row = 0; row < rows; row++) {
    full.set(values.subarray(row * width, (row + 1) * width), row * filled(width));
  }
  return full;
}

function transposed(values: Float32Array, width: number): Float32Array {
  const rows = values.length / width;
  return values.map((_, at) => values[(at % rows) * width + Math.floor(at / rows)]);
}

let compiled: WebAssembly.Module | null | undefined;

/** The compiled kernel; null if this machine cannot run it. */
function compile(): WebAssembly.Module | null {
  if (compiled !== undefined) return compiled;
  try {
    const bytes = Uint8Array.from(MODAL_KERNEL.match(/../g) ?? [], (pair) => Number.parseInt(pair, 16));
    compiled = new WebAssembly.Module(bytes);
  } catch {
    compiled = null;
  }
  return compiled;
}

/** The table's tensors in the kernel's layout. */
function tensors(modal: ModalTensors, d: number, further: number): Record<Tensor, Float32Array> {
  const placeLoad = transposed(modal.placeLoad, (2 * modal.place.length) / 3);
  return {
    stepping: inFullRows(transposed(modal.step, 6), d),
    pull: inFullRows(transposed(modal.load, 2), d),
    sway: inFullRows(modal.sway, d),
    force: Float32Array.from([...inFullRows(modal.force, d), ...inFullRows(placeLoad, d)]),
    meanGust: Float32Array.from(meanGust(modal)),
    shown: inFullRows(modal.shown, d),
    posePlain: inFullRows(modal.pose.subarray(0, d * further), further),
    poseTerms: inFullRows(modal.pose.subarray(d * further), further),
    limits: modal.limits,
    ...dragTensors(modal, d),
  };
}

/** The tensors of the drag, points padded to whole vectors. */
function dragTensors({ dragPoint, dragShape, dragRest, dragPlace, place }: ModalTensors, d: number) {
  const m = dragPoint.length / 2;
  const full = filled(m);
  const inputs = dragInputs(d);
  const own = filled(d);
  const point = new Float32Array(3 * full);
  const into = new Float32Array(inputs * 3 * full);
  const out = new Float32Array(3 * full * own);
  let whole = 0;
  for (let j = 0; j < m; j++) whole += dragPoint[2 * j];
  for (let j = 0; j < m; j++) {
    point[j] = dragPoint[2 * j];
    point[full + j] = dragPoint[2 * j + 1];
    point[2 * full + j] = (ISOTROPIC_DRAG * dragPoint[2 * j]) / whole;
    for (let side = 0; side < 3; side++) {
      const row = dragShape.subarray((side * m + j) * d, (side * m + j + 1) * d);
      out.set(row, (side * full + j) * own);
      for (let k = 0; k < inputs; k++) into[(k * 3 + side) * full + j] = row[k];
    }
  }
  return {
    dragPoint: point,
    dragIn: into,
    dragOut: out,
    dragRest: inFullRows(dragRest, d),
    dragPlace: inFullRows(transposed(dragPlace, place.length / 3), m),
  };
}

function lengths(given: Record<Tensor, Float32Array>): Record<Tensor, number> {
  const all = Object.entries(given).map(([name, { length }]) => [name, length]);
  return Object.fromEntries(all) as Record<Tensor, number>;
}

/** Instantiates the kernel with its own memory, and returns views of its arrays. */
function settle(module: WebAssembly.Module, sizes: Record<Place, number>) {
  const places = Object.entries(sizes) as [Place, number][];
  const bytes = places.reduce((sum, [, length]) => sum + 4 * filled(length), FIRST_BYTE);
  const memory = new WebAssembly.Memory({ initial: Math.ceil(bytes / PAGE_BYTES) });
  const kernel = new WebAssembly.Instance(module, { env: { memory } }).exports as unknown as Exports;
  if (Number(kernel.constantsEnd.value) > FIRST_BYTE)
    throw new Error("the kernel's constants need more room");
  const views = {} as Record<Place, Float32Array>;
  let at = FIRST_BYTE;
  for (const [name, length] of places) {
    kernel[name].value = at;
    views[name] = new Float32Array(memory.buffer, at, length);
    at += 4 * filled(length);
  }
  return { kernel, views };
}

/** Tree states in the kernel's memory, and the step function. */
export class ModalKernel {
  /** Floats per row of oscillators, padding included. */
  readonly ownRow: number;
  /** [count, ownRow] */
  readonly e: Float32Array;
  readonly v: Float32Array;
  /** [count, ownRow + the remaining modes, padded] */
  readonly now: Float32Array;
  readonly before: Float32Array;
  /** [count] */
  readonly extrapolationRatio: Float32Array;
  /** [2, G] gusts at the places of the tree that steps next, Pa. */
  readonly local: Float32Array;
  /**
   * Advances a tree by one table step under a pressure (Pa) in its own frame and the gusts in `local`; `places`: G, or 0 if
   * it has none.
   */
  readonly step: Step;

  private constructor(
    module: WebAssembly.Module,
    modal: ModalTensors,
    modes: number,
    count: number,
    dt_s: number,
  ) {
    const d = modal.step.length / 6;
    const own = filled(d);
    const row = own + filled(modes - d);
    const given = tensors(modal, d, modes - d);
    const coupled = coupledOf(modal.limits.length);
    const { kernel, views } = settle(module, {
      ...lengths(given),
      terms: given.force.length / own,
      ahead: own,
      total: own,
      air: (2 * given.dragPoint.length) / 3,
      dragForce: given.dragPoint.length,
      e: count * own,
      v: count * own,
      now: count * row,
      before: count * row,
      extrapolationRatio: count,
    });
    for (const name of Object.keys(given) as Tensor[]) views[name].set(given[name]);
    kernel.halfStep_s.value = dt_s / 2;
    kernel.exponent.value = modal.streamlinedExponent;
    kernel.coupled.value = coupled;
    kernel.dragPoints.value = given.dragPoint.length / 3;
    kernel.dragInputs.value = dragInputs(d);
    kernel.ownRow.value = 4 * own;
    kernel.furtherRow.value = 4 * (row - own);
    ({
      e: this.e,
      v: this.v,
      now: this.now,
      before: this.before,
      extrapolationRatio: this.extrapolationRatio,
    } = views);
    this.local = views.terms.subarray(forceTerms(coupled));
    this.ownRow = own;
    this.step = kernel.step;
  }

  /** Returns null if WebAssembly SIMD is not supported or memory is exhausted. */
  static make(modal: ModalTensors, modes: number, count: number, dt_s: number): ModalKernel | null {
    const module = compile();
    if (!module) return null;
    try {
      return new ModalKernel(module, modal, modes, count, dt_s);
    } catch {
      return null;
    }
  }
}
