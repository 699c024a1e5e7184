/** Constants that Python and TypeScript share, written from spec/constants.json by `make constants`. */

// ---- pressure of the wind ---------------------------------------------------------------------------------

/** Dynamic pressure over speed squared up to the streamlining speed; the air has 1.2 kg/m³ [Pa·s²/m²]. */
export const HALF_AIR_DENSITY_KG_M3: f32 = 0.6;
/**
 * Above this speed the pressure grows with the streamlined exponent of the tree (metadata of the table)
 * [m/s].
 */
export const STREAMLINING_SPEED_M_S: f32 = 5;
/** Dynamic pressure at the streamlining speed [Pa]. */
export const STREAMLINING_PRESSURE_PA: f32 = 15;

// ---- modal model ------------------------------------------------------------------------------------------

/**
 * The arguments of the polynomials are clamped to this multiple of the sampled range. The force stays
 * bounded, and as the linear step contracts, any bounded wind gives a bounded motion.
 */
export const MODAL_REACH: f32 = 1.25;
/** In still air a motion below this share of the sampled range is set to exactly zero. */
export const MODAL_REST: f32 = 1e-7;
