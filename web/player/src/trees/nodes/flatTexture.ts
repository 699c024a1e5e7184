import { DataTexture, FloatType, NearestFilter, RedFormat, RGBAFormat } from "three";

const TEXTURE_WIDTH = 1024;
/** log2 of the width of every flat texture, for the shaders. */
export const FLAT_SHIFT = 10;

export interface FlatTexture {
  readonly texture: DataTexture;
  readonly data: Float32Array;
}

/** A float texture read as a flat array: texel i lies at (i mod 1024, i / 1024). */
export function flatTexture(texels: number, channels: 1 | 4): FlatTexture {
  const height = Math.max(1, Math.ceil(texels / TEXTURE_WIDTH));
  const data = new Float32Array(TEXTURE_WIDTH * height * channels);
  const texture = new DataTexture(
    data,
    TEXTURE_WIDTH,
    height,
    channels === 1 ? RedFormat : RGBAFormat,
    FloatType,
  );
  texture.minFilter = NearestFilter;
  texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return { texture, data };
}

/**
 * The same with four channels of half precision on the graphics card, 11 bits: of displacements of a metre these are half a
 * millimetre.
 */
export function halfTexture(texels: number): FlatTexture {
  const flat = flatTexture(texels, 4);
  flat.texture.internalFormat = "RGBA16F"; // WebGL 2 converts what is uploaded
  return flat;
}

/**
 * Marks runs of texels of a four-channel flat texture for upload, each a first texel and an end. three.js uploads each row with a call
 * of its own, so that the whole texture is cheaper if half of the rows are written.
 */
export function uploadRuns(texture: DataTexture, runs: readonly (readonly [number, number])[]): void {
  const { height } = texture.image;
  const rows = new Set<number>();
  for (const [from, end] of runs)
    for (let row = Math.floor(from / TEXTURE_WIDTH); row < Math.ceil(end / TEXTURE_WIDTH); row++)
      rows.add(row);
  texture.clearUpdateRanges();
  if (2 * rows.size < height)
    for (const row of rows) texture.addUpdateRange(row * TEXTURE_WIDTH * 4, TEXTURE_WIDTH * 4);
  texture.needsUpdate = true;
}

/** Marks the first texels of a four-channel flat texture for upload, in whole rows. */
export function uploadFirst(texture: DataTexture, texels: number): void {
  texture.clearUpdateRanges();
  const rows = Math.ceil(texels / TEXTURE_WIDTH);
  for (let row = 0; row < rows; row++) texture.addUpdateRange(row * TEXTURE_WIDTH * 4, TEXTURE_WIDTH * 4);
  texture.needsUpdate = true;
}
