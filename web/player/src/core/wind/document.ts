/** Wind document, version 1: fields, ranges and parser. Specified in spec/formats/wind.md. */

import {
  FOREST_WAVES,
  MOST_WAVES,
  UNUSED_LENGTH_SCALE_M,
  WAVE_FIELDS,
  WAVE_SHARE_TOLERANCE,
  WIND_FIELDS,
  WIND_LISTS,
  WIND_MODELS,
  WIND_VERSION,
} from "../constants";
import { type Field, numberAt, objectAt, refuseUnknown, WindError, type WindModel } from "./fields";
import { EMPTY_RECORDING, type Recording, recordingAt } from "./recording";

/** Fields that are not numbers. */
const LISTS: Partial<Record<WindModel, readonly string[]>> = WIND_LISTS;

/** One cosine wave of gusts; without `phase_turns` the phase is derived from the seed. */
export interface Wave {
  readonly frequency_hz: number;
  readonly share: number;
  readonly across?: number;
  readonly phase_turns?: number;
}

export interface WindDocument {
  readonly version: 1;
  readonly model: WindModel;
  readonly mean_speed_m_s: number;
  readonly direction_deg: number;
  readonly gustiness: number;
  readonly convection_speed_m_s: number;
  readonly seed: number;
  /** All models except cosine. */
  readonly length_scale_m?: number;
  /** Spectral only. */
  readonly beta?: number;
  readonly height_exponent?: number;
  readonly reference_height_m?: number;
  /** Cosine only. */
  readonly heading_swing_deg?: number;
  readonly waves?: readonly Wave[];
  /** Recorded only. */
  readonly recording?: Recording;
}

/** A document with every default filled in, also for fields that its model does not use. */
export type ResolvedWind = Required<WindDocument>;

export type WindNumber = keyof typeof WIND_FIELDS;
/** Numbers of a wind document. */
export const FIELDS: Readonly<Record<WindNumber, Field>> = WIND_FIELDS;

/** Ranges of the fields that every document has. */
export const WIND_RANGES: Readonly<Record<string, readonly [number, number]>> = Object.fromEntries(
  Object.entries(FIELDS)
    .filter(([, field]) => !field.models && field.default === undefined)
    .map(([name, { low, high }]) => [name, [low, high] as const]),
);

const DEFAULTS = {
  length_scale_m: UNUSED_LENGTH_SCALE_M,
  beta: WIND_FIELDS.beta.default,
  height_exponent: WIND_FIELDS.height_exponent.default,
  reference_height_m: WIND_FIELDS.reference_height_m.default,
  heading_swing_deg: WIND_FIELDS.heading_swing_deg.default,
  waves: FOREST_WAVES,
  recording: EMPTY_RECORDING,
};

/** Fills in the defaults of a valid document. */
export const resolveWind = (wind: WindDocument): ResolvedWind => ({ ...DEFAULTS, ...wind });

/** Whether a field belongs to a model. */
export function hasField(model: WindModel, name: WindNumber): boolean {
  return FIELDS[name].models?.includes(model) ?? true;
}

/** Parses a wind document written as JSON; throws WindError like `parseWind`. */
export function parseWindText(text: string): WindDocument {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    throw new WindError("wind", "expected a JSON object");
  }
  return parseWind(value);
}

/** Parses a wind document; throws WindError that names the field and the expected value. */
export function parseWind(value: unknown): WindDocument {
  const fields = objectAt(value, "wind");
  if (fields.version !== WIND_VERSION) {
    throw new WindError("wind.version", `this reader knows version ${WIND_VERSION}`, fields.version);
  }
  const model = fields.model as WindModel;
  if (!WIND_MODELS.includes(model)) {
    throw new WindError("wind.model", `expected one of ${WIND_MODELS.join(", ")}`, fields.model);
  }
  const names = (Object.keys(FIELDS) as WindNumber[]).filter((name) => hasField(model, name));
  const known = [...names, "version", "model", ...(LISTS[model] ?? [])];
  refuseUnknown(fields, known, "wind", `not a field of the ${model} model`);
  const numbers: Partial<Record<WindNumber, number>> = {};
  for (const name of names) {
    const number = numberAt(fields, name, FIELDS[name], "wind");
    if (number !== undefined) numbers[name] = number;
  }
  const waves = fields.waves === undefined ? {} : { waves: wavesAt(fields.waves) };
  const recording =
    model === "recorded" ? { recording: recordingAt(fields.recording, "wind.recording") } : {};
  return { version: WIND_VERSION, model, ...numbers, ...waves, ...recording } as WindDocument;
}

function wavesAt(value: unknown): Wave[] {
  if (!Array.isArray(value) || value.length < 1 || value.length > MOST_WAVES) {
    throw new WindError("wind.waves", `expected a list of 1..${MOST_WAVES} waves`);
  }
  const waves = value.map((wave, k) => waveAt(wave, `wind.waves[${k}]`));
  const shares = waves.reduce((sum, wave) => sum + wave.share, 0);
  if (shares > 1 + WAVE_SHARE_TOLERANCE) {
    throw new WindError("wind.waves", "expected shares that sum to at most 1");
  }
  return waves;
}

function waveAt(value: unknown, path: string): Wave {
  const fields = objectAt(value, path);
  const names = Object.keys(WAVE_FIELDS) as (keyof Wave)[];
  refuseUnknown(fields, names, path, "not a field of a wave");
  const wave: Partial<Record<keyof Wave, number>> = {};
  for (const name of names) {
    const number = numberAt(fields, name, WAVE_FIELDS[name], path);
    if (number !== undefined) wave[name] = number;
  }
  return wave as Wave;
}
