/** Edits of wind documents made by the instruments. Pure. */
import {
  EMPTY_RECORDING,
  hasField,
  PRESETS,
  type PresetName,
  type WindDocument,
  type WindModel,
  type WindNumber,
} from "galewood/wind";

const STANDARD_VALUES = { length_scale_m: 25, beta: 5 / 3 };

/** Changes the model: keeps the common fields, adds the defaults of new ones and removes the rest. */
export function withModel(wind: WindDocument, model: WindModel): WindDocument {
  const { waves, recording, ...numbers } = { ...STANDARD_VALUES, ...wind };
  const kept = Object.entries(numbers).filter(
    ([name]) => name === "version" || name === "model" || hasField(model, name as WindNumber),
  );
  const { beta: _, ...plain } = Object.fromEntries(kept);
  const beta = model === "spectral" ? { beta: numbers.beta } : {};
  const lists = {
    ...(model === "cosine" && waves ? { waves } : {}),
    ...(model === "recorded" ? { recording: recording ?? EMPTY_RECORDING } : {}),
  };
  return { ...plain, ...beta, ...lists, model } as WindDocument;
}

/** A preset with the given direction. */
export function presetAt(name: PresetName, direction_deg: number): WindDocument {
  return { ...PRESETS[name], direction_deg };
}

/** The preset that a wind matches, ignoring direction and seed; null if none. */
export function presetOf(wind: WindDocument): PresetName | null {
  const same = (name: PresetName) => {
    const preset: WindDocument = { ...PRESETS[name], direction_deg: wind.direction_deg, seed: wind.seed };
    const names = new Set([...Object.keys(preset), ...Object.keys(wind)]) as Set<keyof WindDocument>;
    return [...names].every(
      (key) => alike(preset[key], wind[key]) || (key === "beta" && isUsual(preset, wind)),
    );
  };
  return (Object.keys(PRESETS) as PresetName[]).find(same) ?? null;
}

/** Equal but for rounding: a wind that came through a link or a slider has 0.49999999999999994 for 0.5. */
const alike = (a: unknown, b: unknown): boolean =>
  a === b || (typeof a === "number" && typeof b === "number" && Math.abs(a - b) < 1e-6);

const isUsual = (a: WindDocument, b: WindDocument): boolean =>
  (a.beta ?? STANDARD_VALUES.beta) === (b.beta ?? STANDARD_VALUES.beta);
