/**
 * The modal step in WebAssembly, compiled from web/kernel/modal.ts: memory layout and instantiation. One of four
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
const STATES = ["e", "v", "now", "before", "extrapolationRatio"] as const;
type State = (typeof STATES)[number];
type Place = Tensor | State | "terms" | "ahead" | "total" | "air" | "dragForce";
type Row = "ownRow" | "furtherRow" | "stateRow" | "poseRow";
type Setting = "halfStep_s" | "exponent" | "coupled" | "dragPoints" | "dragInputs" | Row;
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

/** A model of a tree's motion, and the modes that it displays. */
export interface KernelModel {
  readonly modal: ModalTensors;
  readonly modes: number;
  /** Duration of a step, s. */
  readonly dt_s: number;
}

/** Arrays of an instance of the kernel. */
type Arrays = Partial<Record<Place, number>>;

/** What a model's steps need; rows in floats. */
function layoutOf({ modal, modes }: KernelModel) {
  const d = modal.step.length / 6;
  const own = filled(d);
  const given = tensors(modal, d, modes - d);
  const sizes: Arrays = {
    ...lengths(given),
    terms: given.force.length / own,
    ahead: own,
    total: own,
    air: (2 * given.dragPoint.length) / 3,
    dragForce: given.dragPoint.length,
  };
  return { given, sizes, own, further: filled(modes - d) };
}

/** Instances of the kernel that share a memory, each with its own arrays; returns views of these. */
function settle(module: WebAssembly.Module, arrays: readonly Arrays[]) {
  const all = arrays.flatMap((sizes) => Object.values(sizes));
  const bytes = all.reduce((sum, length) => sum + 4 * filled(length), FIRST_BYTE);
  const memory = new WebAssembly.Memory({ initial: Math.ceil(bytes / PAGE_BYTES) });
  let at = FIRST_BYTE;
  return arrays.map((sizes) => {
    const kernel = new WebAssembly.Instance(module, { env: { memory } }).exports as unknown as Exports;
    if (Number(kernel.constantsEnd.value) > FIRST_BYTE)
      throw new Error("the kernel's constants need more room");
    const views = {} as Record<Place, Float32Array>;
    for (const [name, length] of Object.entries(sizes) as [Place, number][]) {
      kernel[name].value = at;
      views[name] = new Float32Array(memory.buffer, at, length);
      at += 4 * filled(length);
    }
    return { kernel, views };
  });
}

/** Tree states in the kernel's memory, and the step functions. */
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
   * Of each model: advances a tree by one step under a pressure (Pa) in its own frame and the gusts in `local`; `places`: G,
   * or 0 if it has none, as for all models but the first.
   */
  readonly steps: readonly Step[];

  private constructor(module: WebAssembly.Module, models: readonly KernelModel[], count: number) {
    const layouts = models.map(layoutOf);
    const [{ own, further, sizes }] = layouts;
    const row = own + further;
    const states = { e: count * own, v: count * own, now: count * row, before: count * row };
    Object.assign(sizes, states, { extrapolationRatio: count });
    const instances = settle(
      module,
      layouts.map((layout) => layout.sizes),
    );
    const [first] = instances;
    ({
      e: this.e,
      v: this.v,
      now: this.now,
      before: this.before,
      extrapolationRatio: this.extrapolationRatio,
    } = first.views);
    instances.forEach(({ kernel, views }, k) => {
      const { modal, dt_s } = models[k];
      const { given, own: stepped, further: displayed } = layouts[k];
      for (const name of Object.keys(given) as Tensor[]) views[name].set(given[name]);
      for (const name of STATES) kernel[name].value = first.kernel[name].value;
      kernel.halfStep_s.value = dt_s / 2;
      kernel.exponent.value = modal.streamlinedExponent;
      kernel.coupled.value = coupledOf(modal.limits.length);
      kernel.dragPoints.value = given.dragPoint.length / 3;
      kernel.dragInputs.value = dragInputs(modal.step.length / 6);
      kernel.ownRow.value = 4 * stepped;
      kernel.furtherRow.value = 4 * displayed;
      kernel.stateRow.value = 4 * own;
      kernel.poseRow.value = 4 * row;
    });
    this.local = first.views.terms.subarray(forceTerms(coupledOf(models[0].modal.limits.length)));
    this.ownRow = own;
    this.steps = instances.map(({ kernel }) => kernel.step);
  }

  /**
   * Returns null if WebAssembly SIMD is not supported or memory is exhausted. `models`: of the same trees; all but the first
   * step the first oscillators only, and display the first of the further modes.
   */
  static make(models: readonly KernelModel[], count: number): ModalKernel | null {
    const module = compile();
    if (!module) return null;
    try {
      return new ModalKernel(module, models, count);
    } catch {
      return null;
    }
  }
}
