/** The wind anywhere and at any time: documents, their evaluation, gust fronts, spectra and plain editing. */
export { FRONT_LIFE_S, MOST_FRONTS, STREAMLINING_SPEED_M_S, WIND_MODELS as MODELS } from "./core/constants";
export {
  FIELDS,
  hasField,
  parseWind,
  parseWindText,
  type Wave,
  type WindDocument,
  type WindNumber,
} from "./core/wind/document";
export {
  meanVelocity_m_s,
  type PlainWind,
  plainWind,
  sameWind,
  withinTurn,
  withMean,
  withPlain,
} from "./core/wind/edit";
export { WindField } from "./core/wind/field";
export { WindError, type WindModel } from "./core/wind/fields";
export { type Front, frontExtent, travelled_m } from "./core/wind/fronts";
export { rootsOfUnity, transformRows } from "./core/wind/models/fourier";
export { PRESETS, type PresetName } from "./core/wind/presets";
export { dynamicPressure, heightFactor } from "./core/wind/pressure";
export { EMPTY_RECORDING } from "./core/wind/recording";
export type { WindState } from "./core/wind/transition";
