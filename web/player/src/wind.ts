/** The wind anywhere and at any time: documents, their evaluation, gust fronts, spectra and plain editing. */
export { FRONT_LIFE_S, MOST_FRONTS } from "./core/constants";
export {
  meanVelocity_m_s,
  type PlainWind,
  plainWind,
  sameWind,
  withinTurn,
  withMean,
  withPlain,
} from "./core/wind/edit";
export { type Front, frontExtent, travelled_m } from "./core/wind/fronts";
export { rootsOfUnity, transformRows } from "./core/wind/models/fourier";
export {
  dynamicPressure,
  EMPTY_RECORDING,
  FIELDS,
  hasField,
  heightFactor,
  MODELS,
  PRESETS,
  type PresetName,
  parseWind,
  parseWindText,
  type Wave,
  type WindDocument,
  WindError,
  WindField,
  type WindModel,
  type WindNumber,
  type WindState,
  windPressure,
} from "./core/wind/wind";
