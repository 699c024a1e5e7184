/** Wind document, version 1: fields, ranges and parser. Specified in docs/formats/wind.md. */

import { type Field, MODELS, numberAt, objectAt, refuseUnknown, WindError, type WindModel } from "./fields";
import { type Recording, recordingAt, STILL } from "./recording";

export { MODELS, WindError, type WindModel } from "./fields";

const VERSION = 1;
/** Fields that are not numbers. */
const LISTS: Partial<Record<WindModel, readonly string[]>> = { cosine: ["waves"], recorded: ["recording"] };
const MOST_WAVES = 16;
const SHARE_TOLERANCE = 1e-9;

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

const TRAVELLING: readonly WindModel[] = ["perlin", "spectral", "navier-stokes"];

export const FIELDS = {
  mean_speed_m_s: { low: 0, high: 60, models: MODELS },
  direction_deg: { low: -360, high: 360, models: MODELS },
  gustiness: { low: 0, high: 1, models: MODELS },
  convection_speed_m_s: { low: 0.5, high: 60, models: MODELS },
  seed: { low: 0, high: 4294967295, models: MODELS, whole: true },
  length_scale_m: { low: 5, high: 200, models: TRAVELLING },
  beta: { low: 0, high: 2, models: ["spectral"], standard: 5 / 3 },
  height_exponent: { low: 0, high: 1, models: MODELS, standard: 0.2 },
  reference_height_m: { low: 1, high: 60, models: MODELS, standard: 12 },
  heading_swing_deg: { low: 0, high: 60, models: ["cosine"], standard: 12 },
} satisfies Record<string, Field>;

export type WindNumber = keyof typeof FIELDS;
const WAVE_FIELDS: Readonly<Record<keyof Wave, Field>> = {
  frequency_hz: { low: 0.001, high: 4, models: MODELS },
  share: { low: 0, high: 1, models: MODELS },
  across: { low: -2, high: 2, models: MODELS, standard: 0 },
  phase_turns: { low: 0, high: 1, models: MODELS, standard: -1 },
};

/** Ranges of the required fields. */
export const WIND_RANGES: Readonly<Record<string, readonly [number, number]>> = Object.fromEntries(
  Object.entries(FIELDS as Record<string, Field>)
    .filter(([, field]) => field.models === MODELS && field.standard === undefined)
    .map(([name, { low, high }]) => [name, [low, high] as const]),
);

export const FOREST_WAVES: readonly Wave[] = [
  { frequency_hz: 0.05, share: 0.262, across: 0.6 },
  { frequency_hz: 0.087, share: 0.218, across: -0.45 },
  { frequency_hz: 0.152, share: 0.181, across: 0.75 },
  { frequency_hz: 0.264, share: 0.15, across: -0.6 },
  { frequency_hz: 0.46, share: 0.105, across: 0.5 },
  { frequency_hz: 0.8, share: 0.084, across: -0.7 },
];

const DEFAULTS = {
  length_scale_m: 20,
  beta: 5 / 3,
  height_exponent: 0.2,
  reference_height_m: 12,
  heading_swing_deg: 12,
  waves: FOREST_WAVES,
  recording: STILL,
};

/** Fills in the defaults of a valid document. */
export const resolveWind = (wind: WindDocument): ResolvedWind => ({ ...DEFAULTS, ...wind });

/** Whether a field belongs to a model. */
export function hasField(model: WindModel, name: WindNumber): boolean {
  return (FIELDS[name] as Field).models.includes(model);
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
  if (fields.version !== VERSION) {
    throw new WindError("wind.version", `this reader knows version ${VERSION}`, fields.version);
  }
  const model = fields.model as WindModel;
  if (!MODELS.includes(model)) {
    throw new WindError("wind.model", `expected one of ${MODELS.join(", ")}`, fields.model);
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
  return { version: VERSION, model, ...numbers, ...waves, ...recording } as WindDocument;
}

function wavesAt(value: unknown): Wave[] {
  if (!Array.isArray(value) || value.length < 1 || value.length > MOST_WAVES) {
    throw new WindError("wind.waves", `expected a list of 1..${MOST_WAVES} waves`);
  }
  const waves = value.map((wave, k) => waveAt(wave, `wind.waves[${k}]`));
  const shares = waves.reduce((sum, wave) => sum + wave.share, 0);
  if (shares > 1 + SHARE_TOLERANCE) {
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
