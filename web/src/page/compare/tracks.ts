/** Decoder of comparison files (spec/formats/comparison.md). Pure. */
import { decode } from "@msgpack/msgpack";
import type { Method } from "galewood/motion";

export interface Tracks {
  readonly frames: number;
  readonly dt_s: number;
  readonly height_m: number;
  readonly modes: number;
  /** [frames, modes] coordinates of the table's modes, m; null for a method that the table cannot use. */
  readonly q: Readonly<Record<"fem" | "modal", Float32Array> & Record<"paper", Float32Array | null>>;
  /** The errors of this motion, in gusts that differ within the crown. */
  readonly gusts: Compared;
  /** The errors in the same wind without these gusts: the same over the whole crown. */
  readonly uniform: Compared;
}

/** Sway and errors in one wind. */
export interface Compared {
  /** [frames] largest node displacement of the reference solution, relative to the height. */
  readonly sway: readonly number[];
  readonly error: Readonly<Record<"modal", Errors> & Record<"paper", Errors | null>>;
}

/** [frames] largest node error against the reference, and Hausdorff distance, relative to the height. */
interface Errors {
  readonly max: readonly number[];
  readonly hausdorff: readonly number[];
}

type Json = Record<string, unknown>;

const wrong = (what: string) => new Error(`The comparison could not be read: ${what}.`);

function object(value: unknown, what: string): Json {
  if (typeof value !== "object" || value === null || Array.isArray(value)) throw wrong(what);
  return value as Json;
}

function number(from: Json, name: string): number {
  const value = from[name];
  if (typeof value !== "number" || !(value > 0)) throw wrong(`${name} is not a positive number`);
  return value;
}

function floats(bytes: unknown, name: string, count: number): Float32Array {
  if (!(bytes instanceof Uint8Array) || bytes.length !== 4 * count) throw wrong(`${name} has another length`);
  return new Float32Array(bytes.slice().buffer);
}

function series(from: Json, name: string, count: number): readonly number[] {
  const values = from[name];
  if (!Array.isArray(values) || values.length !== count) throw wrong(`${name} has another length`);
  return values as number[];
}

/** Decodes and validates a comparison file. Throws an Error that names the fault. */
export function decodeTracks(file: Uint8Array): Tracks {
  const all = object(decode(file), "the file is not a map");
  if (all.format !== "galewood-comparison" || all.version !== 1)
    throw wrong(`unsupported format ${String(all.format)}, version ${String(all.version)}`);
  const [frames, modes] = [number(all, "frames"), number(all, "modes")];
  const tracks = object(all.tracks, "the tracks are missing");
  const recorded = (tracks.paper ?? null) !== null;
  return {
    frames,
    modes,
    dt_s: number(all, "dt_s"),
    height_m: number(all, "height_m"),
    q: {
      fem: floats(tracks.fem, "fem", frames * modes),
      modal: floats(tracks.modal, "modal", frames * modes),
      paper: recorded ? floats(tracks.paper, "paper", frames * modes) : null,
    },
    gusts: compared(all, frames, recorded),
    uniform: compared(object(all.uniform, "the uniform wind is missing"), frames, recorded),
  };
}

function compared(from: Json, frames: number, recorded: boolean): Compared {
  const errors = object(from.error, "the errors are missing");
  const errorOf = (name: Method): Errors => {
    const of = object(errors[name], `the error of ${name} is missing`);
    return { max: series(of, "max", frames), hausdorff: series(of, "hausdorff", frames) };
  };
  return {
    sway: series(from, "sway", frames),
    error: { modal: errorOf("modal"), paper: recorded ? errorOf("paper") : null },
  };
}

/** Interpolates the coordinates at a fractional frame into `out`; clamped to the first and last frame. */
export function poseAt(q: Float32Array, modes: number, place: number, out: Float32Array): void {
  const last = q.length / modes - 1;
  const at = Math.min(Math.max(place, 0), last);
  const first = Math.floor(at);
  const next = Math.min(first + 1, last);
  const part = at - first;
  for (let k = 0; k < modes; k++) {
    const a = q[first * modes + k];
    out[k] = a + (q[next * modes + k] - a) * part;
  }
}
