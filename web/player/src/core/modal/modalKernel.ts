/**
 * The modal step in WebAssembly, compiled from web/kernel/modal.ts: memory layout and instantiation. One of four
 * implementations of the step, see docs/design/0010-kernel.md.
 */
import { ISOTROPIC_DRAG } from "../constants";
import { MODAL_KERNEL } from "./modalKernel.wasm";
import { coupledOf, dragInputs, type ModalTensors, meanGust } from "./modalTensors";
import { sumsOf } from "./termSums";

const PAGE_BYTES = 65_536;
/**
 * Forests share memories of this size, as a processor keeps the addresses of few pages at hand; a larger forest has a memory of
 * its own.
 */
const SHARED_BYTES = 4 << 20;
/** Floats per SIMD vector; rows are padded to a multiple. */
const SIMD_LANES = 4;
/** Data starts here, behind the constants that the compiler placed in the memory (tables of the power function). */
export const FIRST_BYTE = 4096;

type Step = (model: number, tree: number, px: number, pz: number, places: number) => number;

/** Fields of a model in the memory, padded. */
const HEAD_FLOATS = 40;

const sum = (values: readonly number[]) => values.reduce((all, one) => all + one, 0);
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

/** Rows without the last ones if these are zero. */
function withoutLast(values: Float32Array, width: number): Float32Array {
  const last = values.findLastIndex((value) => value !== 0);
  return values.subarray(0, width * Math.ceil((last + 1) / width));
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

/** A memory with the kernel that works in it, and room for what its steps compute. */
class KernelMemory {
  readonly step: Step;
  private readonly memory: WebAssembly.Memory;
  private at = FIRST_BYTE;
  private work: Float32Array = new Float32Array(0);

  constructor(module: WebAssembly.Module, bytes: number) {
    this.memory = new WebAssembly.Memory({ initial: Math.ceil(bytes / PAGE_BYTES) });
    this.step = new WebAssembly.Instance(module, { env: { memory: this.memory } }).exports.step as Step;
  }

  /** Whether there is room for so many floats. */
  holds(floats: number): boolean {
    return this.at + 4 * floats <= this.memory.buffer.byteLength;
  }

  take(floats: number): Float32Array {
    const taken = new Float32Array(this.memory.buffer, this.at, floats);
    this.at += 4 * filled(floats);
    return taken;
  }

  /** Room that all steps share. */
  workOf(floats: number): Float32Array {
    if (this.work.length < floats) this.work = this.take(floats);
    return this.work;
  }
}

let shared: KernelMemory | undefined;

/** A memory with room for so many floats. */
function memoryOf(module: WebAssembly.Module, floats: number): KernelMemory {
  if (!shared?.holds(floats))
    shared = new KernelMemory(module, Math.max(SHARED_BYTES, FIRST_BYTE + 4 * floats));
  return shared;
}

/** The tensors of the drag, points padded to whole vectors. */
function dragTensors({ dragPoint, dragShape, dragPlace, place }: ModalTensors, d: number) {
  const m = dragPoint.length / 2;
  const full = filled(m);
  const inputs = dragInputs(d);
  // Of these oscillators one matrix serves both ways.
  const common = inputs - (inputs % SIMD_LANES);
  const other = filled(d) - common;
  const point = new Float32Array(3 * full);
  const into = new Float32Array(inputs * 3 * full);
  const out = new Float32Array(3 * full * other);
  let whole = 0;
  for (let j = 0; j < m; j++) whole += dragPoint[2 * j];
  for (let j = 0; j < m; j++) {
    point[j] = dragPoint[2 * j];
    point[full + j] = dragPoint[2 * j + 1];
    point[2 * full + j] = (ISOTROPIC_DRAG * dragPoint[2 * j]) / whole;
    for (let side = 0; side < 3; side++) {
      const row = dragShape.subarray((side * m + j) * d, (side * m + j + 1) * d);
      out.set(row.subarray(common), (side * full + j) * other);
      for (let k = 0; k < inputs; k++) into[(k * 3 + side) * full + j] = row[k];
    }
  }
  return {
    points: full,
    inputs,
    common,
    point,
    into,
    out,
    place: inFullRows(transposed(dragPlace, place.length / 3), m),
  };
}

/** A model of a tree's motion, and the modes that it displays. */
export interface KernelModel {
  readonly modal: ModalTensors;
  readonly modes: number;
  /** Duration of a step, s. */
  readonly dt_s: number;
}

/** A model as the kernel reads it; lengths in floats. */
function layoutOf({ modal, modes, dt_s }: KernelModel) {
  const d = modal.step.length / 6;
  const further = modes - d;
  const pose = filled(further);
  const own = filled(d);
  const terms = modal.force.length / d;
  const places = modal.place.length / 3;
  const few = sumsOf(modal.force, d);
  const driveRows = 2 + (few ? few.count : terms);
  const drag = dragTensors(modal, d);
  const posePlain = inFullRows(withoutLast(modal.pose.subarray(0, d * further), further), further);
  const poseTerms = inFullRows(modal.pose.subarray(d * further), further);
  const shapes = withoutLast(poseTerms.subarray(2 * pose), pose);
  const rows = [modal.load, modal.placeLoad].map((load) => inFullRows(transposed(load, load.length / d), d));
  return {
    own,
    pose,
    places,
    driveRows,
    /** Room for the factors, the terms (0: among the factors), and the rest, in the order of the kernel's fields. */
    work: [
      driveRows + 2 * places,
      few ? terms + SIMD_LANES : 0,
      own,
      own,
      2 * drag.points,
      3 * drag.points,
    ].map(filled),
    /** Half the step and the exponent. */
    numbers: [dt_s / 2, modal.streamlinedExponent],
    counts: [
      few?.count ?? 0,
      driveRows,
      posePlain.length / Math.max(1, pose),
      shapes.length / Math.max(1, pose),
      drag.points,
      drag.inputs,
      drag.common,
    ],
    coupled: coupledOf(modal.limits.length),
    /** In the order of the kernel's fields. */
    arrays: [
      modal.limits,
      inFullRows(modal.sway, d),
      few ? inFullRows(few.shares, terms) : [],
      inFullRows(transposed(modal.step, 6), d),
      drag.into,
      drag.point,
      inFullRows(modal.dragRest, d),
      drag.out,
      inFullRows(modal.shown, d),
      posePlain,
      poseTerms.subarray(0, 2 * pose + shapes.length),
      [...rows[0], ...inFullRows(few?.rows ?? modal.force, d), ...rows[1]],
      meanGust(modal),
      drag.place,
    ],
  };
}

/** Tree states in the kernel's memory, and the step function. */
export class ModalKernel {
  /** Floats per row of oscillators, padding included. */
  readonly own: number;
  /** [count, own + own + twice a pose] displacements, speeds, and the poses after the last step and after the one before; a pose is own + the further modes, padded. */
  readonly states: Float32Array;
  /** [2, G] gusts at the places of the tree that steps next with the first model, Pa; trees of other forests use the same. */
  readonly local: Float32Array;
  /** Where the models are. */
  readonly models: readonly number[];
  /**
   * Advances a tree by a step of a model under a pressure (Pa) in its own frame and the gusts in `local`; `places`: G, or 0
   * if it has none, as for all models but the first. Returns sway or pressure over its largest sampled value.
   */
  readonly step: Step;

  private constructor(module: WebAssembly.Module, models: readonly KernelModel[], count: number) {
    const layouts = models.map(layoutOf);
    const [{ own, pose, places, driveRows }] = layouts;
    const row = 4 * own + 2 * pose;
    const most = Math.max(...layouts.map(({ work }) => sum(work)));
    const needed = layouts.map(({ arrays }) => sum(arrays.map(({ length }) => filled(length))) + HEAD_FLOATS);
    const memory = memoryOf(module, count * row + most + sum(needed));
    this.own = own;
    this.states = memory.take(count * row);
    const room = memory.workOf(most);
    this.models = layouts.map((layout) => {
      const head = memory.take(HEAD_FLOATS);
      const placed = layout.arrays.map((values) => {
        const array = memory.take(values.length);
        array.set(values);
        return array.byteOffset;
      });
      let at = room.byteOffset;
      const rooms = layout.work.map((floats) => {
        at += 4 * floats;
        return at - 4 * floats;
      });
      // Without sums the terms are the factors behind the pressure.
      if (layout.work[1] === 0) rooms[1] = rooms[0] + 8;
      const lengths = [layout.own, layout.pose, row, own, 2 * own, 3 * own + pose, own].map(
        (floats) => 4 * floats,
      );
      head.set(layout.numbers);
      new Uint32Array(head.buffer, head.byteOffset + 8).set([
        layout.coupled,
        ...lengths,
        this.states.byteOffset,
        ...layout.counts,
        ...rooms,
        ...placed,
      ]);
      return head.byteOffset;
    });
    this.local = room.subarray(driveRows, driveRows + 2 * places);
    this.step = memory.step;
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
