/** Edges of shadows without a pattern of pixels. */
import { ShaderChunk } from "three";

/** The number, different from pixel to pixel, by which three.js turns the places where it reads a shadow map. */
const TURNED_BY_PIXEL = "fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) )";
/** One turn for all pixels, in which the five places lie well apart along both axes. */
const SAME_TURN = "0.3";

/**
 * three.js softens the edges of shadows by five samples, turned differently in every pixel, and leaves it to a filter over time to blend
 * them. Without one, bark and leaves near the eye look woven. The same turn everywhere gives smooth edges, because each sample is itself
 * blended of four texels. Changes three.js's shader for all materials that are compiled afterwards.
 */
export function steadyShadows(): void {
  ShaderChunk.shadowmap_pars_fragment = ShaderChunk.shadowmap_pars_fragment.replace(
    TURNED_BY_PIXEL,
    SAME_TURN,
  );
}
