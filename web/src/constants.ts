/** Constants that Python and TypeScript share, written from spec/constants.json by `make constants`. */

// ---- build ------------------------------------------------------------------------------------------------

/** Stage of a build that computes the paper's records. */
export const RECORDS_STAGE = "records";
/** Stages after the complete table of the default method; the last computes the bare table. */
export const STAGES_AFTER_TABLE = ["records", "bare"] as const;
/** Sway over height beyond which the linear response overestimates. */
export const LINEAR_SWAY_SHARE = 0.2;
